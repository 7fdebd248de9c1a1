//! Stretches of samples that share a fault.

use serde::Serialize;

use crate::place::Counted;

/// Stretches that are listed one by one; further ones are only counted.
const LISTED: usize = 100;

/// Consecutive samples that share a fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Stretch {
    /// Line (or row) of the first.
    pub first: u64,
    /// Line (or row) of the last.
    pub last: u64,
}

/// Where a fault occurs: the first hundred stretches, and how many there are.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct Stretches {
    /// The first hundred, in order.
    pub listed: Vec<Stretch>,
    /// All stretches.
    pub count: usize,
    pub samples: usize,
    #[serde(skip)]
    last: usize,
}

impl Stretches {
    /// Adds sample `k` at `line`; samples come in rising order.
    pub(crate) fn add(&mut self, k: usize, line: u64) {
        if self.samples > 0 && self.last + 1 == k {
            if self.count == self.listed.len()
                && let Some(stretch) = self.listed.last_mut()
            {
                stretch.last = line;
            }
        } else {
            self.count += 1;
            if self.listed.len() < LISTED {
                self.listed.push(Stretch { first: line, last: line });
            }
        }
        self.samples += 1;
        self.last = k;
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.samples == 0
    }

    pub(crate) fn text(&self, counted: Counted) -> String {
        let one = match counted {
            Counted::Lines => "line",
            Counted::Rows => "row",
        };
        let shown = self.listed.iter().take(3).map(|it| match it.first == it.last {
            true => format!("{one} {}", it.first),
            false => format!("{one}s {} to {}", it.first, it.last),
        });
        let mut text = shown.collect::<Vec<_>>().join(", ");
        if self.count > 3 {
            text += &format!(" and {} more", self.count - 3);
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretches_join_neighbours_and_stay_small() {
        let mut stretches = Stretches::default();
        for k in [3, 4, 5, 9] {
            stretches.add(k, k as u64 + 2);
        }
        assert_eq!(
            stretches.listed,
            [Stretch { first: 5, last: 7 }, Stretch { first: 11, last: 11 }]
        );
        assert_eq!(stretches.text(Counted::Lines), "lines 5 to 7, line 11");
        for k in (20..20_000).step_by(2) {
            stretches.add(k, k as u64 + 2);
        }
        assert_eq!((stretches.count, stretches.listed.len()), (9992, LISTED));
        stretches.add(19_999, 20_001);
        assert_eq!(stretches.listed.last().unwrap().first, stretches.listed.last().unwrap().last);
    }
}
