//! Winding heating: the copper loss warms the winding and its resistance rises.
//!
//! C_th dT/dt = R(T) i^2 + other heat - T / R_th,  R(T) = R (1 + alpha T),
//! T the temperature above the surroundings, K.

use drivescope_numerics::Real;

use super::grid::{Shape, Spans, slow_times};
use super::law::{ActsOn, Beside, Effect, Info, OwnState, Parameter, Sum, Variable, View};

/// Temperature of a winding that keeps all heat of a recording, K: it only scales alpha, which is
/// then near that of copper where the resistance rises by a third.
const WARM: f64 = 100.0;

/// Time constants from a part of the recording to several of its lengths.
fn grid(spans: &Spans) -> Vec<Shape> {
    let capacity = spans.resistance * spans.heat / WARM;
    let of = |time_s: f64| vec![("C_th", capacity), ("R_th", time_s / capacity)];
    slow_times(spans).map(of).to_vec()
}

/// Resistance that follows the winding's temperature, one own state.
pub struct WindingHeating;

impl Effect<3, 1> for WindingHeating {
    const INFO: Info = Info {
        electrical: true,
        fails_over: &[Variable::Temperature, Variable::Time, Variable::Current],
        acts_on: &[ActsOn::Voltage],
        excludes: &["winding_heating"],
        nulls: &[("alpha", 0.0)],
        grid,
        ..Info::new(
            "winding_heating",
            "R times 1 + alpha T; C_th dT/dt = R i^2 - T / R_th",
            "time, temperature",
        )
    };
    const PARAMETERS: [Parameter; 3] = [
        Parameter {
            name: "alpha",
            unit: "1/K",
            nominal: 0.0039,
            range: (0.0, 0.1),
            description: "temperature coefficient of the resistance (copper: 0.0039)",
        },
        Parameter {
            name: "R_th",
            unit: "K/W",
            nominal: 5.0,
            range: (f64::MIN_POSITIVE, f64::INFINITY),
            description: "thermal resistance to the surroundings",
        },
        Parameter {
            name: "C_th",
            unit: "J/K",
            nominal: 10.0,
            range: (f64::MIN_POSITIVE, f64::INFINITY),
            description: "thermal capacity of the winding",
        },
    ];
    const STATES: [OwnState; 1] = [OwnState {
        name: "T",
        unit: "K",
        nominal: 10.0,
        description: "temperature of the winding above the surroundings",
        beside: Some(Beside::Temperature),
    }];

    #[inline(always)]
    fn share<R: Real>([alpha, ..]: [R; 3], [t]: [R; 1], _: &View<R>, sum: &mut Sum<R>) {
        sum.resistance += alpha * t;
    }

    #[inline(always)]
    fn rate<R: Real>([_, r_th, c_th]: [R; 3], [t]: [R; 1], at: &View<R>, sum: &Sum<R>) -> [R; 1] {
        [(at.copper * sum.resistance + sum.heat - t / r_th) / c_th]
    }

    fn fastest([_, r_th, c_th]: [f64; 3], _: f64, _: f64) -> f64 {
        1.0 / (r_th * c_th)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::law::by_name::{AT, assert_same, parameters, shared};

    #[test]
    fn the_winding_settles_at_r_th_times_its_loss() {
        let p =
            parameters::<WindingHeating, 3, 1>([("C_th", 10.0), ("R_th", 5.0), ("alpha", 0.0039)]);
        let cold = shared::<WindingHeating, 3, 1>(p, [0.0], AT);
        let [rate] = WindingHeating::rate(p, [0.0], &AT, &cold);
        assert_same(rate, AT.copper / 10.0);
        let warm = shared::<WindingHeating, 3, 1>(p, [40.0], AT);
        assert_same(warm.resistance, 1.0 + 0.0039 * 40.0);
        let settled = 5.0 * AT.copper * 1.156;
        let [rate] = WindingHeating::rate(p, [settled], &AT, &warm);
        assert!(rate.abs() < 1e-14, "{rate}");
    }
}
