//! Measured against modelled: fit a drive to recordings, and see where it fails.
//!
//! ```text
//!  Recording ──> Measured ──┐
//!  drive file ──> Drive ────┼──> Case ──> residuals in units of the noise
//!  Noise (given, estimated) ┤         └─> columns: exact derivatives by parameters, starts, and
//!  Setting (frozen) ────────┘             series added to a balance
//! ```
//!
//! [`Measured`] is a recording as that drive's; [`Case`] steps the model along it, corrected by an
//! [`Observer`] of fixed bandwidth where it cannot run free, and yields residuals and, for every
//! [`Direction`], exact derivatives through stick-slip.
//!
//! ```
//! use drivescope_discovery::{Evidence, Measured, Options, Setting, fit};
//! use drivescope_plant::{drive::Drive, unit::Unit};
//! use drivescope_recording::{Recording, Signal};
//!
//! let text = r#"
//! schema = 1
//! name = "bench motor"
//! motion = "rotary"
//! [motor]
//! input = "voltage"
//! R = 2.5     # ohm
//! L = 2.2e-3  # H
//! K_e = 0.04  # V s/rad
//! K_m = 0.04  # N m/A
//! tie_K = true
//! J = 3.6e-5  # kg m^2
//! B_m = 1e-5  # N m s/rad
//! "#;
//! let mut drive = Drive::parse(text, "motor.toml")?;
//!
//! // Two seconds of the motor under a voltage that changes sides.
//! let mut motor = Unit::new(drive.clone(), true);
//! let at = ["u", "i", "omega"].map(|name| motor.reference(name).expect("a drive has it"));
//! let mut columns = [Vec::new(), Vec::new(), Vec::new()];
//! motor.initialize(0.0);
//! for k in 0..2000 {
//!     motor.set(at[0], 8.0 * (0.02 * f64::from(k)).sin().signum())?;
//!     let shown = columns.iter_mut().zip(at);
//!     shown.for_each(|(column, at)| column.push(motor.get(at).expect("it can be read")));
//!     motor.step(1e-3)?;
//! }
//! let named = [("u", "V"), ("i", "A"), ("omega", "rad/s")].into_iter().zip(columns);
//! let signals = named
//!     .map(|((name, unit), values)| Signal { name: name.into(), unit: unit.into(), values })
//!     .collect();
//! let recording = Recording::new("run", 0.0, 1e-3, signals);
//!
//! // A drive file whose inertia is off, and what the recording says of it.
//! drive.set("J", 5e-5)?;
//! let recordings = vec![Measured::new(&drive, &recording)?];
//! let evidence = Evidence { recordings, noise: vec![vec![0.01, 0.1]] };
//! let setting = Setting::of_fit(&drive, &evidence);
//! let fitted = fit(&drive, &evidence, &setting, &Options::default())?;
//! let inertia = fitted.parameters.iter().find(|it| it.name == "J").expect("it is fitted");
//! assert!((inertia.value / 3.6e-5 - 1.0).abs() < 0.01);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod balances;
mod beside;
mod canonical;
mod case;
mod choice;
pub mod compare;
mod discover;
mod doubt;
mod driving;
mod error;
mod estimate;
mod force;
mod formula;
mod jitter;
mod likelihood;
mod measured;
mod noise;
mod observer;
mod projection;
mod residuals;
mod response;
#[cfg(test)]
mod rig;
mod rms;
mod run;
mod sensitivity;
mod settling;
mod sign;
pub mod signals;
mod start;
#[cfg(test)]
mod testing;

pub use balances::{
    Begun, BothUnexplained, Identified, Unexplained, begin, small_inertia, unexplained,
    unexplained_share,
};
pub use canonical::with_canonical_names;
pub use case::{Case, PACE, PASSING_PACE, Setting, Squares};
pub use discover::{
    Balance, Coefficient, Discovery, LadderStep, LearnedCurve, NextExperiment, NotJudged,
    Oscillation, RandomLoad, Ranked, Rule, RuleNumber, Step, Unfitted, Unwatched, Verdict, Watch,
    add, bic_of, discover, discover_by,
};
pub use doubt::{Doubt, doubts};
pub use driving::{Driving, driving};
pub use error::Error;
pub use estimate::{
    Estimate, Evaluated, Evidence, Fit, Fitted, NotIdentifiable, Options, OutputFits, Seen,
    evaluate, fit, fit_seen, output_fits, with_own,
};
pub use force::{USUAL_BAND_HZ, relative_force_error};
pub use formula::{Formula, FormulaLaw};
pub use measured::{Channel, Measured, Output, Purpose};
pub use noise::{Noise, NoiseSource, noise};
pub use observer::{Observer, USUAL_HZ};
pub use sensitivity::{BLOCK, Direction, Rows};
pub use settling::mechanical_time_s;
pub use start::{Start, first_starts};
