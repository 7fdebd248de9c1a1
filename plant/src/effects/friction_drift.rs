//! Friction drift: grease and bearings warm up and friction settles at another level,
//! by (T_d + B_d |omega|) (1 - e^(-t / tau)), t the time of the run.

use drivescope_numerics::Real;

use super::grid::{each, is_slow, slow_times};
use super::law::{Effect, Info, OwnState, Parameter, Sum, Variable, View};

/// Coulomb and viscous friction that change with time.
pub struct FrictionDrift;

impl Effect<3, 0> for FrictionDrift {
    const INFO: Info = Info {
        dry: true,
        fails_over: &[Variable::Time, Variable::Temperature],
        excludes: &["friction_drift"],
        nulls: &[("T_d", 0.0), ("B_d", 0.0)],
        grid: |spans| each("tau", slow_times(spans)),
        possible: |values, spans| is_slow(values[2], spans),
        ..Info::new(
            "friction_drift",
            "torque = -(T_d * sign(omega) + B_d * omega) * (1 - exp(-t / tau))",
            "time, in the torque, with the sign of omega",
        )
    };
    const PARAMETERS: [Parameter; 3] = [
        Parameter {
            name: "T_d",
            unit: "N m",
            nominal: -0.002,
            range: (f64::NEG_INFINITY, f64::INFINITY),
            description: "change of Coulomb friction in the end (negative: it falls)",
        },
        Parameter {
            name: "B_d",
            unit: "N m s/rad",
            nominal: -1e-5,
            range: (f64::NEG_INFINITY, f64::INFINITY),
            description: "change of viscous friction in the end",
        },
        Parameter {
            name: "tau",
            unit: "s",
            nominal: 5.0,
            range: (f64::MIN_POSITIVE, f64::INFINITY),
            description: "time constant of the change",
        },
    ];
    const STATES: [OwnState; 0] = [];

    #[inline(always)]
    fn share<R: Real>([t_d, b_d, tau]: [R; 3], _: [R; 0], at: &View<R>, sum: &mut Sum<R>) {
        let settled = R::one() - (-(at.time / tau)).exp();
        let level = t_d * settled;
        sum.forward += level;
        sum.backward += level;
        sum.torque += b_d * settled * at.omega;
    }

    fn fastest([_, b_d, tau]: [f64; 3], _: f64, inertia: f64) -> f64 {
        (b_d.abs() / inertia).max(1.0 / tau)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::law::by_name::{AT, assert_same, parameters, shared};

    #[test]
    fn friction_starts_unchanged_and_settles() {
        let p = parameters::<FrictionDrift, 3, 0>([("tau", 5.0), ("B_d", -1e-5), ("T_d", -0.002)]);
        let at = |time: f64| shared::<FrictionDrift, 3, 0>(p, [], View { time, ..AT });
        assert_eq!((at(0.0).forward, at(0.0).torque), (0.0, 0.0));
        let share = 1.0 - (-1f64).exp();
        assert_same(at(5.0).forward, -0.002 * share);
        assert_eq!(at(5.0).backward, at(5.0).forward);
        assert_same(at(5.0).torque, -7e-5 * share);
        assert_same(at(500.0).forward, -0.002);
    }
}
