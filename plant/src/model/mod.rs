//! The continuous drive: motor, placed effects, and the one right-hand side of (20)-(23).

mod along;
mod beside;
mod build;
mod control;
mod field;
mod motor;
mod rows;

use std::sync::Arc;

use drivescope_numerics::Real;

use crate::effects::custom::Law;
use crate::effects::law::{Beside, Info, OutputLanes, Variable};
use crate::effects::registry::{Kind, Placed, REGISTRY};

pub use along::{Along, acting};
pub use control::{Control, Controlled, Controls};
pub(crate) use field::field_at;
pub use field::{AtRest, at_rest, field};
pub(crate) use motor::Inverses;
pub use motor::{Motor, Motors};
pub use rows::Rows;
use rows::rows;
pub(crate) use rows::zeros;

/// Index of the armature current in the state.
pub const CURRENT: usize = 0;
/// Index of the speed in the state.
pub const SPEED: usize = 1;
/// Index of the position in the state.
pub const POSITION: usize = 2;
/// Index of the first own state of the effects.
pub const OWN: usize = 3;

/// What acts on the drive from outside at an instant.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(64))]
pub struct Applied<R, const N: usize> {
    /// Armature voltage, V, or the commanded force signal; with continuous control the command:
    /// the reference less what disturbs the tachometer, rad/s (m/s).
    pub u: [R; N],
    /// Load torque, N m, or force, N.
    pub load: [R; N],
    /// Time, s.
    pub time: f64,
}

/// `N` drives of one structure, each with its own parameters.
#[derive(Debug, Clone)]
pub struct Model<R, const N: usize> {
    /// Motor parameters.
    pub motors: Motors<R, N>,
    /// Whether u commands the force directly (no electrical state).
    pub force: bool,
    placed: Vec<Placed>,
    laws: Arc<[Law]>,
    p: Rows<R, N>,
    own_states: usize,
    stiff: Vec<bool>,
    dry: bool,
    control: Option<Controls<R, N>>,
    kinked: bool,
    restless: bool,
    /// Whether a law changes with time while nothing moves.
    timed: bool,
    /// Whether no law may have kinks while the motion goes one way.
    smooth: bool,
    /// Whether an effect distorts what a sensor shows.
    distorting: bool,
    /// The state that each of [`Beside::ALL`] tells of.
    beside: [Option<usize>; Beside::ALL.len()],
}

/// An effect to place: its law and the values of its parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Part<R> {
    /// Which law; custom laws by their number in the list of laws.
    pub kind: Kind,
    /// One value a parameter.
    pub parameters: Vec<R>,
}

fn info(kind: Kind) -> Option<&'static Info> {
    REGISTRY.iter().find(|entry| entry.kind == kind).map(|entry| entry.info)
}

fn own_states(kind: Kind) -> usize {
    REGISTRY.iter().find(|entry| entry.kind == kind).map_or(0, |entry| entry.states.len())
}

impl<R: Real> Model<R, 1> {
    /// One drive.
    pub fn new(motor: Motor<R>, force: bool, parts: &[Part<R>], laws: Arc<[Law]>) -> Self {
        let mut placed = Vec::new();
        let mut p = Vec::new();
        let mut stiff = vec![false; OWN];
        for part in parts {
            placed.push(Placed { kind: part.kind, p: p.len(), x: stiff.len() - OWN });
            p.extend(part.parameters.iter().map(|value| [*value]));
            let is_stiff = info(part.kind).is_some_and(|i| i.stiff);
            stiff.extend(vec![is_stiff; own_states(part.kind)]);
        }
        let any = |of: fn(&Info) -> bool| parts.iter().filter_map(|q| info(q.kind)).any(of);
        let kinked = any(|i| i.replaces_dry);
        let dry = (any(|i| i.dry) || laws.iter().any(Law::is_dry)) && !kinked;
        let restless = |kind| match kind {
            Kind::Custom(k) => !laws[k].is_steady_at_rest(),
            other => own_states(other) > 0 || info(other).is_none_or(|i| !i.is_steady_at_rest()),
        };
        let restless = parts.iter().any(|part| restless(part.kind));
        let timed = |kind| match kind {
            Kind::Custom(k) => laws[k].reads_time(),
            other => info(other).is_some_and(|i| i.fails_over.contains(&Variable::Time)),
        };
        let timed = parts.iter().any(|part| timed(part.kind));
        let smooth = |kind| info(kind).is_some_and(|i| !i.kinked);
        let smooth = parts.iter().all(|part| smooth(part.kind));
        let senses = |kind| match kind {
            Kind::Custom(k) => laws[k].senses(),
            other => info(other).is_some_and(Info::senses),
        };
        let distorting = parts.iter().any(|part| senses(part.kind));
        Self {
            motors: Motors::splat(motor),
            force,
            placed,
            laws,
            p: rows(p),
            own_states: stiff.len() - OWN,
            stiff,
            dry,
            control: None,
            kinked,
            restless,
            timed,
            smooth,
            distorting,
            beside: beside::states(parts),
        }
    }
}

