//! Tachometer eccentricity: the speed that is shown ripples once a revolution.

use drivescope_numerics::Real;

use super::law::{Effect, Info, Outputs, OwnState, Parameter, View};

/// Shown speed omega (1 + a cos theta + b sin theta); the shaft itself is untouched.
pub struct TachoEccentricity;

impl Effect<2, 0> for TachoEccentricity {
    const INFO: Info = Info {
        senses: true,
        nulls: &[("a", 0.0), ("b", 0.0)],
        ..Info::new(
            "tacho_eccentricity",
            "omega shown = omega (1 + a cos theta + b sin theta)",
            "theta, once a revolution, in proportion to omega, not in i",
        )
    };
    const PARAMETERS: [Parameter; 2] = [
        Parameter {
            name: "a",
            unit: "1",
            nominal: 0.005,
            range: (-1.0, 1.0),
            description: "cosine share",
        },
        Parameter {
            name: "b",
            unit: "1",
            nominal: 0.005,
            range: (-1.0, 1.0),
            description: "sine share",
        },
    ];
    const STATES: [OwnState; 0] = [];

    #[inline(always)]
    fn sense<R: Real>([a, b]: [R; 2], _: [R; 0], at: &View<R>, y: &mut Outputs<R>) {
        let (sin, cos) = at.theta.sin_cos();
        y.omega *= R::one() + a * cos + b * sin;
    }

    fn affine_beyond(_: [f64; 2]) -> f64 {
        0.0
    }
}
