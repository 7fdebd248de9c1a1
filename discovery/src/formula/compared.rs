//! Formulas compared with each other where the recordings went, beside what the base makes good.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::grammar::Form;
use super::proposals::Kind;
use super::weighed::{Valued, Visited};
use crate::sign::sign;

/// Places along the recordings at which they are compared.
const PLACES: usize = 1000;
/// Share of its amplitude by which a formula differs from another from which on it is another one
/// where the recordings went.
const APART: f64 = 0.03;
/// Share of its amplitude by which one that is near to a formula differs from it at most.
const NEAR: f64 = 0.5;

/// The places, and what the base does there.
pub(super) struct Compared<'a> {
    visited: &'a Visited,
    places: Vec<[f64; 3]>,
    /// Directions of unit length of what the base makes good, without dry friction and with it.
    smooth: DMatrix<f64>,
    base: DMatrix<f64>,
}

impl<'a> Compared<'a> {
    pub(super) fn of(visited: &'a Visited) -> Self {
        let places = visited.places(PLACES);
        let of = |[omega, i, _]: [f64; 3]| [1.0, omega, i, sign(omega)];
        let base = DMatrix::from_fn(places.len(), 4, |row, column| of(places[row])[column]);
        let smooth = base.columns(0, 3).into_owned().qr().q();
        Self { visited, base: base.qr().q(), smooth, places }
    }

    /// Columns of a formula, one a coefficient, beside those directions.
    fn columns(&self, form: &Form, beside: &DMatrix<f64>) -> DMatrix<f64> {
        let count = form.coefficients().len();
        let mut own = DMatrix::zeros(self.places.len(), count);
        for (row, place) in self.places.iter().enumerate() {
            let values = form.at(*place, &self.visited.names);
            (0..count).for_each(|column| own[(row, column)] = values[column]);
        }
        &own - beside * beside.tr_mul(&own)
    }

    /// The first so many that differ from each other.
    pub(super) fn different<'b>(
        &self,
        all: impl Iterator<Item = &'b Valued>,
        most: usize,
    ) -> Vec<Valued> {
        let mut kept: Vec<Valued> = Vec::new();
        let mut spaces: Vec<DMatrix<f64>> = Vec::new();
        for one in all {
            if kept.len() == most {
                break;
            }
            let space = self.columns(&one.form, &self.base).qr().q();
            let mut others = kept.iter().zip(&spaces);
            let like = |(other, its): (&Valued, &DMatrix<f64>)| {
                other.form.target == one.form.target && are_alike(its, &space)
            };
            if !others.any(like) {
                kept.push(one.clone());
                spaces.push(space);
            }
        }
        kept
    }

    /// So many of them that come nearest to a formula with its coefficients, of the same balance and
    /// variables, each in the shape that does: nearest first. Dry friction is not taken to make a
    /// difference good: where it is another one the drive sticks elsewhere.
    pub(super) fn nearest(
        &self,
        it: &Valued,
        others: &[&Valued],
        kinds: &[Kind],
        most: usize,
    ) -> Vec<Valued> {
        let curve =
            self.columns(&it.form, &self.smooth) * DVector::from_column_slice(&it.coefficients);
        let others = others.par_iter().filter(|other| other.form.family() == it.form.family());
        let in_nearest_shape = |other: &&Valued| {
            let shapes = kinds[other.kind].iter().filter_map(|form| {
                let columns = self.columns(form, &self.smooth);
                let squares = columns.tr_mul(&columns).cholesky()?;
                let coefficients = squares.solve(&columns.tr_mul(&curve));
                let left = (&curve - columns * &coefficients).norm_squared();
                Some((left, form, coefficients))
            });
            let (left, form, coefficients) = shapes.min_by(|a, b| a.0.total_cmp(&b.0))?;
            let coefficients = coefficients.as_slice().to_vec();
            Some((left, Valued { form: *form, coefficients, ..**other }))
        };
        let mut near: Vec<(f64, Valued)> = others.filter_map(in_nearest_shape).collect();
        near.retain(|it| it.0 < NEAR * NEAR * curve.norm_squared());
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        near.into_iter().take(most).map(|(_, it)| it).collect()
    }
}

/// Whether every function of one space is nearly one of the other.
fn are_alike(one: &DMatrix<f64>, other: &DMatrix<f64>) -> bool {
    if one.ncols() != other.ncols() {
        return false;
    }
    let shared = one.tr_mul(other);
    // The least cosine of the angles between them.
    let least = shared.singular_values().iter().fold(1.0_f64, |least, it| least.min(*it));
    (1.0 - least * least).max(0.0).sqrt() <= APART
}
