//! Current offset: the current sensor shows i + i_0.

use drivescope_numerics::Real;

use super::law::{ActsOn, Effect, Info, Outputs, OwnState, Parameter, Variable, View};

/// Shown current i + i_0; the armature itself is untouched.
pub struct CurrentOffset;

impl Effect<1, 0> for CurrentOffset {
    const INFO: Info = Info {
        electrical: true,
        fails_over: &[Variable::Current, Variable::OmegaSign],
        acts_on: &[ActsOn::Sensor],
        distorts: Some(Variable::Current),
        aliases: &["constant_load"],
        nulls: &[("i_0", 0.0)],
        ..Info::new(
            "current_offset",
            "i = i + i_0",
            "a constant in i, at rest without u too; not in omega",
        )
    };
    const PARAMETERS: [Parameter; 1] = [Parameter {
        name: "i_0",
        unit: "A",
        nominal: 0.02,
        range: (f64::NEG_INFINITY, f64::INFINITY),
        description: "current that is shown where there is none",
    }];
    const STATES: [OwnState; 0] = [];

    #[inline(always)]
    fn sense<R: Real>([i_0]: [R; 1], _: [R; 0], _: &View<R>, y: &mut Outputs<R>) {
        y.i += i_0;
    }

    fn affine_beyond(_: [f64; 1]) -> f64 {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::law::by_name::{AT, assert_same, parameters};

    #[test]
    fn the_shown_current_alone_is_shifted() {
        let p = parameters::<CurrentOffset, 1, 0>([("i_0", -0.02)]);
        let mut y = Outputs { i: 1.3, omega: 7.0, theta: 0.4 };
        CurrentOffset::sense(p, [], &AT, &mut y);
        assert_eq!((y.omega, y.theta), (7.0, 0.4));
        assert_same(y.i, 1.28);
    }
}
