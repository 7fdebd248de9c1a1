//! Fault identification (27): how large a fault is, by how far residuals leave their thresholds.
//!
//! S(f) = mean of |r| / T over the samples of a fault. r is counted from the middle of the band and
//! T is its half width, so that bands that are not centred on zero (6), (7), (19) serve as well. S
//! depends on T, hence on the noise: sizes are small, medium or large relative to the set of faults.
//! The groups are those three that leave the least scatter of ln S within them (W. D. Fisher,
//! J. Am. Stat. Assoc. 53 (1958), 789-798), which are the paper's for the paper's Table 3.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::decision::{SpanError, Trace};
use crate::threshold::Band;
use crate::verdict::Verdict;

/// Size of a fault relative to others.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Size {
    /// Of the smallest.
    Small,
    /// Between.
    Medium,
    /// Of the largest.
    Large,
}

impl Size {
    /// Name for people.
    pub fn label(self) -> &'static str {
        match self {
            Self::Small => "small",
            Self::Medium => "medium",
            Self::Large => "large",
        }
    }
}

/// S (27) over a span of a run; infinite where a band has no width.
pub fn fault_size(trace: &Trace, span: Range<usize>) -> Result<f64, SpanError> {
    trace.check(&span)?;
    let n = span.len() as f64;
    let ratio = |k: usize| {
        let Verdict { residual, lower, upper, .. } = trace.verdicts[k];
        thresholds_off(residual, &Band { lower, upper })
    };
    Ok(span.map(ratio).sum::<f64>() / n)
}

/// |r| / T of one sample: distance from the middle of the band over its half width.
pub(crate) fn thresholds_off(residual: f64, band: &Band) -> f64 {
    let (middle, half) = (0.5 * (band.upper + band.lower), 0.5 * (band.upper - band.lower));
    (residual - middle).abs() / half
}

/// Groups of faults by S, in the order given. Fewer than three different sizes leave groups empty,
/// from the middle on; sizes that are not positive and finite are small or large.
pub fn size_groups(sizes: &[f64]) -> Vec<Size> {
    let logarithm = |size: f64| {
        let positive =
            if size > 0.0 { size.clamp(f64::MIN_POSITIVE, f64::MAX) } else { f64::MIN_POSITIVE };
        positive.ln()
    };
    let mut sorted: Vec<f64> = sizes.iter().map(|size| logarithm(*size)).collect();
    sorted.sort_by(f64::total_cmp);
    sorted.dedup();
    let n = sorted.len();
    let scatter = |part: &[f64]| -> f64 {
        let mean = part.iter().sum::<f64>() / part.len() as f64;
        part.iter().map(|x| (x - mean) * (x - mean)).sum()
    };
    let (first, second) = match n {
        0 | 1 => (n, n),
        2 => (1, 1),
        _ => {
            let mut best = (1, 2, f64::INFINITY);
            for first in 1..n - 1 {
                for second in first + 1..n {
                    let parts = [&sorted[..first], &sorted[first..second], &sorted[second..]];
                    let total: f64 = parts.into_iter().map(scatter).sum();
                    if total < best.2 {
                        best = (first, second, total);
                    }
                }
            }
            (best.0, best.1)
        }
    };
    let group = |size: &f64| {
        let rank = sorted.partition_point(|x| *x < logarithm(*size));
        match rank {
            rank if rank < first => Size::Small,
            rank if rank < second => Size::Medium,
            _ => Size::Large,
        }
    };
    sizes.iter().map(group).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Table 3: f_1..6^1, then f_1..6^2.
    const TABLE_3: [f64; 12] =
        [2.45, 3.32, 5.34, 6.19, 10.9, 11.64, 17.39, 8.27, 8.61, 8.65, 2.28, 1.73];

    #[test]
    fn the_papers_sizes_fall_into_the_papers_groups() {
        use Size::{Large, Medium, Small};
        let paper = [
            Small, Small, Medium, Medium, Large, Large, Large, Medium, Medium, Medium, Small, Small,
        ];
        assert_eq!(size_groups(&TABLE_3), paper);
        // Relative: another threshold, the same groups.
        assert_eq!(size_groups(&TABLE_3.map(|s| 4.5 * s)), paper);
        // Broken on purpose: sizes in another order give other groups.
        let mut reversed = TABLE_3;
        reversed.reverse();
        assert_ne!(size_groups(&reversed), paper);
        assert_eq!(size_groups(&[1.0, 5.0]), [Small, Large]);
        assert_eq!(size_groups(&[2.0, 2.0]), [Small, Small]);
    }

    #[test]
    fn the_size_is_counted_from_the_middle_of_the_band() {
        let verdict =
            Verdict { residual: 7.0, lower: -1.0, upper: 3.0, exceeds: true, declared: false };
        let trace = Trace { verdicts: vec![verdict; 10], run_up: 2, window: 1 };
        assert_eq!(fault_size(&trace, 2..10), Ok(3.0));
        assert!(matches!(fault_size(&trace, 0..10), Err(SpanError::InRunUp { .. })));
        assert!(matches!(fault_size(&trace, 5..11), Err(SpanError::OutsideRun { .. })));
    }
}
