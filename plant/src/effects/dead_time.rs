//! Dead time: while both switches of a bridge's leg are off, the current itself chooses the
//! voltage, and the mean voltage is V_d sgn(i) less than commanded, V_d = dead time x switching
//! frequency x bus voltage.
//!
//! Near zero the current's own ripple and the switches' capacitances round the step over i_d:
//! V_d i / sqrt(i^2 + i_d^2). It acts where u is the commanded voltage, not the measured one.

use drivescope_numerics::Real;

use super::grid::{reaches_the_armature, rounded};
use super::law::{ActsOn, Effect, Info, OwnState, Parameter, Sum, Variable, View};

/// Voltage V_d sgn(i), rounded over i_d, that the bridge keeps back.
pub struct DeadTime;

impl Effect<2, 0> for DeadTime {
    const INFO: Info = Info {
        electrical: true,
        fails_over: &[Variable::Current],
        acts_on: &[ActsOn::Voltage],
        aliases: &["brush_drop"],
        nulls: &[("V_d", 0.0)],
        grid: |spans| rounded("i_d", spans),
        possible: |values, spans| reaches_the_armature(values[0], spans),
        ..Info::new(
            "dead_time",
            "voltage = -V_d * i / sqrt(i^2 + i_d^2)",
            "sign of i, where u is the commanded voltage",
        )
    };
    const PARAMETERS: [Parameter; 2] = [
        Parameter {
            name: "V_d",
            unit: "V",
            nominal: 0.3,
            range: (0.0, f64::INFINITY),
            description: "dead time x switching frequency x bus voltage",
        },
        Parameter {
            name: "i_d",
            unit: "A",
            nominal: 0.1,
            range: (f64::MIN_POSITIVE, f64::INFINITY),
            description: "current over which the step is rounded: half of its ripple",
        },
    ];
    const STATES: [OwnState; 0] = [];

    #[inline(always)]
    fn share<R: Real>([v_d, i_d]: [R; 2], _: [R; 0], at: &View<R>, sum: &mut Sum<R>) {
        // In shares of i_d: a square of the smallest positive i_d would be zero.
        let ratio = at.i / i_d;
        sum.voltage += v_d * ratio / (ratio * ratio + R::one()).sqrt();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::law::by_name::{AT, assert_same, parameters, shared};

    #[test]
    fn the_bridge_keeps_a_voltage_back_that_follows_the_sign_of_the_current() {
        let p = parameters::<DeadTime, 2, 0>([("i_d", 0.1), ("V_d", 0.3)]);
        let voltage = |i: f64| shared::<DeadTime, 2, 0>(p, [], View { i, ..AT }).voltage;
        assert_same(voltage(0.1), 0.3 / 2f64.sqrt());
        assert_eq!(voltage(-0.1), -voltage(0.1));
        assert!((voltage(5.0) / 0.3 - 1.0).abs() < 3e-4);
        assert_eq!(voltage(0.0), 0.0);
    }
}
