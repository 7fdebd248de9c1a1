//! Brush drop: the voltage between brushes and commutator rises steeply with the current and
//! then stays about constant: V_b tanh(i / i_b), in the armature circuit alone.

use drivescope_numerics::Real;

use super::grid::{reaches_the_armature, rounded};
use super::law::{ActsOn, Effect, Info, OwnState, Parameter, Sum, Variable, View};

/// Voltage V_b tanh(i / i_b) lost at the brushes.
pub struct BrushDrop;

impl Effect<2, 0> for BrushDrop {
    const INFO: Info = Info {
        electrical: true,
        fails_over: &[Variable::Current],
        acts_on: &[ActsOn::Voltage],
        aliases: &["dead_time"],
        nulls: &[("V_b", 0.0)],
        grid: |spans| rounded("i_b", spans),
        possible: |values, spans| reaches_the_armature(values[0], spans),
        ..Info::new(
            "brush_drop",
            "voltage = -V_b * tanh(i / i_b)",
            "sign of i, rounded near zero; in the voltage, not in the torque",
        )
    };
    const PARAMETERS: [Parameter; 2] = [
        Parameter {
            name: "V_b",
            unit: "V",
            nominal: 0.5,
            range: (0.0, f64::INFINITY),
            description: "voltage drop of both brushes at great current",
        },
        Parameter {
            name: "i_b",
            unit: "A",
            nominal: 0.2,
            range: (f64::MIN_POSITIVE, f64::INFINITY),
            description: "current at which three quarters of it are there",
        },
    ];
    const STATES: [OwnState; 0] = [];

    #[inline(always)]
    fn share<R: Real>([v_b, i_b]: [R; 2], _: [R; 0], at: &View<R>, sum: &mut Sum<R>) {
        sum.voltage += v_b * (at.i / i_b).tanh();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::law::by_name::{AT, assert_same, parameters, shared};

    #[test]
    fn the_drop_is_odd_in_the_current_and_levels_off() {
        let p = parameters::<BrushDrop, 2, 0>([("i_b", 0.2), ("V_b", 0.5)]);
        let voltage = |i: f64| shared::<BrushDrop, 2, 0>(p, [], View { i, ..AT }).voltage;
        assert_same(voltage(0.2), 0.5 * 0.761_594_155_955_764_9);
        assert_eq!(voltage(-0.2), -voltage(0.2));
        assert_same(voltage(20.0), 0.5);
        assert_eq!(voltage(0.0), 0.0);
    }
}
