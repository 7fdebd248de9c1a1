//! The smoothest values of a curve that explain as much, and which of them are told.
//!
//! Least squares alone lets what no recording tells (a knot that was hardly visited, a slope that
//! the base's own viscous friction imitates) run away, and the curve is then worth nothing beyond
//! these data. So the values v of the hats minimise
//!
//! |r - C^T v|^2 + w |D v|^2 + e |v|^2,
//!
//! D the second differences, w the weight that is best by BIC with tr((M + P)^-1 M) parameters
//! (Eilers and Marx, 1996), M the information and P the penalties; e is what a direction must
//! stand out of the base.

use nalgebra::{DMatrix, DVector};

use super::projection::{Products, STANDS_OUT};

/// Powers of ten that are tried as weights, relative to the information.
const POWERS: std::ops::RangeInclusive<i32> = -8..=3;
/// Standard error of a value, as a share of the largest, from which on it is not told.
const TOLD: f64 = 0.5;
/// Share of a hat's squared length that must be new, the base and the other hats taken out.
const NEW: f64 = 1e-4;

/// The values at the knots; `samples` is the number of values of the residual.
pub(crate) fn smooth(products: &Products, periodic: bool, samples: usize) -> DVector<f64> {
    let Products { information, whole, score } = products;
    let n = score.len();
    let rough = roughness(n, periodic);
    let mean = whole.iter().sum::<f64>() / n as f64;
    let ridge = DMatrix::from_diagonal_element(n, n, (STANDS_OUT * mean).max(f64::MIN_POSITIVE));
    let unit = information.trace().max(0.0) / rough.trace().max(1.0);
    let price = (samples as f64).ln();
    let tried = POWERS.filter_map(|power| {
        let penalty = &rough * (unit * 10f64.powi(power)) + &ridge;
        let factor = (information + penalty).cholesky()?;
        let values = factor.solve(score);
        let gain = 2.0 * values.dot(score) - values.dot(&(information * &values));
        let parameters = factor.solve(information).trace();
        Some((price * parameters - gain, values))
    });
    let best = tried.min_by(|a, b| a.0.total_cmp(&b.0));
    best.map_or_else(|| DVector::zeros(n), |(_, values)| values)
}

/// Which values the recordings tell, given the others: the rest is better kept.
pub(crate) fn told(products: &Products, values: &DVector<f64>) -> Vec<bool> {
    let size = values.amax();
    let n = values.len();
    let mut left = products.information.clone();
    let mut told = vec![false; n];
    loop {
        let open = (0..n).filter(|k| !told[*k]);
        let Some(best) = open.max_by(|a, b| left[(*a, *a)].total_cmp(&left[(*b, *b)])) else {
            return told;
        };
        let pivot = left[(best, best)];
        let enough = (1.0 / (TOLD * size).powi(2)).max(NEW * products.whole[best]);
        // Not so, too, where the size is 0 and nothing is known.
        if !(pivot > enough && pivot.is_finite()) {
            return told;
        }
        told[best] = true;
        let column = left.column(best).into_owned();
        left.ger(-1.0 / pivot, &column, &column, 1.0);
    }
}

/// D^T D of the second differences.
fn roughness(n: usize, periodic: bool) -> DMatrix<f64> {
    let rows = if periodic { n } else { n.saturating_sub(2) };
    let mut differences = DMatrix::zeros(rows, n);
    for row in 0..rows {
        for (step, weight) in [1.0, -2.0, 1.0].into_iter().enumerate() {
            differences[(row, (row + step) % n)] += weight;
        }
    }
    differences.tr_mul(&differences)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discover::projection::Projection;
    use crate::testing::gaussian;

    const SAMPLES: usize = 4000;
    const KNOTS: usize = 11;
    const HEIGHT: f64 = 6.0;
    /// Straight lines between knots as far apart as the bump is wide cut its top.
    const ROUNDED: f64 = 0.35;

    /// Hats over a variable that never comes near the last two knots; the base has a line.
    fn projection() -> (Projection, DMatrix<f64>) {
        let z = |k: usize| 4.0 + 4.0 * (0.01 * k as f64).sin();
        let hats =
            DMatrix::from_fn(KNOTS, SAMPLES, |knot, k| (1.0 - (z(k) - knot as f64).abs()).max(0.0));
        let bump = |k: usize| HEIGHT * (-(z(k) - 3.0).powi(2)).exp();
        let noise = gaussian(SAMPLES, 8);
        let residual: Vec<f64> = (0..SAMPLES).map(|k| bump(k) + 0.3 * z(k) + noise[k]).collect();
        let base = DMatrix::from_fn(2, SAMPLES, |row, k| if row == 0 { 1.0 } else { z(k) });
        (Projection::new(base, &residual), hats)
    }

    #[test]
    fn a_bump_is_found_and_what_was_never_seen_goes_on_smoothly() {
        let (projection, hats) = projection();
        let products = projection.products(&hats);
        let values = smooth(&products, false, SAMPLES);
        // Whatever line the base may have for itself: differences of second order.
        let bend = |k: usize| values[k + 1] - 2.0 * values[k] + values[k - 1];
        let expected = |k: usize| {
            let bump = |z: usize| HEIGHT * (-(z as f64 - 3.0).powi(2)).exp();
            bump(k + 1) - 2.0 * bump(k) + bump(k - 1)
        };
        for k in 1..7 {
            let off = (bend(k) - expected(k)).abs();
            assert!(off < ROUNDED * HEIGHT, "{k}: {} {}", bend(k), expected(k));
        }
        assert!(bend(9).abs() < 0.05 * HEIGHT, "{values}");
        assert!(values.amax() < HEIGHT, "{values}");
    }

    #[test]
    fn what_the_base_imitates_and_what_was_not_visited_is_not_told() {
        let (projection, hats) = projection();
        let products = projection.products(&hats);
        let told = told(&products, &smooth(&products, false, SAMPLES));
        assert!(!told[9] && !told[10]);
        // Of the nine visited, a constant and a slope are the base's.
        assert_eq!(told.iter().filter(|told| **told).count(), 7, "{told:?}");
    }
}
