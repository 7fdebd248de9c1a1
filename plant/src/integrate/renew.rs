//! New parameters in some lanes of a block: what its plan holds of the others stays.
//!
//! A plan is made lane by lane, and its matrix exponentials cost as much as a hundred samples; in a
//! block of scenarios every lane has an onset of its own, and a fault that grows changes at every
//! sample.

use drivescope_numerics::Real;

use super::affine::Affine;
use super::exponential::Exponential;
use super::grain::Grain;
use super::step::Armature;
use super::{Block, Pace, Plan};
use crate::model::Model;

impl<R: Real, const N: usize> Block<R, N> {
    /// Changes the parameters of those lanes and of no others.
    pub fn change_lanes(&mut self, lanes: &[bool; N], change: impl FnOnce(&mut Model<R, N>)) {
        // The sub-steps of a block that is paced by its drives follow from all of them.
        let Pace::Longest(_) = self.pace else { return self.change(change) };
        let states = self.model.states();
        change(&mut self.model);
        let Some(plan) = self.plan.as_mut().filter(|_| self.model.states() == states) else {
            return self.change(|_| {});
        };
        for l in (0..N).filter(|l| lanes[*l]) {
            let one = Plan::new(&self.model.lane(l), plan.h, plan.substeps);
            if !plan.set_lane(l, &one) {
                return self.change(|_| {});
            }
            self.alone[l] = None;
        }
    }
}

impl<R: Real, const N: usize> Plan<R, N> {
    /// Overwrites a lane; false where only one of the two can take the exact step.
    fn set_lane(&mut self, l: usize, one: &Plan<R, 1>) -> bool {
        self.armature.set_lane(l, &one.armature);
        self.grain.set_lane(l, &one.grain);
        let both = [(&mut self.forward, &one.forward), (&mut self.backward, &one.backward)];
        both.into_iter().all(|(all, one)| match (all, one) {
            (Some(all), Some(one)) => {
                all.set_lane(l, one);
                true
            }
            (None, None) => true,
            _ => false,
        })
    }
}

impl<R: Real, const N: usize> Armature<R, N> {
    fn set_lane(&mut self, l: usize, one: &Armature<R, 1>) {
        self.rate[l] = one.rate[0];
        self.coefficients.set_lane(l, &one.coefficients);
        self.inverses.j[l] = one.inverses.j[0];
        self.inverses.l[l] = one.inverses.l[0];
    }
}

impl<R: Real, const N: usize> Exponential<R, N> {
    fn set_lane(&mut self, l: usize, one: &Exponential<R, 1>) {
        let Exponential { half, whole, stage, first, middle, last } = one;
        let all = [
            (&mut self.half, half),
            (&mut self.whole, whole),
            (&mut self.stage, stage),
            (&mut self.first, first),
            (&mut self.middle, middle),
            (&mut self.last, last),
        ];
        all.into_iter().for_each(|(all, one)| all[l] = one[0]);
    }
}

impl<const N: usize> Grain<N> {
    fn set_lane(&mut self, l: usize, one: &Grain<1>) {
        self.0[l] = one.0[0];
    }
}

impl<R: Real, const N: usize> Affine<R, N> {
    fn set_lane(&mut self, l: usize, one: &Affine<R, 1>) {
        for (all, one) in self.matrix.iter_mut().flatten().zip(one.matrix.iter().flatten()) {
            all[l] = one[0];
        }
        let rows = [(&mut self.ahead, &one.ahead), (&mut self.quadrature, &one.quadrature)];
        for (all, one) in rows.into_iter().flat_map(|(all, one)| all.iter_mut().zip(one)) {
            all[l] = one[0];
        }
        // A lane that does not ring has no quadrature, whatever the others do.
        self.rings |= one.rings;
        self.beyond[l] = one.beyond[0];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrate::{State, longest_substep};
    use crate::model::{Applied, SPEED};
    use crate::testing::{DR300, drive};

    /// Lanes whose resistance, friction and inertia change one after the other, through rest.
    #[test]
    fn a_lane_that_changes_is_stepped_as_in_a_new_block() {
        let model = drive(DR300).model();
        let longest = 0.5 * longest_substep(&model, 400.0);
        let mut some = Block::<f64, 4>::paced(Model::side_by_side([&model; 4]), longest);
        let mut all = some.clone();
        let mut states = [State::at_rest(some.model()), State::at_rest(some.model())];
        for k in 0..400_usize {
            let l = (k / 7) % 4;
            let change = |model: &mut Model<f64, 4>| {
                model.motors.r[l] *= 1.001;
                model.motors.j[l] *= 0.998;
                model.motors.friction[l] *= 1.002;
            };
            if k % 7 == 0 {
                some.change_lanes(&std::array::from_fn(|lane| lane == l), change);
                all.change(change);
            }
            let u = if k % 100 < 50 { 12.0 } else { -6.0 };
            let u = std::array::from_fn(|lane| u + lane as f64);
            let applied = Applied { u, load: [0.0; 4], time: k as f64 * 0.005 };
            some.advance(&mut states[0], &applied, 0.005);
            all.advance(&mut states[1], &applied, 0.005);
            assert_eq!(states[0], states[1], "at {k}");
        }
        assert!(states[0].x[SPEED].iter().all(|speed| speed.abs() > 1.0), "it moved");
    }
}
