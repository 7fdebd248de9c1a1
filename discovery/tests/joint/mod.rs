//! What the tests of motors that are simulated here share: a recording, and the evidence that it is.

use drivescope_discovery::{Evidence, Measured, noise};
use drivescope_plant::drive::Drive;
use drivescope_recording::{Recording, Signal};

/// Signals of those names and units, samples so far apart, s.
pub(crate) fn recording<const N: usize>(
    period_s: f64,
    signals: [(&str, &str, Vec<f64>); N],
) -> Recording {
    let signal = |(name, unit, values): (&str, &str, Vec<f64>)| Signal {
        name: name.to_owned(),
        unit: unit.to_owned(),
        values,
    };
    Recording::new("joint", 0.0, period_s, signals.map(signal).to_vec())
}

pub(crate) fn evidence(drive: &Drive, recording: &Recording) -> Evidence {
    let measured = Measured::new(drive, recording).expect("it can be used");
    let sds = noise(drive, &measured, &[]).iter().map(|noise| noise.sd).collect();
    Evidence { recordings: vec![measured], noise: vec![sds] }
}
