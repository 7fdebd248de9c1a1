//! Which share of the scenarios a run takes, as it is typed.

use std::fmt;
use std::ops::Range;
use std::str::FromStr;

use drivescope_scenarios::campaign::PART;
use thiserror::Error;

/// Why a text is no share of the scenarios.
#[derive(Debug, Clone, PartialEq, Error)]
pub(super) enum ShardError {
    /// Not two numbers.
    #[error("write I/N, such as 2/8 for the second of eight shares")]
    Form,
    /// A share that is not there.
    #[error("{index}/{of}: shares are numbered from 1 to their number")]
    Range {
        index: u64,
        /// Of how many.
        of: u64,
    },
    /// Not a range.
    #[error("write FIRST..LAST")]
    Scenarios,
}

/// One of N shares.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Shard {
    index: u64,
    of: u64,
}

impl Shard {
    /// All of it.
    pub(super) const WHOLE: Self = Self { index: 1, of: 1 };

    /// Whether it is the whole.
    pub(super) fn is_whole(self) -> bool {
        self.of == 1
    }

    /// The parts of the share, of a campaign of so many scenarios: every N-th.
    pub(super) fn parts(self, scenarios: u64) -> impl Iterator<Item = Range<u64>> {
        let parts = (self.index - 1..scenarios.div_ceil(PART)).step_by(self.of as usize);
        parts.map(move |part| part * PART..((part + 1) * PART).min(scenarios))
    }
}

impl FromStr for Shard {
    type Err = ShardError;

    fn from_str(text: &str) -> Result<Self, ShardError> {
        let (index, of) = text.split_once('/').ok_or(ShardError::Form)?;
        let number = |text: &str| text.trim().parse().map_err(|_| ShardError::Form);
        let (index, of) = (number(index)?, number(of)?);
        if index == 0 || index > of {
            return Err(ShardError::Range { index, of });
        }
        Ok(Self { index, of })
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.of)
    }
}

/// A range of scenarios.
#[derive(Debug, Clone)]
pub(super) struct Scenarios(pub(super) Range<u64>);

impl FromStr for Scenarios {
    type Err = ShardError;

    fn from_str(text: &str) -> Result<Self, ShardError> {
        let (first, last) = text.split_once("..").ok_or(ShardError::Scenarios)?;
        let number = |text: &str| text.parse().map_err(|_| ShardError::Scenarios);
        Ok(Self(number(first)?..number(last)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_all_there_is_and_nothing_twice() {
        let scenarios = 10 * PART + 7;
        let mut taken: Vec<_> = (1..=3)
            .flat_map(|index| Shard { index, of: 3 }.parts(scenarios).collect::<Vec<_>>())
            .collect();
        taken.sort_by_key(|range| range.start);
        assert_eq!(taken, Shard::WHOLE.parts(scenarios).collect::<Vec<_>>());
        assert_eq!((taken[0].start, taken[10].end), (0, scenarios));
        assert!(taken.windows(2).all(|pair| pair[0].end == pair[1].start));
        for (text, said) in
            [("3", "write I/N"), ("0/3", "from 1"), ("4/3", "from 1"), ("a/3", "I/N")]
        {
            let error = text.parse::<Shard>().expect_err(text).to_string();
            assert!(error.contains(said), "{text}: {error}");
        }
        assert_eq!("2/3".parse(), Ok(Shard { index: 2, of: 3 }));
    }
}
