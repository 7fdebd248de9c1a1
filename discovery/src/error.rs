//! Why a recording, or a drive with it, cannot be used.

use drivescope_recording::{rounded, rounded_to};
use thiserror::Error as ThisError;

/// Why a recording, or a drive with it, cannot be used.
#[derive(Debug, Clone, PartialEq, ThisError)]
pub enum Error {
    /// Nothing could drive the model.
    #[error(
        "{file}: nothing drives the model: of {wanted} there is none among {columns}; name the \
         column by --columns u=COLUMN"
    )]
    MissingInput {
        /// The recording.
        file: String,
        /// The signals that would do.
        wanted: &'static str,
        /// The columns there are.
        columns: String,
    },
    /// No voltage, but what drives a drive of the torque balance alone.
    #[error(
        "{file}: there is no voltage `u`: with {instead} it shows the torque balance only; \
         `drivescope init {file} -o DRIVE` makes a drive for that, with input = \"force\""
    )]
    NoVoltage {
        /// The recording.
        file: String,
        /// The signal that would drive such a drive.
        instead: String,
    },
    /// u is no voltage but the drive takes one.
    #[error(
        "{file}: u is in {unit}, but the drive's input is a voltage: name the voltage by \
         --columns u=COLUMN:V, or say input = \"force\" in [motor]"
    )]
    WrongInput {
        /// The recording.
        file: String,
        /// The unit of u.
        unit: String,
    },
    /// Nothing that the model could be compared with.
    #[error(
        "{file}: nothing to compare the model with: of {wanted} there is none among {columns}; \
         name a column by --columns, or check `motion` in the drive file"
    )]
    NoOutput {
        /// The recording.
        file: String,
        /// The signals that would do.
        wanted: String,
        /// The columns there are.
        columns: String,
    },
    /// The load's motion alone, and a drive in which the motor moves otherwise.
    #[error(
        "{file}: has {load} and not the motor's own {motor}, between which the drive has a \
         coupling: name the motor's by --columns {motor}=COLUMN:UNIT, or use a drive without the \
         coupling"
    )]
    LoadAlone {
        /// The recording.
        file: String,
        /// What was measured.
        load: &'static str,
        /// What was not.
        motor: &'static str,
    },
    /// Too few samples in a row.
    #[error(
        "{file}: {samples} samples, and no {least} of them in a row with a known u: record for \
         longer"
    )]
    TooFewSamples {
        /// The recording.
        file: String,
        /// Samples there are.
        samples: usize,
        /// Samples needed.
        least: usize,
    },
    /// The model overflows wherever the search begins.
    #[error("{recording}: the model overflows from each of {starts} starts: {}", next_step(laws))]
    Overflow {
        /// The first recording.
        recording: String,
        /// Starts tried.
        starts: usize,
        /// Typed laws without which it does not.
        laws: Vec<String>,
    },
    /// The model overflows, and a sample of the recording is beyond what it may be stepped.
    #[error(
        "{recording}: a sample of {} s would take the model {:.1e} sub-steps, more than the \
         {most} that one may take: check the unit of time (--columns time=COLUMN:ms), and R, L, J and \
         the effects of the drive file, one of which makes it that much faster than the recording",
        rounded(*period_s),
        substeps
    )]
    OutOfBudget {
        /// The first recording.
        recording: String,
        /// Its sampling time, s.
        period_s: f64,
        /// Sub-steps that a sample would take.
        substeps: f64,
        /// Sub-steps that it may take.
        most: usize,
    },
    /// A speed that the input cannot give.
    #[error(
        "{file}: {name} reaches {} {unit}, but u and K_e of the drive file give {} {unit} at \
         most{meaning}: name the unit by --columns {name}=COLUMN:UNIT, or correct K_e",
        rounded_to(4, *largest),
        rounded_to(4, *possible)
    )]
    ImpossibleSpeed {
        /// The recording.
        file: String,
        /// The speed's name.
        name: &'static str,
        unit: String,
        /// Its greatest magnitude but for spikes.
        largest: f64,
        /// The greatest no-load speed.
        possible: f64,
        /// What the factor between them is likely to mean.
        meaning: String,
    },
    /// An effect that the user chose cannot be added.
    #[error("{effect} cannot be added: {reason}")]
    CannotAdd {
        effect: String,
        /// Why, and what to do.
        reason: String,
    },
}

/// What to do about an overflow that the typed laws make.
fn next_step(laws: &[String]) -> String {
    match laws {
        [] => "check the values and units in the drive file and the unit of u".to_owned(),
        some => format!(
            "without the typed law {} it does not: where it divides by zero or grows beyond all \
             bounds, bound it, as in x / (abs(x) + 0.1)",
            some.join(" or ")
        ),
    }
}
