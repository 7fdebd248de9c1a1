//! A feasible parameter set: from equations, and the interval of r^T p over it by linear programs.

use serde::{Deserialize, Serialize};

use super::corners::Corners;
use super::equations::{Equation, Equations};
use super::frame::Frame;
use super::lp::maximum;
use super::polytope::{Cut, HalfSpace, Polytope, product};
use super::regressor::{BoundError, Regressor};

/// Half width of the first cube of an exact set, as a multiple of the proven reach.
const MARGIN: f64 = 1.5;
/// The same with errors in the regressors, or where xi^-1 is infinite, so that nothing is proven; a
/// set that comes so far is refused as unbounded.
const WIDE: f64 = 1e3;

/// The part of a set that lies in one orthant.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Part {
    /// Sign of every parameter whose regressor carries an error, 0 for the others.
    pub signs: Vec<i8>,
    /// Facets in the set's coordinates: normal and, last, offset.
    pub facets: Vec<Vec<f64>>,
}

/// The feasible parameters of one neuron: p = centre + T z, z within the facets of a part.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ParameterSet {
    /// The least-squares estimate.
    pub centre: Vec<f64>,
    /// T row by row.
    pub transform: Vec<Vec<f64>>,
    /// Half width of a cube that holds every part.
    pub cube: f64,
    /// One orthant each; a set without errors in its regressors has one part without signs.
    pub parts: Vec<Part>,
}

/// A set and the noise bounds epsilon^m, epsilon^M that it was made for.
pub(in crate::gmdh) struct Found {
    pub(in crate::gmdh) set: ParameterSet,
    pub(in crate::gmdh) noise: [f64; 2],
}

impl ParameterSet {
    /// The parameters that fulfil all equations, with noise bounds that are given or the smallest
    /// possible ones times an inflation; in the orthant of the least-squares estimate or in all.
    pub(in crate::gmdh) fn of(
        equations: &Equations,
        given: Option<[f64; 2]>,
        inflation: f64,
        all_orthants: bool,
    ) -> Result<Found, BoundError> {
        let frame = Frame::of(equations).ok_or(BoundError::Unbounded)?;
        let uncertain = equations.uncertain();
        let own = orthant(&frame, &uncertain, 0);
        let noise = match given {
            Some(noise) => noise,
            None => {
                let hard = sides(&frame, &own);
                let epsilon = inflation * equations.smallest_bound(&frame, &hard)?;
                [-epsilon, epsilon]
            }
        };
        let exact = uncertain.is_empty();
        let reach = equations.reach(&frame, noise);
        let cube = if exact && reach.is_finite() { MARGIN * reach } else { WIDE };
        let (mut parts, mut last) = (Vec::new(), None);
        let flips = if all_orthants { 1 << uncertain.len() } else { 1 };
        for flip in 0..flips {
            let signs = orthant(&frame, &uncertain, flip);
            match part(equations, &frame, noise, signs, cube) {
                Ok(part) => parts.push(part),
                Err(BoundError::Empty { recording, sample }) => {
                    last = last.max(Some((recording, sample)));
                }
                Err(other) => return Err(other),
            }
        }
        if let (true, Some((recording, sample))) = (parts.is_empty(), last) {
            return Err(BoundError::Empty { recording, sample });
        }
        let set = Self {
            centre: frame.centre.as_slice().to_vec(),
            transform: frame.transform.row_iter().map(|r| r.iter().copied().collect()).collect(),
            cube,
            parts,
        };
        Ok(Found { set, noise })
    }

