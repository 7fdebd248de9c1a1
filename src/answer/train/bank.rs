//! What a training says of its bank of hypotheses.

use drivescope_diagnoser::bank::{LearnedNoise, Limits};
use serde::Serialize;

use crate::answer::block::{ALL, Block, Fact};
use crate::report::words::number;

/// What was found on the way.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct BankAnswer {
    pub(crate) drive: String,
    pub(crate) noise: LearnedNoise,
    pub(crate) arl_0: f64,
    pub(crate) limits: Limits,
    pub(crate) horizon_samples: usize,
    pub(crate) baseline_samples: usize,
    pub(crate) verified: VerifiedAnswer,
    /// What cannot be told apart at the operating point of the first recording.
    pub(crate) confusions: Vec<Confusion>,
}

#[derive(Debug, Clone, Serialize)]
pub(crate) struct VerifiedAnswer {
    pub(crate) samples: usize,
    pub(crate) alarms: usize,
    /// Lower 95 % limit of the mean samples between alarms.
    pub(crate) arl_0_at_least: f64,
    /// Healthy samples of the recordings, baselines excluded, and alarms in them.
    pub(crate) recorded: usize,
    pub(crate) recorded_alarms: usize,
}

/// A mechanism and those that a fault of that size is confused with.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Confusion {
    pub(crate) mechanism: String,
    pub(crate) size: f64,
    /// Whether it shows at all: an inertia does not at a constant speed.
    pub(crate) shows: bool,
    pub(crate) set: Vec<String>,
    /// What a change of the set point would tell it from.
    pub(crate) separable: Vec<Separable>,
    /// The same where no current is measured, if it shows then.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) set_without_current: Option<Vec<String>>,
}

/// A mechanism of a confusion set that another speed takes out of it.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Separable {
    pub(crate) mechanism: String,
    /// Speed to change to, rad/s (m/s).
    pub(crate) speed: f64,
}

impl BankAnswer {
    /// In blocks.
    pub(super) fn blocks(&self) -> Vec<Block> {
        let Self { drive, noise, arl_0, limits, verified, .. } = self;
        let fact = |name: &str, value: String| Fact::new(ALL, name, value);
        let facts = vec![
            fact("Bank over", drive.clone()),
            fact(
                "Noise learned (SI)",
                format!(
                    "speed {}, current {} A, torque {} over {} s",
                    number(noise.omega),
                    number(noise.i),
                    number(noise.torque),
                    number(noise.torque_time)
                ),
            ),
            fact(
                "Limits of the bank",
                format!(
                    "likelihood ratio {}, squares {}, for {arl_0:e} samples between false alarms",
                    number(limits.ratio),
                    number(limits.squares)
                ),
            ),
            fact(
                "Verified",
                format!(
                    "{} alarms in {} fresh healthy samples (at least {:.2e} between, 95 %), {} in \
                     the {} of the recordings",
                    verified.alarms,
                    verified.samples,
                    verified.arl_0_at_least,
                    verified.recorded_alarms,
                    verified.recorded
                ),
            ),
        ];
        let notes = self.confusions.iter().flat_map(Confusion::words).map(Block::Note);
        [Block::Facts(facts)].into_iter().chain(notes).collect()
    }
}

impl Confusion {
    fn words(&self) -> Vec<String> {
        let Self { mechanism, size, shows, set, separable, set_without_current } = self;
        let mut words = Vec::new();
        if !shows {
            words.push(format!("{mechanism} of {} does not show here", number(*size)));
        }
        if !set.is_empty() {
            words.push(format!("{mechanism} cannot be told from {}", set.join(", ")));
        }
        for Separable { mechanism: other, speed } in separable {
            let speed = number(*speed);
            words.push(format!(
                "a set point changed to {speed} (SI) tells {mechanism} from {other}"
            ));
        }
        let blind = set_without_current.iter().flatten();
        let more: Vec<&str> = blind.filter(|it| !set.contains(it)).map(String::as_str).collect();
        if !more.is_empty() {
            let more = more.join(", ");
            words.push(format!("{mechanism}: without the current, nor from {more}"));
        }
        words
    }
}
