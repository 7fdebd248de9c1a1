//! Whether recordings can be judged at all: what is wrong with their signals is found before
//! anything is fitted, compared or named, and said in words.
//!
//! ```text
//!  recording ──repair──> Measured ──checks──> findings: channel, what, where, how large, what to do
//! ```
//!
//! A repair sets values to missing that no sensor of a moving machine shows, or puts them between their
//! neighbours ([`repaired`]); a check only looks ([`findings`]). One file a check, and its line in `REPAIRS`
//! or `CHECKS`. Doubts that a file alone raises (units that contradict each other, holes, limits) are those
//! of the reader; here the drive and what drives it are known.

mod answering;
mod averaged;
mod coarse;
mod finding;
mod frozen;
mod held;
mod late;
mod missing;
mod motion;
mod outputs;
mod repeated;
mod saturated;
mod shares;
mod spikes;
mod standing;
mod unit;

use drivescope_plant::drive::Drive;
use drivescope_recording::Recording;

use crate::estimate::Evidence;

pub(crate) use coarse::is_coarse;
pub use finding::{Consequence, SignalFinding, Size, Stretch, What};
pub(crate) use motion::is_one_speed;

/// Replaces what is no measurement, and says so.
type Repair = fn(&mut Recording) -> Vec<SignalFinding>;
const REPAIRS: [Repair; 3] = [spikes::repair, frozen::repair, repeated::repair];

/// Looks at the recordings of a drive.
type Check = fn(&Drive, &Evidence) -> Vec<SignalFinding>;
const CHECKS: [Check; 8] = [
    answering::check,
    unit::check,
    motion::check,
    saturated::check,
    coarse::check,
    held::check,
    late::check,
    missing::check,
];

/// The recording without the values that are no measurements, and what became of them.
pub fn repaired(mut recording: Recording) -> (Recording, Vec<SignalFinding>) {
    let found = REPAIRS.iter().flat_map(|repair| repair(&mut recording)).collect();
    (recording, found)
}

/// What is wrong with recordings of that drive, what forbids to judge by them first.
pub fn findings(drive: &Drive, evidence: &Evidence) -> Vec<SignalFinding> {
    let mut found: Vec<SignalFinding> =
        CHECKS.iter().flat_map(|check| check(drive, evidence)).collect();
    found.sort_by_key(|it| it.consequence);
    found
}