    /// Smallest and largest r^T p over the set (12), with an uncertain regressor (16), by linear
    /// programs over the facets; `None` if a program fails.
    pub fn interval_by_programs(&self, regressor: Regressor) -> Option<(f64, f64)> {
        let mut interval = (f64::INFINITY, f64::NEG_INFINITY);
        for part in &self.parts {
            let half_spaces = part.half_spaces();
            let most = |r: Vec<f64>, sign: f64| {
                let along: Vec<f64> = (0..r.len())
                    .map(|j| {
                        sign * self.transform.iter().zip(&r).map(|(t, r)| t[j] * r).sum::<f64>()
                    })
                    .collect();
                let length = product(&along, &along).sqrt();
                let unit: Vec<f64> = along.iter().map(|x| x / length).collect();
                let z = if length > 0.0 { length * maximum(&half_spaces, &unit)? } else { 0.0 };
                Some(product(&r, &self.centre) + sign * z)
            };
            interval.0 = interval.0.min(most(regressor.extreme(&part.signs, false), -1.0)?);
            interval.1 = interval.1.max(most(regressor.extreme(&part.signs, true), 1.0)?);
        }
        Some(interval)
    }

    /// The vertices of the set, ready for one interval a sample.
    pub(in crate::gmdh) fn corners(&self) -> Result<Corners, BoundError> {
        let d = self.centre.len();
        let fits = self.transform.len() == d && self.transform.iter().all(|row| row.len() == d);
        if !fits || self.parts.is_empty() {
            return Err(BoundError::Damaged);
        }
        let mut corners = Corners::new(d);
        for part in &self.parts {
            if part.signs.len() != d || part.facets.iter().any(|facet| facet.len() != d + 1) {
                return Err(BoundError::Damaged);
            }
            let mut polytope = Polytope::cube(d, self.cube);
            for half_space in part.half_spaces() {
                if polytope.cut(half_space) == Cut::Empty {
                    return Err(BoundError::Damaged);
                }
            }
            if polytope.touches_first(2 * d) {
                return Err(BoundError::Damaged);
            }
            let parameters = |z: &[f64]| -> Vec<f64> {
                let row = |(c, t): (&f64, &Vec<f64>)| c + product(t, z);
                self.centre.iter().zip(&self.transform).map(row).collect()
            };
            corners.push(&part.signs, polytope.vertices().map(parameters), polytope.edges());
        }
        Ok(corners)
    }
}

impl Part {
    fn half_spaces(&self) -> Vec<HalfSpace> {
        let half_space = |facet: &Vec<f64>| {
            let (offset, normal) = facet.split_last()?;
            Some(HalfSpace { normal: normal.to_vec(), offset: *offset })
        };
        self.facets.iter().filter_map(half_space).collect()
    }
}

/// Signs of the least-squares estimate for uncertain parameters, some of them flipped.
fn orthant(frame: &Frame, uncertain: &[usize], flip: usize) -> Vec<i8> {
    let mut signs = vec![0; frame.centre.len()];
    for (bit, i) in uncertain.iter().enumerate() {
        let sign = if frame.centre[*i] < 0.0 { -1 } else { 1 };
        signs[*i] = if flip >> bit & 1 == 1 { -sign } else { sign };
    }
    signs
}

/// sign_i p_i >= 0 in the frame, normals of length one.
fn sides(frame: &Frame, signs: &[i8]) -> Vec<HalfSpace> {
    let side = |(i, sign): (usize, &i8)| {
        let mut normal = vec![0.0; signs.len()];
        normal[i] = -f64::from(*sign);
        (*sign != 0).then(|| unit(frame.half_space(&normal, 0.0)))
    };
    signs.iter().enumerate().filter_map(side).collect()
}

fn unit(HalfSpace { normal, offset }: HalfSpace) -> HalfSpace {
    let length = product(&normal, &normal).sqrt();
    HalfSpace { normal: normal.iter().map(|n| n / length).collect(), offset: offset / length }
}

