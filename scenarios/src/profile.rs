//! How the size of a fault goes with time: at once, growing, in pulses, or coming and going.
//!
//! Written as in `step`, `ramp=5`, `pulses=0.1/1`, `intermittent=0.5/2`, times in seconds. A drift
//! is a ramp of a bias; simultaneous faults are several of them.

use std::fmt;
use std::ops::Range;
use std::str::FromStr;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use thiserror::Error;

/// A time that lies that share of a sample beside one is meant to be it: 0.3 / 0.1 is below 3.
const ROUNDING: f64 = 1e-6;

/// How a fault acts between its onset and its end.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Profile {
    /// With full size.
    #[default]
    Step,
    /// Grows in proportion to time over that many seconds, then stays: incipient, or a drift.
    Ramp {
        /// Time to full size, s.
        over_s: f64,
    },
    /// Regular pulses, the first at the onset.
    Pulses {
        /// Length of a pulse, s.
        on_s: f64,
        /// Time from one to the next, s.
        every_s: f64,
    },
    /// Comes and goes at random, as a loose contact does: both times are exponential.
    Intermittent {
        /// Mean time for which it acts, s.
        on_s: f64,
        /// Mean time for which it does not, s.
        off_s: f64,
    },
}

/// Why a text is no profile.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ProfileError {
    /// No such profile.
    #[error(
        "`{text}` is no profile: write step, ramp=SECONDS, pulses=ON/EVERY or intermittent=ON/OFF"
    )]
    Unknown {
        /// What was given.
        text: String,
    },
    /// A time that is none.
    #[error("`{text}` is not a time above 0 s")]
    Time {
        /// What was given.
        text: String,
    },
    /// A pulse outlasts its period.
    #[error("pulses of {on_s} s do not fit into {every_s} s")]
    Overlap {
        /// Length of a pulse, s.
        on_s: f64,
        /// Time from one to the next, s.
        every_s: f64,
    },
}

impl FromStr for Profile {
    type Err = ProfileError;

    fn from_str(text: &str) -> Result<Self, ProfileError> {
        let unknown = || ProfileError::Unknown { text: text.trim().to_owned() };
        let (kind, times) = text.split_once('=').unwrap_or((text, ""));
        let two = || times.split_once('/').ok_or_else(unknown);
        match kind.trim() {
            "step" if times.is_empty() => Ok(Self::Step),
            "ramp" => Ok(Self::Ramp { over_s: time(times)? }),
            "pulses" => {
                let (on, every) = two()?;
                let (on_s, every_s) = (time(on)?, time(every)?);
                if on_s >= every_s {
                    return Err(ProfileError::Overlap { on_s, every_s });
                }
                Ok(Self::Pulses { on_s, every_s })
            }
            "intermittent" => {
                let (on, off) = two()?;
                Ok(Self::Intermittent { on_s: time(on)?, off_s: time(off)? })
            }
            _ => Err(unknown()),
        }
    }
}

fn time(text: &str) -> Result<f64, ProfileError> {
    let value = text.trim().parse().ok().filter(|s: &f64| s.is_finite() && *s > 0.0);
    value.ok_or_else(|| ProfileError::Time { text: text.trim().to_owned() })
}

impl fmt::Display for Profile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Step => write!(f, "step"),
            Self::Ramp { over_s } => write!(f, "ramp={over_s}"),
            Self::Pulses { on_s, every_s } => write!(f, "pulses={on_s}/{every_s}"),
            Self::Intermittent { on_s, off_s } => write!(f, "intermittent={on_s}/{off_s}"),
        }
    }
}

impl Profile {
    /// The share of the full size that acts at each of `samples` samples, `period_s` apart, of a
    /// fault over a span of them. The seed is that of what comes at random.
    pub fn shares(&self, span: Range<usize>, samples: usize, period_s: f64, seed: u64) -> Vec<f64> {
        let mut shares = vec![0.0; samples];
        let within = span.start.min(samples)..span.end.min(samples);
        let acting = &mut shares[within];
        match *self {
            Self::Step => acting.fill(1.0),
            Self::Ramp { over_s } => {
                let grown = |k: usize| (k as f64 * period_s / over_s).min(1.0);
                acting.iter_mut().enumerate().for_each(|(k, share)| *share = grown(k));
            }
            Self::Pulses { on_s, every_s } => {
                for (k, share) in acting.iter_mut().enumerate() {
                    let since = (k as f64 + ROUNDING) * period_s % every_s;
                    *share = f64::from(since < on_s);
                }
            }
            Self::Intermittent { on_s, off_s } => {
                let mut random = Pcg64Mcg::seed_from_u64(seed);
                let (mut acts, mut until) = (false, 0.0);
                for (k, share) in acting.iter_mut().enumerate() {
                    while until <= k as f64 * period_s {
                        acts = !acts;
                        let uniform: f64 = random.random();
                        until -= (1.0 - uniform).ln() * if acts { on_s } else { off_s };
                    }
                    *share = f64::from(acts);
                }
            }
        }
        shares
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn profile(text: &str) -> Profile {
        text.parse().unwrap_or_else(|error| panic!("{text}: {error}"))
    }

    #[test]
    fn what_is_written_is_read() {
        for text in ["step", "ramp=5", "pulses=0.1/1", "intermittent=0.5/2"] {
            assert_eq!(profile(text).to_string(), text);
        }
        for (text, said) in [
            ("slope=3", "no profile"),
            ("step=3", "no profile"),
            ("pulses=1", "no profile"),
            ("ramp=0", "not a time"),
            ("ramp=x", "`x`"),
            ("pulses=2/1", "do not fit"),
            ("intermittent=1/-2", "`-2`"),
        ] {
            let error = text.parse::<Profile>().expect_err(text).to_string();
            assert!(error.contains(said), "{text}: {error}");
        }
    }

    #[test]
    fn a_ramp_grows_and_stays_and_pulses_come_in_time() {
        assert_eq!(profile("step").shares(1..3, 4, 0.1, 0), [0.0, 1.0, 1.0, 0.0]);
        let ramp = profile("ramp=0.4").shares(1..8, 9, 0.1, 0);
        let exact = [0.0, 0.0, 0.25, 0.5, 0.75, 1.0, 1.0, 1.0, 0.0];
        assert!(ramp.iter().zip(exact).all(|(a, b)| (a - b).abs() < 1e-12), "{ramp:?}");
        // 0.3 s is three samples, though 0.3 / 0.1 is below 3.
        let pulses = profile("pulses=0.1/0.3").shares(2..usize::MAX, 10, 0.1, 0);
        assert_eq!(pulses, [0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0]);
        assert_eq!(profile("step").shares(7..9, 4, 0.1, 0), [0.0; 4]);
    }

    #[test]
    fn what_comes_and_goes_acts_for_its_share_of_the_time_and_is_repeatable() {
        let of = |seed| profile("intermittent=0.5/1.5").shares(0..100_000, 100_000, 0.01, seed);
        let acts: f64 = of(1).iter().sum::<f64>() / 1e5;
        // 500 times on and off: a share of 0.25 with a standard error of 0.012.
        assert!((acts - 0.25).abs() < 0.05, "{acts}");
        assert_eq!(of(1)[0], 1.0);
        assert_eq!(of(1), of(1));
        assert_ne!(of(1), of(2));
    }
}
