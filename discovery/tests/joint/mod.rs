//! What the tests of motors in a position loop share: a recording of current and position, and the evidence
//! that it is.

use drivescope_discovery::{Evidence, Measured, noise};
use drivescope_plant::drive::Drive;
use drivescope_recording::{Recording, Signal};

/// Samples of current, A, and position, rad, so far apart, s.
pub(crate) fn recording(period_s: f64, current: Vec<f64>, position: Vec<f64>) -> Recording {
    let signal = |name: &str, unit: &str, values| Signal {
        name: name.to_owned(),
        unit: unit.to_owned(),
        values,
    };
    let signals = vec![signal("i", "A", current), signal("theta", "rad", position)];
    Recording::new("joint", 0.0, period_s, signals)
}

pub(crate) fn evidence(drive: &Drive, recording: &Recording) -> Evidence {
    let measured = Measured::new(drive, recording).expect("it can be used");
    let sds = noise(drive, &measured, &[]).iter().map(|noise| noise.sd).collect();
    Evidence { recordings: vec![measured], noise: vec![sds] }
}