/// The feasible set within one orthant, cut sample by sample.
fn part(
    equations: &Equations,
    frame: &Frame,
    noise: [f64; 2],
    signs: Vec<i8>,
    cube: f64,
) -> Result<Part, BoundError> {
    let d = equations.dimension;
    let mut polytope = Polytope::cube(d, cube);
    let empty_at = |(recording, sample)| BoundError::Empty { recording, sample };
    for side in sides(frame, &signs) {
        if polytope.cut(side) == Cut::Empty {
            return Err(BoundError::Empty { recording: 0, sample: 0 });
        }
    }
    for Equation { regressor, errors, y, multiple, place } in equations.iter() {
        let r = Regressor { values: regressor, errors };
        let ends = noise.map(|epsilon| y - multiple * epsilon);
        let [above, below] = ends.map(|y| equations.activation.inverse(y));
        if above.is_finite() {
            let least = r.extreme(&signs, false);
            if polytope.cut(unit(frame.half_space(&least, above))) == Cut::Empty {
                return Err(empty_at(place));
            }
        }
        if below.is_finite() {
            let most: Vec<f64> = r.extreme(&signs, true).iter().map(|r| -r).collect();
            if polytope.cut(unit(frame.half_space(&most, -below))) == Cut::Empty {
                return Err(empty_at(place));
            }
        }
    }
    if polytope.touches_first(2 * d) {
        return Err(BoundError::Unbounded);
    }
    let row = |HalfSpace { normal, offset }| [normal, vec![offset]].concat();
    Ok(Part { signs, facets: polytope.facets().into_iter().map(row).collect() })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::gmdh::Activation;
    use crate::testing::noise;

    /// The bar: programs and vertices agree.
    const BAR: f64 = 1e-9;
    const NOISE: f64 = 0.05;
    /// Share of NOISE that is drawn at most. At 1 the clamped draws lie exactly on the bounds, many
    /// facets meet in the truth, and nothing but that point is left.
    const DRAWN: f64 = 0.95;

    /// y = xi(r_n^T p) + epsilon with |epsilon| <= NOISE, seen through r = r_n + e, |e| <= `off` on
    /// the first two regressors.
    fn equations(
        truth: &[f64],
        activation: Activation,
        samples: usize,
        off: f64,
        seed: u64,
    ) -> Equations {
        let d = truth.len();
        let mut equations = Equations::new(d, activation);
        let mut draws =
            noise(samples * (d + 3), seed).into_iter().map(|e| e.clamp(-2.0, 2.0) / 2.0);
        for k in 0..samples {
            let mut r: Vec<f64> = draws.by_ref().take(d).collect();
            r[d - 1] = 1.0;
            let y = activation.value(product(&r, truth)) + DRAWN * NOISE * draws.next().unwrap();
            let mut errors = vec![[0.0; 2]; d];
            for (r, e) in r.iter_mut().zip(&mut errors).take(2) {
                *r += DRAWN * off * draws.next().unwrap();
                *e = [-off, off];
            }
            equations.push(&r, if off > 0.0 { &errors } else { &[] }, y, (0, k));
        }
        equations
    }

    fn truth(d: usize) -> Vec<f64> {
        (0..d).map(|i| 0.3 - 0.11 * i as f64).collect()
    }

    #[test]
    fn programs_equal_vertices_for_up_to_six_parameters() {
        for d in 2..=6 {
            for (activation, off) in
                [(Activation::Identity, 0.0), (Activation::Tanh, 0.0), (Activation::Identity, 0.02)]
            {
                let equations = equations(&truth(d), activation, 200, off, d as u64);
                let given = Some([-NOISE, NOISE]);
                let set = ParameterSet::of(&equations, given, 1.0, false).unwrap().set;
                let mut corners = set.corners().unwrap();
                for k in 0..10 {
                    let r = noise(d, 50 + k);
                    let errors = vec![[-off, 2.0 * off]; d];
                    let errors = if off > 0.0 { &errors[..2] } else { &[] };
                    let errors =
                        [errors, &vec![[0.0; 2]; if off > 0.0 { d - 2 } else { 0 }]].concat();
                    let regressor = Regressor { values: &r, errors: &errors };
                    let (low, high) = set.interval_by_programs(regressor).unwrap();
                    let walked = corners.interval(regressor);
                    assert!((low - walked.0).abs() < BAR && (high - walked.1).abs() < BAR);
                    assert!(low < high);
                }
            }
        }
    }

    #[test]
    fn all_orthants_hold_what_one_cannot() {
        // True parameters of both signs close to zero: the estimate's orthant may miss the truth.
        let truth = [0.01, -0.4, 0.2];
        let equations = equations(&truth, Activation::Identity, 60, 0.03, 3);
        let given = Some([-NOISE, NOISE]);
        let one = ParameterSet::of(&equations, given, 1.0, false).unwrap().set;
        let all = ParameterSet::of(&equations, given, 1.0, true).unwrap().set;
        assert!(one.parts.len() == 1 && all.parts.len() > 1, "{}", all.parts.len());
        let r = [1.0, 0.0, 0.0];
        let regressor = Regressor { values: &r, errors: &[] };
        let (one, all) = (
            one.interval_by_programs(regressor).unwrap(),
            all.interval_by_programs(regressor).unwrap(),
        );
        assert!(one.0 >= -BAR && all.0 < -1e-3, "{one:?} in {all:?}");
        assert!(all.1 >= one.1 - BAR);
    }

    #[test]
    fn the_smallest_noise_bound_is_found_for_both_activations() {
        for activation in [Activation::Identity, Activation::Tanh] {
            let equations = equations(&truth(3), activation, 300, 0.0, 7);
            let Found { noise, .. } =
                ParameterSet::of(&equations, None, 1.0 + 1e-6, false).unwrap();
            // No more than the noise that was put in, and close to it over 300 samples.
            assert!(noise[1] <= NOISE * (1.0 + 1e-5) && noise[1] > 0.8 * NOISE, "{noise:?}");
            let tighter = ParameterSet::of(&equations, None, 1.0 - 1e-3, false);
            assert!(matches!(tighter, Err(BoundError::Empty { .. })));
        }
    }

    #[test]
    fn an_empty_set_names_the_sample_and_a_blind_neuron_is_refused() {
        let truth = truth(3);
        let mut good = equations(&truth, Activation::Identity, 100, 0.0, 9);
        good.push(&[0.2, 0.1, 1.0], &[], product(&[0.2, 0.1, 1.0], &truth) + 5.0 * NOISE, (1, 17));
        let refusal = ParameterSet::of(&good, Some([-NOISE, NOISE]), 1.0, false).err().unwrap();
        assert_eq!(refusal, BoundError::Empty { recording: 1, sample: 17 });
        let mut blind = Equations::new(2, Activation::Identity);
        for (k, y) in noise(50, 1).into_iter().enumerate() {
            blind.push(&[1.0, 1.0], &[], y, (0, k));
        }
        let refusal = ParameterSet::of(&blind, None, 1.1, false).err();
        assert_eq!(refusal, Some(BoundError::Unbounded));
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 16, failure_persistence: None, ..ProptestConfig::default() })]

        /// Fresh data that respect the bounds never leave (19), with exact and with uncertain
        /// regressors, whatever the parameters.
        #[test]
        fn no_violation_on_data_that_respect_the_bounds(
            seed in 0_u64..1_000_000,
            truth in proptest::collection::vec(0.1..0.6_f64, 3..=4),
            off in prop_oneof![Just(0.0), 0.001..0.03_f64],
            tanh in any::<bool>(),
        ) {
            let activation = if tanh { Activation::Tanh } else { Activation::Identity };
            let design = equations(&truth, activation, 150, off, 2 * seed);
            let given = Some([-NOISE, NOISE]);
            let set = ParameterSet::of(&design, given, 1.0, true).unwrap().set;
            let mut corners = set.corners().unwrap();
            for Equation { regressor, errors, y, .. } in equations(&truth, activation, 200, off, 2 * seed + 1).iter() {
                let (low, high) = corners.interval(Regressor { values: regressor, errors });
                prop_assert!(activation.value(low) - NOISE <= y + BAR);
                prop_assert!(activation.value(high) + NOISE >= y - BAR);
            }
        }
    }
}
