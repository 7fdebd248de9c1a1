//! Examples: machines that ship with the program, recorded by simulation.

use drivescope_plant::drive::Drive;
use drivescope_recording::Quantity;
use indicatif::ProgressBar;

use super::bench::GivenDrive;
use super::recordings::Taken;
use crate::expression::SignalOverTime;
use crate::failure::{Failure, into_report};
use crate::simulation::typed::{Driven, Run};

/// A machine, what its model knows, and the inputs under which it was recorded.
#[derive(Debug)]
pub(super) struct Example {
    /// Its name in requests.
    pub(super) id: &'static str,
    /// What it is, for people.
    pub(super) title: &'static str,
    machine: &'static str,
    model: &'static str,
}

/// Sampling time and length, s, of the recordings.
const PERIOD_S: f64 = 1e-3;
const LENGTH_S: f64 = 5.0;
/// u of each recording, and the seed of its noise: those of the worked example.
const INPUTS: [(&str, &str, u64); 2] = [
    ("one.csv", "8 * sin(2 * t) + 5 * sin(7 * t) + 4 * sign(sin(11 * t))", 3),
    ("two.csv", "9 * sin(1.7 * t) + 6 * sign(sin(9 * t))", 4),
];
const MACHINE: &str = include_str!("../../docs/worked-example/machine.toml");
const MODEL: &str = include_str!("../../docs/worked-example/model.toml");

/// Every example.
pub(super) const EXAMPLES: [Example; 2] = [
    Example {
        id: "hidden",
        title: "A bench motor whose model lacks something",
        machine: MACHINE,
        model: MODEL,
    },
    Example {
        id: "complete",
        title: "The same motor under a model that lacks nothing",
        machine: MODEL,
        model: MODEL,
    },
];

impl Example {
    /// The example of that name.
    ///
    /// # Errors
    /// There is none.
    pub(super) fn find(id: &str) -> Result<&'static Self, Failure> {
        EXAMPLES.iter().find(|it| it.id == id).ok_or_else(|| Failure::Usage {
            what: format!("there is no example `{id}`"),
            instead: "choose one of the page".to_owned(),
        })
    }

    /// Its recordings and its model.
    ///
    /// # Errors
    /// Never for what ships: a test runs them all.
    pub(super) fn recorded(&self) -> miette::Result<(Vec<Taken>, GivenDrive)> {
        let machine = Drive::parse(self.machine, "machine.toml").map_err(into_report)?;
        // Whoever built the machine knows its sensors.
        let noise = Drive::parse(MACHINE, "machine.toml").map_err(into_report)?.noise;
        let samples = (LENGTH_S / PERIOD_S).round() as usize + 1;
        let record = |(name, input, seed): (&str, &'static str, u64)| {
            let u = SignalOverTime::parse("u", input, Quantity::Voltage)?;
            let run = Run {
                drive: Drive { noise, ..machine.clone() },
                driven: Driven::Input(u.sampled("u", PERIOD_S, samples)?),
                load: None,
                faults: Vec::new(),
                period_s: PERIOD_S,
                seed,
            };
            Ok::<_, miette::Report>(Taken::made(
                name.to_owned(),
                run.simulate(&ProgressBar::hidden())?,
            ))
        };
        let recordings = INPUTS.into_iter().map(record).collect::<miette::Result<_>>()?;
        let drive = Drive::parse(self.model, "model.toml").map_err(into_report)?;
        let given = GivenDrive {
            name: "model.toml".to_owned(),
            text: self.model.to_owned(),
            drive,
            made: false,
        };
        Ok((recordings, given))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_example_can_be_recorded() {
        for example in &EXAMPLES {
            let found = Example::find(example.id).expect("it is listed");
            let recorded = found.recorded();
            let (recordings, _) =
                recorded.unwrap_or_else(|error| panic!("{}: {error:?}", found.id));
            assert_eq!(recordings.len(), 2);
            assert_eq!(recordings[0].recording.as_ref().map(|it| it.len()), Some(5001));
            let noisy = recordings[0].recording.as_ref().and_then(|it| it.signal("omega"));
            let noisy = &noisy.expect("there is one").values;
            assert_ne!(noisy[0], 0.0);
        }
    }
}
