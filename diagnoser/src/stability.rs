//! Stable polynomials and their reflection coefficients.
//!
//! A(z) = z^r + a_1 z^(r-1) + ... + a_r has all roots inside the unit circle exactly if all its
//! reflection coefficients k_1..k_r lie in (-1, 1) (Schur and Cohn; Jury's test). The Levinson
//! recursion maps one onto the other: a = k for r = 1, and for r = 2 a_2 = k_2,
//! a_1 = k_1 (1 + k_2), the stability triangle. Filters whose k = tanh(theta) are thus stable for
//! every theta, and a loaded filter is checked without finding roots.

/// Coefficients a_1..a_r of the polynomial with these reflection coefficients.
pub(crate) fn step_up(reflection: &[f64]) -> Vec<f64> {
    let mut a: Vec<f64> = Vec::with_capacity(reflection.len());
    for &k in reflection {
        let reversed: Vec<f64> = a.iter().rev().copied().collect();
        for (a, r) in a.iter_mut().zip(reversed) {
            *a += k * r;
        }
        a.push(k);
    }
    a
}

/// Derivatives da_i / dk_j as rows i of columns j, beside the coefficients themselves.
pub(crate) fn step_up_with_derivatives(reflection: &[f64]) -> (Vec<f64>, Vec<Vec<f64>>) {
    let r = reflection.len();
    // The recursion is affine in each k_j: two evaluations give the exact derivative.
    let at = |j: usize, value: f64| {
        let mut moved = reflection.to_vec();
        moved[j] = value;
        step_up(&moved)
    };
    let columns: Vec<Vec<f64>> = (0..r)
        .map(|j| at(j, 1.0).iter().zip(at(j, 0.0)).map(|(one, zero)| one - zero).collect())
        .collect();
    let rows = (0..r).map(|i| (0..r).map(|j| columns[j][i]).collect()).collect();
    (step_up(reflection), rows)
}

/// Reflection coefficients of a polynomial, or `None` if a root lies on or outside the unit
/// circle (or a coefficient is not finite).
pub(crate) fn step_down(coefficients: &[f64]) -> Option<Vec<f64>> {
    let mut a = coefficients.to_vec();
    let mut reflection = Vec::with_capacity(a.len());
    while let Some(k) = a.pop() {
        // Written so that NaN is refused.
        let inside = k.abs() < 1.0;
        if !inside {
            return None;
        }
        reflection.push(k);
        let reversed: Vec<f64> = a.iter().rev().copied().collect();
        for (a, r) in a.iter_mut().zip(reversed) {
            *a = (*a - k * r) / (1.0 - k * k);
        }
    }
    reflection.reverse();
    Some(reflection)
}

/// Magnitude of the largest root, by halving: A(z / s) is stable exactly while all roots are below s.
///
/// Of a stable polynomial: within 1e-9 of 1 otherwise.
pub(crate) fn largest_root(coefficients: &[f64]) -> f64 {
    const HALVINGS: usize = 40;
    let stable_within = |s: f64| {
        let powers = coefficients.iter().zip(1..).map(|(a, power)| a / s.powi(power));
        step_down(&powers.collect::<Vec<_>>()).is_some()
    };
    let (mut below, mut above) = (0.0, 1.0);
    if coefficients.iter().all(|a| *a == 0.0) {
        return 0.0;
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (below + above);
        if stable_within(middle) { above = middle } else { below = middle }
    }
    above
}

/// Samples in which a share of 1/e is left of what a root of that magnitude carries on.
pub(crate) fn time_constant(root: f64) -> f64 {
    if root > 0.0 { -1.0 / root.ln() } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A few roundings at order four.
    const ROUNDING: f64 = 1e-13;

    fn polynomial(roots: &[f64]) -> Vec<f64> {
        let mut a = vec![1.0];
        for root in roots {
            let shifted: Vec<f64> = a.iter().map(|c| -c * root).collect();
            a.push(0.0);
            for (a, s) in a[1..].iter_mut().zip(shifted) {
                *a += s;
            }
        }
        a.split_off(1)
    }

    #[test]
    fn second_order_is_the_stability_triangle() {
        assert_eq!(step_up(&[0.5, -0.3]), [0.5 * (1.0 - 0.3), -0.3]);
    }

    #[test]
    fn down_inverts_up() {
        let k = [0.9, -0.8, 0.5, -0.99];
        for (back, k) in step_down(&step_up(&k)).unwrap().iter().zip(k) {
            assert!((back - k).abs() < ROUNDING);
        }
    }

    #[test]
    fn a_root_outside_is_found() {
        assert!(step_down(&polynomial(&[0.99, -0.9, 0.5, 0.999])).is_some());
        assert!(step_down(&polynomial(&[0.99, -0.9, 0.5, 1.001])).is_none());
        assert!(step_down(&polynomial(&[1.0])).is_none());
        assert!(step_down(&[0.1, f64::NAN]).is_none());
    }

    #[test]
    fn derivatives_equal_differences() {
        let k = [0.4, -0.6, 0.3];
        let (a, derivatives) = step_up_with_derivatives(&k);
        assert_eq!(a, step_up(&k));
        let h = 1e-6;
        for j in 0..3 {
            let (mut up, mut down) = (k, k);
            up[j] += h;
            down[j] -= h;
            for (i, (u, d)) in step_up(&up).iter().zip(step_up(&down)).enumerate() {
                assert!(((u - d) / (2.0 * h) - derivatives[i][j]).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn the_largest_root_is_found() {
        // (z - 0.9)(z - 0.5), a pair of radius 0.8, and no root at all.
        assert!((largest_root(&[-1.4, 0.45]) - 0.9).abs() < 1e-6);
        assert!((largest_root(&[-0.8, 0.64]) - 0.8).abs() < 1e-6);
        assert_eq!(largest_root(&[0.0, 0.0]), 0.0);
        assert!((time_constant(largest_root(&[-0.998])) - 499.5).abs() < 0.1);
    }
}