impl<R: Real> Model<R, 1> {
    /// The same motor without any effect.
    pub(crate) fn bare(&self) -> Self {
        Self::new(self.motors.lane(0), self.force, &[], Arc::from([]))
    }
}

impl<R: Real, const N: usize> Model<R, N> {
    /// The drives of several models of one structure, side by side.
    ///
    /// # Panics
    /// If the models differ in structure: they are made from one drive file.
    pub fn side_by_side(of: [&Model<R, 1>; N]) -> Self {
        let first = of[0];
        assert!(
            of.iter().all(|m| m.placed == first.placed && m.force == first.force),
            "lanes share one structure"
        );
        let mut motors = Motors::splat(first.motors.lane(0));
        for (l, model) in of.iter().enumerate() {
            motors.set_lane(l, model.motors.lane(0));
        }
        let p = (0..first.p.len()).map(|k| of.map(|m| m.p[k][0]));
        Self {
            motors,
            force: first.force,
            placed: first.placed.clone(),
            laws: first.laws.clone(),
            p: rows(p),
            own_states: first.own_states,
            stiff: first.stiff.clone(),
            dry: first.dry,
            control: first.control.map(|one| {
                let mut controls = Controls::splat(one.lane(0));
                for (l, model) in of.iter().enumerate() {
                    controls.set_lane(l, model.control.as_ref().unwrap_or(&one).lane(0));
                }
                controls
            }),
            kinked: first.kinked,
            restless: first.restless,
            timed: first.timed,
            smooth: first.smooth,
            distorting: first.distorting,
            beside: first.beside,
        }
    }

    /// One lane as a model of its own.
    pub fn lane(&self, l: usize) -> Model<R, 1> {
        Model {
            motors: Motors::splat(self.motors.lane(l)),
            force: self.force,
            placed: self.placed.clone(),
            laws: self.laws.clone(),
            p: rows(self.p.iter().map(|values| [values[l]])),
            own_states: self.own_states,
            stiff: self.stiff.clone(),
            dry: self.dry,
            control: self.control.map(|controls| Controls::splat(controls.lane(l))),
            kinked: self.kinked,
            restless: self.restless,
            timed: self.timed,
            smooth: self.smooth,
            distorting: self.distorting,
            beside: self.beside,
        }
    }

    /// States: current, speed, position, and the effects' own.
    pub fn states(&self) -> usize {
        OWN + self.own_states + usize::from(self.control.is_some())
    }

    /// Puts a continuous controller around the drive, or changes it.
    pub fn set_control(&mut self, control: Controls<R, N>) {
        if self.control.replace(control).is_none() {
            self.stiff.push(false);
        }
    }

    /// The continuous controllers around the drives, if there are any.
    pub(crate) fn control(&self) -> Option<&Controls<R, N>> {
        self.control.as_ref()
    }

    /// What acts on the motor: where a continuous controller closes the loop, its u in place of
    /// the command.
    #[inline(always)]
    fn under_control(&self, x: &[[R; N]], applied: &Applied<R, N>) -> Applied<R, N> {
        let u = |l: usize| self.controlled(x, applied, l).map_or(applied.u[l], |now| now.u);
        Applied { u: std::array::from_fn(u), ..*applied }
    }

    /// The signals of the continuous controller of lane `l`, if there is one.
    pub fn controlled(
        &self,
        x: &[[R; N]],
        applied: &Applied<R, N>,
        l: usize,
    ) -> Option<Controlled<R>> {
        let control = self.control.as_ref()?.lane(l);
        let truth = OutputLanes { i: x[CURRENT], omega: x[SPEED], theta: x[POSITION] };
        let speed = self.distorted(truth, x, applied).omega[l];
        Some(control.signals(applied.u[l], speed, x[OWN + self.own_states][l]))
    }

