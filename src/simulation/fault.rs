//! A fault as it is typed: `KIND=SIZE[@FROM[..[TO]]][:PROFILE]`, such as `tacho=5%@20..25` or
//! `tacho=20%@5:ramp=10`.

use std::ops::Range;
use std::str::FromStr;

use drivescope_plant::fault::{MECHANISMS, Mechanism};
use drivescope_scenarios::profile::{Profile, ProfileError};
use thiserror::Error;

/// A fault over a span of time.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FaultOverTime {
    pub(crate) mechanism: &'static Mechanism,
    /// Its size; a fraction where the mechanism's unit is 1.
    pub(crate) size: f64,
    /// Onset, s.
    pub(crate) from_s: f64,
    /// End, s; infinite if it stays.
    pub(crate) to_s: f64,
    /// How its size goes between them.
    pub(crate) profile: Profile,
}

/// Why a text is no fault.
#[derive(Debug, Clone, PartialEq, Error)]
pub(crate) enum FaultError {
    /// There is no size.
    #[error("write KIND=SIZE, such as `tacho=0.05` or `tacho=5%@20..25`")]
    NoSize,
    /// No such mechanism.
    #[error("there is no fault `{kind}`; known are {known}")]
    Kind {
        /// What was given.
        kind: String,
        /// The mechanisms.
        known: String,
    },
    /// No number.
    #[error("`{text}` is no finite number")]
    Number {
        /// What was given.
        text: String,
    },
    /// Per cent of something that is no fraction.
    #[error("the size of `{kind}` is in {unit}, not a fraction: leave out `%`")]
    Percent {
        /// The mechanism.
        kind: &'static str,
        unit: &'static str,
    },
    /// More than everything is lost.
    #[error("a loss of more than 100 % is not possible")]
    Loss,
    /// The end does not lie after the onset.
    #[error("it ends at {to_s} s, which is not after its onset at {from_s} s")]
    Span {
        /// Onset, s.
        from_s: f64,
        /// End, s.
        to_s: f64,
    },
    /// No profile.
    #[error(transparent)]
    Profile(#[from] ProfileError),
}

impl FromStr for FaultOverTime {
    type Err = FaultError;

    fn from_str(text: &str) -> Result<Self, FaultError> {
        let (kind, rest) = text.split_once('=').ok_or(FaultError::NoSize)?;
        let kind = kind.trim();
        let mechanism = MECHANISMS.iter().find(|known| known.id == kind).ok_or_else(|| {
            let known: Vec<_> = MECHANISMS.iter().map(|known| known.id).collect();
            FaultError::Kind { kind: kind.to_owned(), known: known.join(", ") }
        })?;
        let (rest, profile) = match rest.split_once(':') {
            Some((rest, profile)) => (rest, profile.parse()?),
            None => (rest, Profile::Step),
        };
        let (size, span) =
            rest.split_once('@').map_or((rest, None), |(size, span)| (size, Some(span)));
        let size = match size.trim().strip_suffix('%') {
            Some(_) if mechanism.unit != "1" => {
                return Err(FaultError::Percent { kind: mechanism.id, unit: mechanism.unit });
            }
            Some(percent) => number(percent)? / 100.0,
            None => number(size)?,
        };
        if mechanism.unit == "1" && mechanism.id != "load" && size < -1.0 {
            return Err(FaultError::Loss);
        }
        let (from_s, to_s) = match span.map(|span| span.split_once("..").ok_or(span)) {
            None => (0.0, f64::INFINITY),
            Some(Err(from)) => (number(from)?, f64::INFINITY),
            Some(Ok((from, to))) if to.trim().is_empty() => (number(from)?, f64::INFINITY),
            Some(Ok((from, to))) => (number(from)?, number(to)?),
        };
        if to_s <= from_s {
            return Err(FaultError::Span { from_s, to_s });
        }
        Ok(Self { mechanism, size, from_s, to_s, profile })
    }
}

impl FaultOverTime {
    /// The size that acts during each sample, which begins at k x `period_s`; an onset between two
    /// samples acts from the later one. The seed is that of what comes at random.
    pub(crate) fn sizes(&self, samples: usize, period_s: f64, seed: u64) -> Vec<f64> {
        let shares = self.profile.shares(self.span(period_s), samples, period_s, seed);
        shares.into_iter().map(|share| self.size * share).collect()
    }

    /// Whether any of the samples lies in its span.
    pub(crate) fn is_within(&self, samples: usize, period_s: f64) -> bool {
        let span = self.span(period_s);
        !span.is_empty() && span.start < samples
    }

    /// The samples from its onset to its end.
    fn span(&self, period_s: f64) -> Range<usize> {
        // A time typed in decimals may lie a rounding beside k x period.
        let sample = |time: f64| (time / period_s - 1e-6).ceil().max(0.0) as usize;
        sample(self.from_s)..sample(self.to_s)
    }
}

fn number(text: &str) -> Result<f64, FaultError> {
    let value = text.trim().parse().ok().filter(|value: &f64| value.is_finite());
    value.ok_or_else(|| FaultError::Number { text: text.trim().to_owned() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fault(text: &str) -> FaultOverTime {
        text.parse().unwrap_or_else(|error| panic!("{text}: {error}"))
    }

    #[test]
    fn sizes_and_spans_are_read() {
        let tacho = fault("tacho=5%@20..25");
        assert_eq!((tacho.mechanism.id, tacho.from_s, tacho.to_s), ("tacho", 20.0, 25.0));
        assert!((tacho.size - 0.05).abs() < 1e-15);
        assert_eq!(fault("load = -0.2 @ 1").to_s, f64::INFINITY);
        assert_eq!(fault("load=-0.2@1.."), fault("load=-0.2@1"));
        assert_eq!(fault("tacho_bias=2").size, 2.0);
        // 0.3 / 0.1 is just below 3.
        let sizes = |text: &str| fault(text).sizes(6, 0.1, 0);
        assert_eq!(sizes("flux=0.1@0.3..0.5"), [0.0, 0.0, 0.0, 0.1, 0.1, 0.0]);
        let ramp = sizes("flux = 0.2 @ 0.1 : ramp=0.2");
        let exact = [0.0, 0.0, 0.1, 0.2, 0.2, 0.2];
        assert!(ramp.iter().zip(exact).all(|(a, b)| (a - b).abs() < 1e-12), "{ramp:?}");
    }

    #[test]
    fn what_is_no_fault_is_said() {
        for (text, said) in [
            ("tacho", "KIND=SIZE"),
            ("tacko=1", "`tacko`"),
            ("tacho=x", "`x`"),
            ("tacho=nan", "`nan`"),
            ("tacho_bias=5%", "rad/s"),
            ("flux=-150%", "100 %"),
            ("flux=0.1@5..2", "not after"),
            ("flux=0.1@", "``"),
            ("flux=0.1@2:slope", "no profile"),
            ("flux=0.1:ramp=-1", "`-1`"),
        ] {
            let error = text.parse::<FaultOverTime>().expect_err(text).to_string();
            assert!(error.contains(said), "{text}: {error}");
        }
    }
}
