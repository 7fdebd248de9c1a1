//! What detection and delay depend on: first-order indices of Sobol, from the scenarios as they are.
//!
//! S_i = Var(E[y | x_i]) / Var(y), estimated by the correlation ratio over groups of equal x_i (values
//! of a grid, words) or of equal counts (what is drawn), corrected for chance:
//!
//! S_i = (SSB - (g - 1) MSW) / SST
//!
//! with g groups, SSB and MSW the sum of squares between them and the mean square within (T. L. Kelley,
//! Proc. Natl. Acad. Sci. 21 (1935), 554-559). For inputs that are chosen independently of each other,
//! as a plan does, the indices add up to at most one; what they leave is interaction and noise.

use serde::Serialize;

use super::gather::{Gathered, Input};

/// Groups of what is drawn; scenarios that each needs.
const GROUPS: usize = 16;
const EACH: usize = 8;

/// The index of one input.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sensitivity {
    /// The column.
    pub input: String,
    /// Share of the variance of "detected" (1 or 0) over faulty scenarios; none where all or no
    /// faults were detected.
    pub detected: Option<f64>,
    /// Share of the variance of the delay over those that were detected.
    pub delay: Option<f64>,
}

pub(super) fn sensitivity(gathered: &Gathered, method: usize) -> Vec<Sensitivity> {
    let rows = || gathered.kept.iter().map(|row| &row.methods[method]);
    let detected: Vec<f64> =
        rows().map(|it| it.detected.map_or(f64::NAN, |it| f64::from(u8::from(it)))).collect();
    let delay: Vec<f64> = rows().map(|it| it.delay_s).collect();
    let of = |input: &Input| Sensitivity {
        input: input.name.clone(),
        detected: index(input, &detected),
        delay: index(input, &delay),
    };
    let varies = |input: &&Input| {
        let mut values = input.values.iter().filter(|it| it.is_finite());
        values.next().is_some_and(|first| values.any(|it| it != first))
    };
    let mut found: Vec<Sensitivity> = gathered.inputs.iter().filter(varies).map(of).collect();
    let rank = |it: &Sensitivity| it.detected.or(it.delay).unwrap_or(0.0);
    found.sort_by(|a, b| rank(b).total_cmp(&rank(a)));
    found
}

/// The index of an input, where enough is known of both.
fn index(input: &Input, y: &[f64]) -> Option<f64> {
    let sizes = input.name.ends_with("_size");
    let mut pairs: Vec<(f64, f64)> = input
        .values
        .iter()
        .zip(y)
        .filter(|(x, y)| x.is_finite() && y.is_finite())
        // A fault of either sign is as large.
        .map(|(x, y)| (if sizes { x.abs() } else { *x }, *y))
        .collect();
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let same = |a: f64, b: f64| (b - a).abs() <= 1e-9 * a.abs();
    let distinct = pairs.windows(2).filter(|pair| !same(pair[0].0, pair[1].0)).count() + 1;
    let groups: Vec<&[(f64, f64)]> = if distinct <= GROUPS {
        pairs.chunk_by(|a, b| same(a.0, b.0)).collect()
    } else {
        pairs.chunks(pairs.len().div_ceil(GROUPS).max(EACH)).collect()
    };
    let n = pairs.len() as f64;
    let g = groups.len() as f64;
    if groups.len() < 2 || n < g + 2.0 {
        return None;
    }
    let mean = pairs.iter().map(|(_, y)| y).sum::<f64>() / n;
    let total: f64 = pairs.iter().map(|(_, y)| (y - mean).powi(2)).sum();
    let between: f64 = groups
        .iter()
        .map(|group| {
            let own = group.iter().map(|(_, y)| y).sum::<f64>() / group.len() as f64;
            group.len() as f64 * (own - mean).powi(2)
        })
        .sum();
    let within = (total - between) / (n - g);
    // What rounds to nothing varies by rounding.
    (total > 1e-12 * n * mean.powi(2).max(1e-300))
        .then(|| ((between - (g - 1.0) * within) / total).max(0.0))
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    use super::*;

    fn input(name: &str, values: Vec<f64>) -> Input {
        let (name, column) = (name.to_owned(), name.to_owned());
        Input { name, column, onset: None, values, words: Vec::new() }
    }

    /// Ishigami's function, whose indices are known: 0.3139, 0.4424, 0.
    #[test]
    fn the_indices_of_a_known_function_are_found() {
        let mut random = Pcg64Mcg::seed_from_u64(3);
        let pi = std::f64::consts::PI;
        let x: Vec<[f64; 3]> =
            (0..40_000).map(|_| std::array::from_fn(|_| random.random_range(-pi..pi))).collect();
        let of = |[a, b, c]: &[f64; 3]| a.sin() + 7.0 * b.sin().powi(2) + 0.1 * c.powi(4) * a.sin();
        let y: Vec<f64> = x.iter().map(of).collect();
        for (k, exact) in [0.3139, 0.4424, 0.0].into_iter().enumerate() {
            let values = x.iter().map(|x| x[k]).collect();
            let input = input(&format!("x_{k}"), values);
            let found = index(&input, &y).expect("it varies");
            // Groups of finite width miss some of it.
            assert!((found - exact).abs() < 0.02, "{k}: {found}");
        }
    }

    #[test]
    fn of_nothing_nothing_is_said() {
        assert_eq!(index(&input("x", vec![1.0; 50]), &[0.5; 50]), None);
        let varied = input("x", (0..50).map(f64::from).collect());
        assert_eq!(index(&varied, &[0.5; 50]), None);
        assert_eq!(index(&varied, &[f64::NAN; 50]), None);
    }
}
