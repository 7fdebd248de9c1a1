//! The evidence of a set of columns: how probable the data are once their coefficients, drawn from
//! normal priors, are integrated out (MacKay, Information Theory, 2003, ch. 28).
//!
//! ln Z = b' H^-1 b / 2 - ln |H| / 2 - sum ln v / 2,  H = G + diag(1 / v), over that of no column.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::gram::Products;

/// Columns with the variances of their coefficients' priors.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Terms {
    pub(crate) columns: Vec<usize>,
    pub(crate) variances: Vec<f64>,
}

impl Terms {
    pub(crate) fn with(&self, columns: &[usize], variance: f64) -> Self {
        let mut with = self.clone();
        for column in columns {
            with.columns.push(*column);
            with.variances.push(variance);
        }
        with
    }
}

/// ln of the evidence alone; not a number where the columns overflow.
pub(crate) fn log_evidence(products: &Products, terms: &Terms) -> f64 {
    let (h, b) = system(products, terms);
    let Some(cholesky) = h.cholesky() else { return f64::NAN };
    let half = cholesky.l().solve_lower_triangular(&b).map_or(f64::NAN, |it| it.norm_squared());
    0.5 * half - ln_determinant(cholesky.l_dirty()) - 0.5 * ln_sum(&terms.variances)
}

/// The most probable coefficients; nothing where the columns overflow.
pub(crate) fn coefficients(products: &Products, terms: &Terms) -> Option<DVector<f64>> {
    let (h, b) = system(products, terms);
    Some(h.cholesky()?.solve(&b))
}

/// What the most probable coefficients explain, in ln of the probability; nothing where the columns
/// overflow.
pub(crate) fn explained(products: &Products, terms: &Terms) -> Option<f64> {
    let (h, b) = system(products, terms);
    Some(0.5 * h.cholesky()?.solve(&b).dot(&b))
}

/// The terms, decomposed once, beside which further columns are asked for.
pub(crate) struct Beside {
    columns: Vec<usize>,
    triangle: Cholesky<f64, Dyn>,
    data: DVector<f64>,
}

impl Beside {
    /// Nothing where the columns overflow.
    pub(crate) fn of(products: &Products, terms: &Terms) -> Option<Self> {
        let (h, data) = system(products, terms);
        Some(Self { columns: terms.columns.clone(), triangle: h.cholesky()?, data })
    }

    /// What the data tell of the coefficients of further columns, those of the terms integrated out:
    /// their information, and its product with their most probable values.
    pub(crate) fn information_and_score(
        &self,
        products: &Products,
        columns: &[usize],
    ) -> (DMatrix<f64>, DVector<f64>) {
        let (set, count) = (&self.columns, columns.len());
        let cross = DMatrix::from_fn(set.len(), count, |a, b| products.of(set[a], columns[b]));
        let own = DMatrix::from_fn(count, count, |a, b| products.of(columns[a], columns[b]));
        let data = DVector::from_fn(count, |k, _| products.of(columns[k], products.data()));
        let known = self.triangle.solve(&cross);
        (own - cross.tr_mul(&known), data - known.tr_mul(&self.data))
    }
}

/// Share of the amplitude of a column that those of the terms do not imitate.
pub(crate) fn standing_out(products: &Products, terms: &Terms, column: usize) -> f64 {
    let (h, _) = system(products, terms);
    let Some(h) = h.cholesky() else { return 1.0 };
    let set = &terms.columns;
    let cross = DVector::from_fn(set.len(), |place, _| products.of(set[place], column));
    let power = products.of(column, column);
    if power <= 0.0 {
        return 0.0;
    }
    ((power - cross.dot(&h.solve(&cross))) / power).max(0.0).sqrt()
}

fn system(products: &Products, terms: &Terms) -> (DMatrix<f64>, DVector<f64>) {
    let (set, data) = (&terms.columns, products.data());
    let mut h = DMatrix::from_fn(set.len(), set.len(), |a, b| products.of(set[a], set[b]));
    for (place, variance) in terms.variances.iter().enumerate() {
        h[(place, place)] += 1.0 / variance;
    }
    (h, DVector::from_fn(set.len(), |place, _| products.of(set[place], data)))
}

/// Half of ln of the determinant, from the triangle.
fn ln_determinant(triangle: &DMatrix<f64>) -> f64 {
    (0..triangle.nrows()).map(|k| triangle[(k, k)].ln()).sum()
}

fn ln_sum(values: &[f64]) -> f64 {
    values.iter().map(|value| value.ln()).sum()
}

/// ln of the mean of the exponentials.
pub(crate) fn ln_mean_exp(values: impl Iterator<Item = f64>) -> f64 {
    let values: Vec<f64> = values.filter(|value| !value.is_nan()).collect();
    let most = values.iter().fold(f64::NEG_INFINITY, |most, it| most.max(*it));
    if !most.is_finite() {
        return f64::NEG_INFINITY;
    }
    let sum: f64 = values.iter().map(|value| (value - most).exp()).sum();
    most + (sum / values.len() as f64).ln()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_of_exponentials_does_not_overflow() {
        let mean = ln_mean_exp([1000.0, 1000.0 + 3.0_f64.ln()].into_iter());
        assert!((mean - 1000.0 - 2.0_f64.ln()).abs() < 1e-12, "{mean}");
        assert_eq!(ln_mean_exp([f64::NAN].into_iter()), f64::NEG_INFINITY);
    }
}
