//! The list of effects, and the dispatch from a placed effect to its law.
//!
//! [`Placed`] is an effect in a drive: its kind and where its parameters and own states lie in
//! the flat arrays `p[k][lane]`, `x[k][lane]`. The match on the kind stands outside, the loop
//! over the lanes inside, so that each law is compiled as vector code.

use std::array::from_fn;

use drivescope_numerics::Real;

use super::custom;
use super::law::{
    Beside, Effect, Info, OutputLanes, Outputs, OwnState, Parameter, Sum, Sums, View, Views,
};

/// An effect in a drive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placed {
    /// Which law.
    pub kind: Kind,
    /// First of its parameters in the flat array.
    pub p: usize,
    /// First of its own states in the flat array.
    pub x: usize,
}

/// A registered effect, as the lists of the program see it.
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    /// The law.
    pub kind: Kind,
    /// What a person and the discovery need to know.
    pub info: &'static Info,
    pub parameters: &'static [Parameter],
    /// Its own states.
    pub states: &'static [OwnState],
}

macro_rules! registry {
    ($($effect:ident in $module:ident),+ $(,)?) => {
        /// Which law; `Custom` is one of the drive file, by its number in the drive.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum Kind {
            $($effect,)+
            /// A typed law or a learned curve: its number among the laws of the drive file.
            Custom(usize),
        }

        /// Every effect of the library, in the order in which it is shown.
        pub const REGISTRY: &[Entry] = &[$(Entry {
            kind: Kind::$effect,
            info: &<super::$module::$effect as Effect<_, _>>::INFO,
            parameters: &<super::$module::$effect as Effect<_, _>>::PARAMETERS,
            states: &<super::$module::$effect as Effect<_, _>>::STATES,
        }),+];

        impl Placed {
            /// Adds the effect's share to the balances, lane by lane.
            #[inline(always)]
            pub(crate) fn share<R: Real, const N: usize>(
                self, laws: &[custom::Law], p: &[[R; N]], x: &[[R; N]], at: &Views<'_, R, N>, sum: &mut Sums<R, N>,
            ) {
                match self.kind {
                    $(Kind::$effect => share_lanes(super::$module::$effect, &p[self.p..], &x[self.x..], at, sum),)+
                    Kind::Custom(k) => laws[k].share(&p[self.p..], at, sum),
                }
            }

            /// Derivatives of the effect's own states, lane by lane.
            #[inline(always)]
            pub(crate) fn rate<R: Real, const N: usize>(
                self, p: &[[R; N]], x: &[[R; N]], at: &Views<'_, R, N>, sum: &Sums<R, N>, dx: &mut [[R; N]],
            ) {
                match self.kind {
                    $(Kind::$effect => rate_lanes(super::$module::$effect, &p[self.p..], &x[self.x..], at, sum, &mut dx[self.x..]),)+
                    Kind::Custom(_) => {}
                }
            }

            /// Decay rates of the effect's own states, lane by lane.
            #[inline(always)]
            pub(crate) fn decay<R: Real, const N: usize>(
                self, p: &[[R; N]], x: &[[R; N]], at: &Views<'_, R, N>, sum: &Sums<R, N>, lambda: &mut [[R; N]],
            ) {
                match self.kind {
                    $(Kind::$effect => decay_lanes(super::$module::$effect, &p[self.p..], &x[self.x..], at, sum, &mut lambda[self.x..]),)+
                    Kind::Custom(_) => {}
                }
            }

            /// Distorts what the sensors show, lane by lane.
            #[inline(always)]
            pub(crate) fn sense<R: Real, const N: usize>(
                self, laws: &[custom::Law], p: &[[R; N]], x: &[[R; N]], at: &Views<'_, R, N>, y: &mut OutputLanes<R, N>,
            ) {
                match self.kind {
                    $(Kind::$effect => sense_lanes(super::$module::$effect, &p[self.p..], &x[self.x..], at, y),)+
                    Kind::Custom(k) => laws[k].sense(&p[self.p..], at, y),
                }
            }

            /// Speed beyond which the law is affine, for these parameters.
            pub(crate) fn affine_beyond(self, p: &[f64]) -> f64 {
                match self.kind {
                    $(Kind::$effect => affine_beyond(super::$module::$effect, &p[self.p..]),)+
                    Kind::Custom(_) => f64::INFINITY,
                }
            }

            /// Change of speed over which the law bends near rest.
            pub(crate) fn grain(self, p: &[f64]) -> f64 {
                match self.kind {
                    $(Kind::$effect => grain(super::$module::$effect, &p[self.p..]),)+
                    Kind::Custom(_) => f64::INFINITY,
                }
            }

            /// Fastest rate that the law brings in at that speed, 1/s.
            pub(crate) fn fastest(self, p: &[f64], speed: f64, inertia: f64) -> f64 {
                match self.kind {
                    $(Kind::$effect => fastest(super::$module::$effect, &p[self.p..], speed, inertia),)+
                    Kind::Custom(_) => 0.0,
                }
            }
        }
    };
}