    /// Whether dry friction makes the shaft stick and slip.
    pub fn dry(&self) -> bool {
        self.dry
    }

    /// Whether the field changes with the sign of the motion, so that changes of it are located:
    /// dry friction, or a law that replaces it and is kinked at zero speed.
    pub fn directed(&self) -> bool {
        self.dry || self.kinked
    }

    /// Whether the torque on a shaft at rest may turn round while the inputs are held: in the
    /// base drive it follows the current, which goes one way.
    pub(crate) fn restless(&self) -> bool {
        self.restless
    }

    /// Whether the rates follow from current, speed, position and what acts: no law has a state of its
    /// own or follows time, and no continuous controller does.
    pub(crate) fn is_without_memory(&self) -> bool {
        self.own_states == 0 && self.control.is_none() && !self.timed
    }

    /// Whether the rates are smooth while the motion goes one way: no law is typed or learned, whose
    /// kinks nobody declares, and none has one like |i|.
    pub(crate) fn is_smooth(&self) -> bool {
        self.smooth
    }

    /// Whether a state is stiff and takes exponential stages of its own decay rate.
    pub(crate) fn is_stiff(&self, state: usize) -> bool {
        self.stiff[state]
    }

    /// The flat parameters of the effects, in the order of the parts.
    pub fn parameters_mut(&mut self) -> &mut [[R; N]] {
        &mut self.p
    }

    /// What ideal sensors show, measurement effects included.
    #[inline(always)]
    pub fn outputs(&self, x: &[[R; N]], applied: &Applied<R, N>) -> OutputLanes<R, N> {
        let i = if !self.force {
            x[CURRENT]
        } else if self.control.is_some() {
            self.under_control(x, applied).u
        } else {
            applied.u
        };
        self.distorted(OutputLanes { i, omega: x[SPEED], theta: x[POSITION] }, x, applied)
    }

    /// What the sensors show of these true values.
    #[inline(always)]
    fn distorted(
        &self,
        mut shown: OutputLanes<R, N>,
        x: &[[R; N]],
        applied: &Applied<R, N>,
    ) -> OutputLanes<R, N> {
        if self.distorting {
            let at = field::views(self, x, applied, applied.time, &[0.0; N]);
            for part in &self.placed {
                part.sense(&self.laws, &self.p, &x[OWN..], &at, &mut shown);
            }
        }
        shown
    }

    /// Whether ideal sensors show the states themselves.
    pub fn shows_state(&self) -> bool {
        !self.force && !self.distorting
    }

    /// The delays of u, s, if the drive has one; whoever steps it holds u back by them.
    pub fn delays(&self) -> Option<[R; N]> {
        let delay = self.placed.iter().find(|part| part.kind == Kind::Delay)?;
        Some(self.p[delay.p])
    }

    /// Speed beyond which lane `l` is affine in its state; infinite if nowhere.
    pub(crate) fn affine_beyond(&self, l: usize) -> f64 {
        if self.own_states > 0 || self.control.is_some() {
            return f64::INFINITY;
        }
        let p: Vec<f64> = self.p.iter().map(|values| values[l].value()).collect();
        self.placed.iter().map(|part| part.affine_beyond(&p)).fold(0.0, f64::max)
    }

    /// Change of speed over which a law of lane `l` bends near rest; infinite if none does.
    pub(crate) fn grain(&self, l: usize) -> f64 {
        let p: Vec<f64> = self.p.iter().map(|values| values[l].value()).collect();
        self.placed.iter().map(|part| part.grain(&p)).fold(f64::INFINITY, f64::min)
    }

    /// Fastest rate of a lane up to that speed without the armature's own decay, 1/s.
    pub(crate) fn fastest(&self, lane: usize, speed: f64) -> f64 {
        let motor = self.motors.lane(lane);
        let inertia = motor.j.value();
        let p: Vec<f64> = self.p.iter().map(|values| values[lane].value()).collect();
        let effects = self.placed.iter().map(|part| part.fastest(&p, speed, inertia));
        let control = self.control.as_ref().map_or(0.0, |controls| {
            let [k_m, l, r] = [motor.k_m, motor.l, motor.r].map(Real::value);
            controls.lane(lane).fastest(self.force, k_m / inertia, l, r)
        });
        effects.fold(motor.fastest(self.force).max(control), f64::max)
    }
}
