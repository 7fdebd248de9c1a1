//! What an effect is: a law that adds its share to the balances of the drive.

use drivescope_numerics::Real;

pub use super::info::{ActsOn, Beside, Info, OwnState, Parameter, Variable};
use crate::lanes::lanes;
use crate::model::Motors;

/// What an effect sees of the drive at an instant; SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View<R> {
    /// Armature current, A (the commanded signal `u` where the drive is force-driven).
    pub i: R,
    /// Speed of the motor shaft, rad/s or m/s.
    pub omega: R,
    /// Position of the motor shaft, rad or m.
    pub theta: R,
    /// Sign of the motion, 0 where the shaft sticks: it changes at located events only, so a
    /// law that is kinked at zero speed writes |omega| as direction omega.
    pub direction: R,
    /// Armature voltage or commanded force signal.
    pub u: R,
    /// Motor torque or force before effects: K_m i, or K_m u where force-driven, N m or N.
    pub drive: R,
    /// External load, N m or N.
    pub load: R,
    /// Copper loss at the cold resistance: R i^2, W.
    pub copper: R,
    /// Total inertia J, kg m^2 or kg.
    pub inertia: R,
    /// Time, s.
    pub time: R,
}

/// [`View`] of `N` lanes: references to what is there, for copies would cost as much as a law.
#[derive(Debug, Clone, Copy)]
pub struct Views<'a, R, const N: usize> {
    /// Parameters of the motors.
    pub motors: &'a Motors<R, N>,
    /// Currents (commanded signals).
    pub i: &'a [R; N],
    /// Speeds.
    pub omega: &'a [R; N],
    /// Positions.
    pub theta: &'a [R; N],
    /// Signs of the motion.
    pub direction: &'a [f64; N],
    /// Voltages (commanded signals).
    pub u: &'a [R; N],
    pub load: &'a [R; N],
    pub time: f64,
}

impl<R: Real, const N: usize> Views<'_, R, N> {
    /// One lane; what the law does not look at is not computed once this is inlined.
    #[inline(always)]
    pub fn lane(&self, l: usize) -> View<R> {
        let i = self.i[l];
        View {
            i,
            omega: self.omega[l],
            theta: self.theta[l],
            direction: R::constant(self.direction[l]),
            u: self.u[l],
            drive: self.motors.k_m[l] * i,
            load: self.load[l],
            copper: self.motors.r[l] * i * i,
            inertia: self.motors.j[l],
            time: R::constant(self.time),
        }
    }
}

lanes! {
    /// What the effects add up to; SI units. Made whole before own states are differentiated.
    Sum / Sums {
        /// Voltage lost in the armature circuit, V.
        voltage,
        /// Torque or force against positive motion, without dry friction, N m or N.
        torque,
        /// Dry-friction level in forward motion (break-away level at rest), N m or N.
        forward,
        /// Dry-friction level in backward motion (break-away level at rest), N m or N.
        backward,
        /// Flux relative to the nominal flux: it acts in both balances.
        flux,
        /// Resistance relative to R.
        resistance,
        /// Heat besides the copper loss, W.
        heat,
        /// Inverse of the inertia that the motor torque accelerates, 1/(kg m^2) or 1/kg.
        inverse_inertia,
        /// Load on the motor shaft, N m or N.
        load,
        /// Acceleration of the motor shaft, known once the balances are closed, rad/s^2 or m/s^2.
        acceleration,
    }
}

lanes! {
    /// What ideal sensors show: measurement effects included, noise and quantisation not.
    Outputs / OutputLanes {
        /// Current, A.
        i,
        /// Speed, rad/s or m/s.
        omega,
        /// Position, rad or m.
        theta,
    }
}

/// A physical effect with `P` parameters and `X` own states: one file, one registry line.
pub trait Effect<const P: usize, const X: usize> {
    /// What a person and the discovery need to know.
    const INFO: Info;
    /// The parameters, in the order of the array that the methods take.
    const PARAMETERS: [Parameter; P];
    /// The own states, in the order of the array that the methods take.
    const STATES: [OwnState; X];

    /// Adds the effect's share to the balances.
    #[inline(always)]
    fn share<R: Real>(_p: [R; P], _x: [R; X], _at: &View<R>, _sum: &mut Sum<R>) {}

    /// Time derivatives of the own states.
    #[inline(always)]
    fn rate<R: Real>(_p: [R; P], _x: [R; X], _at: &View<R>, _sum: &Sum<R>) -> [R; X] {
        [R::zero(); X]
    }

    /// Decay rates of stiff own states, 1/s, for the exponential stages.
    #[inline(always)]
    fn decay<R: Real>(_p: [R; P], _x: [R; X], _at: &View<R>, _sum: &Sum<R>) -> [R; X] {
        [R::zero(); X]
    }

    /// Distorts what the sensors show.
    #[inline(always)]
    fn sense<R: Real>(_p: [R; P], _x: [R; X], _at: &View<R>, _y: &mut Outputs<R>) {}

    /// Speed beyond which the law is affine in the state to the last bit.
    fn affine_beyond(_p: [f64; P]) -> f64 {
        f64::INFINITY
    }

    /// Change of speed over which the law bends near rest: it is not crossed in one stride.
    fn grain(_p: [f64; P]) -> f64 {
        f64::INFINITY
    }

    /// Fastest rate that the law brings in at that speed, 1/s: it sets the sub-steps.
    fn fastest(_p: [f64; P], _speed: f64, _inertia: f64) -> f64 {
        0.0
    }
}

/// What the tests of the laws share: values by name, so that the order of the names against the
/// pattern of the law is checked.
#[cfg(test)]
pub(crate) mod by_name {
    use super::{Effect, Sum, View};

    /// The law's array of parameters from values by name, every name once.
    pub(crate) fn parameters<E: Effect<P, X>, const P: usize, const X: usize>(
        values: [(&str, f64); P],
    ) -> [f64; P] {
        E::PARAMETERS.map(|parameter| {
            let named = values.iter().find(|(name, _)| *name == parameter.name);
            named.unwrap_or_else(|| panic!("no value for {}", parameter.name)).1
        })
    }

    /// A drive in motion: every quantity differs from every other.
    pub(crate) const AT: View<f64> = View {
        i: 1.3,
        omega: 7.0,
        theta: 0.4,
        direction: 1.0,
        u: 9.0,
        drive: 0.078,
        load: 0.011,
        copper: 5.3,
        inertia: 8.2e-5,
        time: 2.5,
    };

    /// What the law adds to empty balances.
    pub(crate) fn shared<E: Effect<P, X>, const P: usize, const X: usize>(
        p: [f64; P],
        x: [f64; X],
        at: View<f64>,
    ) -> Sum<f64> {
        let mut sum = Sum {
            voltage: 0.0,
            torque: 0.0,
            forward: 0.0,
            backward: 0.0,
            flux: 1.0,
            resistance: 1.0,
            heat: 0.0,
            inverse_inertia: 1.0 / at.inertia,
            load: at.load,
            acceleration: 0.0,
        };
        E::share(p, x, &at, &mut sum);
        sum
    }

    /// Two ways to write a law differ by rounding only.
    pub(crate) fn assert_same(found: f64, expected: f64) {
        assert!((found - expected).abs() <= 1e-14 * expected.abs(), "{found} is not {expected}");
    }
}
