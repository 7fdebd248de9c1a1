//! From a channel's raw values to physical ones.

use super::blocks::Blocks;
use crate::error::Error;

/// Pairs of numbers in a table.
const MOST_PAIRS: usize = 100_000;

/// A conversion of numbers into numbers.
#[derive(Debug)]
pub(super) enum Conversion {
    /// Values are physical already, or numbers that stand for words.
    Same,
    /// `offset + factor x`.
    Linear { offset: f64, factor: f64 },
    /// `(a x^2 + b x + c) / (d x^2 + e x + f)`.
    Rational([f64; 6]),
    /// Between the points on straight lines, or the nearest point.
    Table { points: Vec<(f64, f64)>, lines: bool },
}

impl Conversion {
    /// The conversion there with its unit; `None` for a formula.
    pub(super) fn read(
        blocks: &mut Blocks,
        at: u64,
    ) -> Result<Option<(Conversion, String)>, Error> {
        if at == 0 {
            return Ok(Some((Conversion::Same, String::new())));
        }
        let block = blocks.block(at, b"##CC")?;
        let unit = blocks.text(block.link(1))?;
        let count = usize::from(block.u16(6)).min(2 * MOST_PAIRS);
        let values: Vec<f64> = (0..count).map_while(|k| block.f64(24 + 8 * k)).collect();
        let conversion = match (block.byte(0), &values[..]) {
            (1, [offset, factor]) => Conversion::Linear { offset: *offset, factor: *factor },
            (2, [a, b, c, d, e, f]) => Conversion::Rational([*a, *b, *c, *d, *e, *f]),
            (kind @ (4 | 5), [_, _, ..]) => {
                let mut points: Vec<_> = values.chunks_exact(2).map(|it| (it[0], it[1])).collect();
                points.sort_by(|a, b| a.0.total_cmp(&b.0));
                Conversion::Table { points, lines: kind == 4 }
            }
            // Words: the numbers behind them are kept.
            (0 | 7 | 8, _) => Conversion::Same,
            (1 | 2, _) => return Err(blocks.damaged("a conversion lacks numbers")),
            _ => return Ok(None),
        };
        Ok(Some((conversion, unit)))
    }

    pub(super) fn physical(&self, raw: f64) -> f64 {
        match self {
            Conversion::Same => raw,
            Conversion::Linear { offset, factor } => offset + factor * raw,
            Conversion::Rational([a, b, c, d, e, f]) => {
                (a * raw * raw + b * raw + c) / (d * raw * raw + e * raw + f)
            }
            Conversion::Table { points, lines } => {
                let after = points.partition_point(|(x, _)| *x <= raw);
                let (Some(low), Some(high)) = (
                    after.checked_sub(1).and_then(|k| points.get(k)).or(points.first()),
                    points.get(after).or(points.last()),
                ) else {
                    return raw;
                };
                let share = if high.0 > low.0 { (raw - low.0) / (high.0 - low.0) } else { 0.0 };
                match lines {
                    true => low.1 + share.clamp(0.0, 1.0) * (high.1 - low.1),
                    false if share > 0.5 => high.1,
                    false => low.1,
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_of_numbers() {
        assert_eq!(Conversion::Linear { offset: 1.0, factor: 0.5 }.physical(4.0), 3.0);
        let halves = Conversion::Rational([0.0, 1.0, 0.0, 0.0, 0.0, 2.0]);
        assert_eq!(halves.physical(3.0), 1.5);
        let points = vec![(0.0, 0.0), (1.0, 10.0), (2.0, 40.0)];
        let between = Conversion::Table { points: points.clone(), lines: true };
        assert_eq!([-1.0, 0.5, 1.5, 9.0].map(|x| between.physical(x)), [0.0, 5.0, 25.0, 40.0]);
        let nearest = Conversion::Table { points, lines: false };
        assert_eq!([-1.0, 0.4, 0.6, 9.0].map(|x| nearest.physical(x)), [0.0, 0.0, 10.0, 40.0]);
    }
}