registry! {
    Viscous in viscous,
    Coulomb in coulomb,
    Stribeck in stribeck,
    AsymmetricFriction in asymmetric_friction,
    LoadFriction in load_friction,
    FrictionDrift in friction_drift,
    IronLoss in iron_loss,
    QuadraticDrag in quadratic_drag,
    ConstantLoad in constant_load,
    Unbalance in unbalance,
    Cogging in cogging,
    TorqueRipple in torque_ripple,
    Saturation in saturation,
    ArmatureReaction in armature_reaction,
    BrushDrop in brush_drop,
    DeadTime in dead_time,
    SupplySag in supply_sag,
    WindingHeating in winding_heating,
    Presliding in presliding,
    FlexibleCoupling in flexible_coupling,
    Backlash in backlash,
    Delay in delay,
    SpeedSensorLag in speed_sensor_lag,
    TachoEccentricity in tacho_eccentricity,
    TachoGain in tacho_gain,
    CurrentOffset in current_offset,
    Quantisation in quantisation,
}

impl Entry {
    /// The effect of that identifier.
    pub fn find(id: &str) -> Option<&'static Self> {
        REGISTRY.iter().find(|entry| entry.info.id == id)
    }

    /// Whether it parts the load from the motor, so that the load moves by itself.
    pub fn has_load(&self) -> bool {
        self.states.iter().any(|state| state.beside == Some(Beside::LoadSpeed))
    }
}

/// The first `K` arrays of a flat array, one lane of each (a loop: the closure of
/// `array::from_fn` is not always inlined into the lanes).
#[inline(always)]
fn gather<R: Real, const K: usize, const N: usize>(flat: &[[R; N]], l: usize) -> [R; K] {
    let head: &[[R; N]; K] = flat.first_chunk().expect("placed within the flat array");
    let mut values = [R::zero(); K];
    for k in 0..K {
        values[k] = head[k][l];
    }
    values
}

/// Overwrites one lane of the first `K` arrays.
#[inline(always)]
fn scatter<R: Copy, const K: usize, const N: usize>(flat: &mut [[R; N]], l: usize, values: [R; K]) {
    let head: &mut [[R; N]; K] = flat.first_chunk_mut().expect("placed within the flat array");
    for k in 0..K {
        head[k][l] = values[k];
    }
}

#[inline(always)]
fn share_lanes<E: Effect<P, X>, R: Real, const P: usize, const X: usize, const N: usize>(
    _: E,
    p: &[[R; N]],
    x: &[[R; N]],
    at: &Views<'_, R, N>,
    sum: &mut Sums<R, N>,
) {
    for l in 0..N {
        let mut one: Sum<R> = sum.lane(l);
        E::share(gather(p, l), gather(x, l), &at.lane(l), &mut one);
        sum.set_lane(l, one);
    }
}

