//! What healthy machines follow.

use std::f64::consts::PI;

use rand::RngExt;
use serde::Serialize;

use super::machine::Machine;

/// Samples that a machine is watched over.
pub(super) const WATCHED: usize = 20_000;
/// Greatest speed, as a share of the set point that was shown.
const GREATEST: f64 = 1.5;
/// Time between steps, s, and periods of reversals, s.
const STEP_S: (f64, f64) = (0.5, 3.0);
const PERIOD_S: (f64, f64) = (2.0, 20.0);
/// Least set point, as a share of that shown.
const LEAST: f64 = 0.2;

/// What a healthy machine follows after its baseline.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Course {
    /// One of other set points.
    SetPoint,
    /// Steps between random speeds of one sign.
    Steps,
    /// Sines through rest.
    Reversals,
    /// Steps between random speeds of either sign.
    SteppedReversals,
}

impl Course {
    /// All of them.
    pub const ALL: [Self; 4] =
        [Self::SetPoint, Self::Steps, Self::Reversals, Self::SteppedReversals];

    /// Speeds of a baseline of that many samples at the set point that was shown, and of the course
    /// after it.
    pub(super) fn speeds(self, shown: f64, baseline: usize, machine: &mut Machine) -> Vec<f64> {
        let period_s = machine.experiment.period_s;
        let greatest = GREATEST * shown;
        let random = &mut machine.random;
        let mut made = vec![shown; baseline];
        let (held, amplitude): (f64, f64) =
            (random.random_range(LEAST..GREATEST), random.random_range(LEAST..GREATEST));
        let turn_s = random.random_range(PERIOD_S.0..PERIOD_S.1);
        let (mut level, mut left) = (0.0, 0);
        for k in 0..WATCHED {
            made.push(match self {
                Self::SetPoint => held * shown,
                Self::Reversals => {
                    let t = k as f64 * period_s;
                    amplitude * shown * (2.0 * PI * t / turn_s).cos()
                }
                Self::Steps | Self::SteppedReversals => {
                    if left == 0 {
                        left = (random.random_range(STEP_S.0..STEP_S.1) / period_s) as usize;
                        let least = if self == Self::Steps { LEAST * shown } else { -greatest };
                        level = random.random_range(least..greatest);
                    }
                    left -= 1;
                    level
                }
            });
        }
        made
    }
}
