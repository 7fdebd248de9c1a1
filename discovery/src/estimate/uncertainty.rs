//! Standard errors of the estimates.
//!
//! With C the sensitivities, r the residual and H = C C^T, the classical covariance is
//! s^2 H^-1. It holds for white noise. A random load, or what the model lacks, makes the residual
//! coloured: then the sandwich H^-1 (sum_b u_b u_b^T) H^-1 over blocks of time b holds, if a block
//! is longer than the residual remembers. The scores are those of Bell and McCaffrey (2002),
//! u_b = (I - H_b H^-1)^(-1/2) C_b r_b, which correct for what the fit itself has taken out of a
//! block (for white noise the expectation is exact). The larger of the two is reported.

use nalgebra::{DMatrix, DVector};

/// Least and greatest length of a block, s.
const SHORTEST_S: f64 = 0.1;
const LONGEST_S: f64 = 0.5;
/// Correlation times in a block.
const TIMES: f64 = 5.0;
/// Share of a direction's information that one block may hold at most in the correction; what a
/// block alone tells (a start) would be corrected without limit.
const LARGEST_SHARE: f64 = 0.9;
/// Fewer blocks than these an unknown, and the sandwich says nothing.
const BLOCKS_AN_UNKNOWN: usize = 2;

/// What one block of time adds to gradient and curvature.
pub(crate) struct BlockScore {
    /// C r of the block.
    pub(crate) gradient: DVector<f64>,
    /// C C^T of the block.
    pub(crate) normal_matrix: DMatrix<f64>,
}

/// Length of a block, s, for residuals (one list an output and recording, NaN left out): several
/// times the longest correlation time, within [`SHORTEST_S`] and [`LONGEST_S`], but so that there
/// are enough blocks for that many unknowns.
pub(super) fn block_s<'a>(
    residuals: impl Iterator<Item = (&'a [f64], f64)>,
    duration_s: f64,
    unknowns: usize,
) -> f64 {
    let times =
        residuals.map(|(residual, period_s)| period_s * correlation_samples(residual, period_s));
    let wanted = (TIMES * times.fold(0.0, f64::max)).clamp(SHORTEST_S, LONGEST_S);
    wanted.min(duration_s / (BLOCKS_AN_UNKNOWN * unknowns.max(1)) as f64).max(SHORTEST_S)
}

/// Sum of the autocorrelations up to where they are lost in their own uncertainty, samples.
pub(crate) fn correlation_samples(residual: &[f64], period_s: f64) -> f64 {
    let values: Vec<f64> = residual.iter().map(|r| if r.is_finite() { *r } else { 0.0 }).collect();
    let power: f64 = values.iter().map(|r| r * r).sum();
    let lost = 2.0 / (values.len() as f64).sqrt();
    let longest = ((LONGEST_S / period_s) as usize).min(values.len().saturating_sub(1));
    // Every lag up to ten, then fewer: a long memory is smooth.
    let (mut sum, mut lag) = (0.0, 1);
    while lag <= longest {
        let next = lag + (lag / 10).max(1);
        let products = values[lag..].iter().zip(&values).map(|(a, b)| a * b);
        let rho = products.sum::<f64>() / power;
        if rho.is_nan() || rho < lost {
            break;
        }
        sum += rho * (next - lag) as f64;
        lag = next;
    }
    sum
}

/// Covariance of the unknowns: `information` is H with the weights of the guesses, `variance`
/// that of the residual in units of the noise. Nothing if H is singular.
pub(super) fn covariance(
    information: &DMatrix<f64>,
    variance: f64,
    blocks: &[BlockScore],
) -> Option<DMatrix<f64>> {
    let factor = information.clone().cholesky()?;
    let inverse = factor.inverse();
    let classical = &inverse * variance;
    let unknowns = information.nrows();
    let used: Vec<&BlockScore> =
        blocks.iter().filter(|it| it.normal_matrix.trace() > 0.0).collect();
    if used.len() < BLOCKS_AN_UNKNOWN * unknowns {
        return Some(classical);
    }
    let lower = factor.l();
    let mut middle = DMatrix::zeros(unknowns, unknowns);
    for block in used {
        let score = corrected(block, &lower)?;
        middle.ger(1.0, &score, &score, 1.0);
    }
    let robust = &inverse * middle * &inverse;
    // The larger variance; correlations are those of the classical one.
    let ratio = |k: usize| (robust[(k, k)] / classical[(k, k)]).max(1.0).sqrt();
    let ratios = DVector::from_fn(unknowns, |k, _| ratio(k));
    Some(DMatrix::from_fn(unknowns, unknowns, |j, k| classical[(j, k)] * ratios[j] * ratios[k]))
}