#[inline(always)]
fn rate_lanes<E: Effect<P, X>, R: Real, const P: usize, const X: usize, const N: usize>(
    _: E,
    p: &[[R; N]],
    x: &[[R; N]],
    at: &Views<'_, R, N>,
    sum: &Sums<R, N>,
    dx: &mut [[R; N]],
) {
    if X == 0 {
        return;
    }
    for l in 0..N {
        scatter(dx, l, E::rate(gather(p, l), gather(x, l), &at.lane(l), &sum.lane(l)));
    }
}

#[inline(always)]
fn decay_lanes<E: Effect<P, X>, R: Real, const P: usize, const X: usize, const N: usize>(
    _: E,
    p: &[[R; N]],
    x: &[[R; N]],
    at: &Views<'_, R, N>,
    sum: &Sums<R, N>,
    lambda: &mut [[R; N]],
) {
    if X == 0 {
        return;
    }
    for l in 0..N {
        scatter(lambda, l, E::decay(gather(p, l), gather(x, l), &at.lane(l), &sum.lane(l)));
    }
}

#[inline(always)]
fn sense_lanes<E: Effect<P, X>, R: Real, const P: usize, const X: usize, const N: usize>(
    _: E,
    p: &[[R; N]],
    x: &[[R; N]],
    at: &Views<'_, R, N>,
    y: &mut OutputLanes<R, N>,
) {
    if !const { E::INFO.senses() } {
        return;
    }
    for l in 0..N {
        let view: View<R> = at.lane(l);
        let mut one: Outputs<R> = y.lane(l);
        E::sense(gather(p, l), gather(x, l), &view, &mut one);
        y.set_lane(l, one);
    }
}

fn affine_beyond<E: Effect<P, X>, const P: usize, const X: usize>(_: E, p: &[f64]) -> f64 {
    E::affine_beyond(from_fn(|k| p[k]))
}

fn grain<E: Effect<P, X>, const P: usize, const X: usize>(_: E, p: &[f64]) -> f64 {
    E::grain(from_fn(|k| p[k]))
}

fn fastest<E: Effect<P, X>, const P: usize, const X: usize>(
    _: E,
    p: &[f64],
    speed: f64,
    inertia: f64,
) -> f64 {
    E::fastest(from_fn(|k| p[k]), speed, inertia)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identifiers_are_unique_and_nulls_name_parameters() {
        for (k, entry) in REGISTRY.iter().enumerate() {
            let id = entry.info.id;
            assert!(REGISTRY[..k].iter().all(|other| other.info.id != id), "{id} twice");
            for (name, _) in entry.info.nulls {
                assert!(entry.parameters.iter().any(|p| p.name == *name), "{id} has no {name}");
            }
            assert!(!entry.info.fails_over.is_empty(), "{id} shows somewhere");
            assert!(!entry.info.acts_on.is_empty(), "{id} stands somewhere");
            for other in entry.info.excludes {
                let other = Entry::find(other).unwrap_or_else(|| panic!("{id}: no {other}"));
                assert!(other.info.excludes.contains(&id), "{id} and {}", other.info.id);
            }
            for alias in entry.info.aliases {
                let of_motor = ["R", "L", "K_e", "K_m", "J", "B_m"].contains(alias);
                assert!(of_motor || Entry::find(alias).is_some(), "{id}: no {alias}");
            }
            for parameter in entry.parameters {
                let (low, high) = parameter.range;
                assert!(low <= parameter.nominal && parameter.nominal <= high, "{id}");
            }
        }
    }

    #[test]
    fn an_effect_is_found_by_its_identifier() {
        assert_eq!(Entry::find("cogging").map(|entry| entry.kind), Some(Kind::Cogging));
        assert!(Entry::find("no such thing").is_none());
    }
}
