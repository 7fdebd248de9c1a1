//! Banks over drives of any size: how many states and lanes there are is known to the compiler,
//! not to the caller.

use drivescope_diagnoser::bank::{
    BankDesign, BaselineError, Calibration, CalibrationError, Event, Limits, Mechanism, Process,
    Row, Separation, Statistics, Tails, Verified, Watch, calibrate, learn, log_likelihood, verify,
};
use drivescope_diagnoser::{Memory, MemoryError, Walk};
use drivescope_plant::drive::Drive;

use super::process::{DriveProcess, LEARNED, Learned, ProcessError};

/// A drive as a process, whatever its size.
pub trait AnyProcess: Send + Sync {
    /// The mechanisms of the bank.
    fn mechanisms(&self) -> &[Mechanism];
    /// As [`learn`].
    ///
    /// # Errors
    /// As there.
    fn learn(
        &self,
        rows: &[Row],
        limits: Limits,
        horizon: usize,
    ) -> Result<Box<dyn AnyWatch>, BaselineError>;
    /// As [`Watch::unlearned`].
    fn unlearned(&self, limits: Limits, horizon: usize) -> Box<dyn AnyWatch>;
    /// As [`log_likelihood`].
    fn log_likelihood(&self, rows: &[Row]) -> f64;
    /// As [`calibrate`].
    ///
    /// # Errors
    /// As there.
    fn calibrate(&self, how: &Calibration) -> Result<Tails, CalibrationError>;
    /// As [`verify`].
    ///
    /// # Errors
    /// As there.
    fn verify(&self, limits: Limits, how: &Calibration) -> Result<Verified, CalibrationError>;
}

/// A bank that watches one machine, whatever the size of its drive.
pub trait AnyWatch: Send {
    /// As [`Watch::step`].
    fn step(&mut self, row: &Row) -> Option<Event>;
    /// As [`Watch::resume`].
    fn resume(&mut self, row: &Row);
    /// As [`Watch::statistics`].
    fn statistics(&self) -> Statistics;
    /// As [`Watch::separation`].
    fn separation(&self, rows: &[Row]) -> Option<Separation>;
    /// As [`Watch::separation_through`].
    fn separation_through(&self, rows: &[Row], change: f64) -> Option<(Separation, f64)>;
    /// What this machine differs by from the drive, as fractions.
    fn machine(&self) -> Vec<(String, f64)>;
    /// A copy that goes on by itself.
    fn copy(&self) -> Box<dyn AnyWatch>;
    /// As [`Memory::walk`].
    ///
    /// # Errors
    /// As there.
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError>;
}

impl<const N: usize, const L: usize> AnyProcess for DriveProcess<N, L> {
    fn mechanisms(&self) -> &[Mechanism] {
        Process::mechanisms(self)
    }

    fn learn(
        &self,
        rows: &[Row],
        limits: Limits,
        horizon: usize,
    ) -> Result<Box<dyn AnyWatch>, BaselineError> {
        Ok(Box::new(learn(self.clone(), rows, limits, horizon)?))
    }

    fn unlearned(&self, limits: Limits, horizon: usize) -> Box<dyn AnyWatch> {
        Box::new(Watch::unlearned(self.clone(), limits, horizon))
    }

    fn log_likelihood(&self, rows: &[Row]) -> f64 {
        log_likelihood(self, rows)
    }

    fn calibrate(&self, how: &Calibration) -> Result<Tails, CalibrationError> {
        calibrate(self, how)
    }

    fn verify(&self, limits: Limits, how: &Calibration) -> Result<Verified, CalibrationError> {
        verify(self, limits, how)
    }
}

impl Clone for Box<dyn AnyWatch> {
    fn clone(&self) -> Self {
        self.copy()
    }
}

impl<const N: usize, const L: usize> AnyWatch for Watch<N, DriveProcess<N, L>> {
    fn step(&mut self, row: &Row) -> Option<Event> {
        self.step(row)
    }

    fn resume(&mut self, row: &Row) {
        self.resume(row);
    }

    fn statistics(&self) -> Statistics {
        self.statistics()
    }

    fn separation(&self, rows: &[Row]) -> Option<Separation> {
        self.separation(rows)
    }

    fn separation_through(&self, rows: &[Row], change: f64) -> Option<(Separation, f64)> {
        self.separation_through(rows, change)
    }

    fn machine(&self) -> Vec<(String, f64)> {
        self.process().learned().iter().cloned().zip(self.process().machine()).collect()
    }

    fn copy(&self) -> Box<dyn AnyWatch> {
        Box::new(self.clone())
    }

    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        Memory::walk(self, walk)
    }
}

/// The drive, sampled every `period_s`, as a process, without those mechanisms; what a machine
/// differs by is learned of each.
///
/// # Errors
/// A drive with a delay, or of more states than a bank is made for.
pub fn process(
    drive: &Drive,
    period_s: f64,
    left_out: &[&str],
) -> Result<Box<dyn AnyProcess>, ProcessError> {
    of_any_size(drive, period_s, left_out, &LEARNED)
}

/// The mechanisms of a design, in the order of its bank; none where its drive makes no process.
pub fn mechanisms(design: &BankDesign) -> Vec<Mechanism> {
    let drive = Drive::parse(&design.drive, "the drive of the diagnoser").ok();
    let made = drive.and_then(|drive| process(&drive, design.period_s, &[]).ok());
    made.map_or_else(Vec::new, |process| process.mechanisms().to_vec())
}

/// The same of a machine that is known exactly: nothing is learned.
///
/// # Errors
/// As [`process`].
pub fn known_process(
    drive: &Drive,
    period_s: f64,
    left_out: &[&str],
) -> Result<Box<dyn AnyProcess>, ProcessError> {
    of_any_size(drive, period_s, left_out, &[])
}

fn of_any_size(
    drive: &Drive,
    period_s: f64,
    left_out: &[&str],
    learned: &[Learned],
) -> Result<Box<dyn AnyProcess>, ProcessError> {
    // A current loop inside or a machine that is known; current and speed; with an angle or own
    // states of effects.
    sized::<3, 16>(drive, period_s, left_out, learned)
        .or_else(|_| sized::<5, 16>(drive, period_s, left_out, learned))
        .or_else(|_| sized::<6, 24>(drive, period_s, left_out, learned))
        .or_else(|_| sized::<7, 24>(drive, period_s, left_out, learned))
}

fn sized<const N: usize, const L: usize>(
    drive: &Drive,
    period_s: f64,
    left_out: &[&str],
    learned: &[Learned],
) -> Result<Box<dyn AnyProcess>, ProcessError> {
    Ok(Box::new(DriveProcess::<N, L>::new(drive, period_s, left_out, learned)?))
}