/// L (I - S)^(-1/2) L^-1 C_b r_b with S = L^-1 H_b L^-T, L L^T = H.
fn corrected(block: &BlockScore, lower: &DMatrix<f64>) -> Option<DVector<f64>> {
    if lower.is_empty() {
        return None;
    }
    let half = lower.solve_lower_triangular(&block.normal_matrix)?;
    let mut share = lower.solve_lower_triangular(&half.transpose())?;
    share = (&share + share.transpose()) * 0.5;
    let eigen = share.symmetric_eigen();
    let weight = eigen.eigenvalues.map(|s| 1.0 / (1.0 - s.clamp(0.0, LARGEST_SHARE)).sqrt());
    let inner = lower.solve_lower_triangular(&block.gradient)?;
    let rotated = eigen.eigenvectors.tr_mul(&inner).component_mul(&weight);
    Some(lower * (eigen.eigenvectors * rotated))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::gaussian;

    const SAMPLES: usize = 4000;
    const BLOCK: usize = 100;

    /// Two regressors of a made-up problem, one of them busy in a tenth of the time only.
    fn column(k: usize) -> [f64; 2] {
        [(0.01 * k as f64).sin(), if k < SAMPLES / 10 { 1.0 } else { 0.1 }]
    }

    /// Ratio of the reported to the true standard error over many draws of a noise.
    fn ratios(noise: impl Fn(u64) -> Vec<f64>) -> [f64; 2] {
        let mut information = DMatrix::zeros(2, 2);
        for k in 0..SAMPLES {
            let c = DVector::from_column_slice(&column(k));
            information.ger(1.0, &c, &c, 1.0);
        }
        let inverse = information.clone().cholesky().expect("regular").inverse();
        let (mut reported, mut true_squares) = ([0.0; 2], [0.0; 2]);
        const DRAWS: u64 = 300;
        for seed in 0..DRAWS {
            let noise = noise(seed);
            let blocks = |residual: &[f64]| -> Vec<BlockScore> {
                let block = |b: usize| {
                    let mut score = BlockScore {
                        gradient: DVector::zeros(2),
                        normal_matrix: DMatrix::zeros(2, 2),
                    };
                    for k in b * BLOCK..(b + 1) * BLOCK {
                        let c = DVector::from_column_slice(&column(k));
                        score.gradient += &c * residual[k];
                        score.normal_matrix.ger(1.0, &c, &c, 1.0);
                    }
                    score
                };
                (0..SAMPLES / BLOCK).map(block).collect()
            };
            let score: DVector<f64> = blocks(&noise).iter().map(|it| it.gradient.clone()).sum();
            let estimate = &inverse * score;
            let residual: Vec<f64> = (0..SAMPLES)
                .map(|k| noise[k] - column(k)[0] * estimate[0] - column(k)[1] * estimate[1])
                .collect();
            let variance = residual.iter().map(|r| r * r).sum::<f64>() / (SAMPLES - 2) as f64;
            let found = covariance(&information, variance, &blocks(&residual)).expect("regular");
            for k in 0..2 {
                reported[k] += found[(k, k)] / DRAWS as f64;
                true_squares[k] += estimate[k] * estimate[k] / DRAWS as f64;
            }
        }
        [0, 1].map(|k| (reported[k] / true_squares[k]).sqrt())
    }

    #[test]
    fn white_noise_gives_hardly_more_than_the_classical_error() {
        // 300 draws know a standard deviation to 4 %; the larger of two estimates adds some, and
        // more where four blocks hold nearly all that is known of a parameter.
        let [spread, concentrated] = ratios(|seed| gaussian(SAMPLES, seed));
        assert!((0.93..1.12).contains(&spread), "{spread}");
        assert!((0.93..1.4).contains(&concentrated), "{concentrated}");
    }

    #[test]
    fn coloured_noise_is_seen_by_the_blocks() {
        // Correlated over 20 samples: the classical error would be a sixth of the true one.
        let coloured = |seed| {
            let mut state = 0.0;
            let step = |draw: f64| {
                state = 0.95 * state + 0.312 * draw;
                state
            };
            gaussian(SAMPLES, seed).into_iter().map(step).collect()
        };
        let found = ratios(coloured);
        assert!(found.iter().all(|ratio| (0.75..1.25).contains(ratio)), "{found:?}");
    }

    #[test]
    fn a_block_is_longer_than_the_memory() {
        let white = gaussian(8000, 5);
        assert_eq!(block_s([(white.as_slice(), 1e-3)].into_iter(), 8.0, 8), SHORTEST_S);
        let mut state = 0.0;
        let slow = white.iter().map(|draw| {
            state = 0.98 * state + draw;
            state
        });
        let slow: Vec<f64> = slow.collect();
        // 49 samples of memory, five times over.
        let found =
            block_s([(white.as_slice(), 1e-3), (slow.as_slice(), 1e-3)].into_iter(), 8.0, 8);
        assert!((0.15..0.4).contains(&found), "{found}");
    }
}
