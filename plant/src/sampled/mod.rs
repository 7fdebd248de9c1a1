//! The sampled layer around the continuous drive: sensors, PI controller, amplifier, hold.
//!
//! At sample k (time t_k) the sensors are read, the controller computes C_m from the reference
//! and T, the amplifier turns it into u; then u, the load and the faults are held while the
//! drive moves on to t_{k+1}. [`Sampled`] does this for lanes of drives; one drive is a lane.
//! [`Sampled::run`] makes many samples at once, in vector code over the lanes.

mod amplifier;
mod controller;
mod delay;
mod run;
mod sensors;

use crate::drive::{AmplifierData, ControllerData, Drive, GeneratorData, Input, Motion};
use crate::effects::law::OutputLanes;
use crate::fault::{FaultLanes, Faults};
use crate::integrate::{State, Stepper};
use crate::lanes::lanes;
use crate::model::{Applied, Control, Controls, Model, Motors};

pub use amplifier::amplified;
use amplifier::amplify;
use controller::Pi;
pub use delay::DelayLine;
pub use run::{Samples, Span};
pub(crate) use sensors::FROZEN;
use sensors::Sensors;

lanes! {
    /// What enters the drive at a sample and is held until the next; SI units.
    Inputs / InputLanes {
        /// Reference speed, rad/s (m/s); closed loop.
        reference,
        /// Armature voltage or force signal; open loop.
        u,
        /// Load torque, N m (N).
        load,
        /// Generator control signal C_g, V.
        c_g,
        /// Noise on the reference, rad/s (m/s).
        noise_reference,
        /// Noise on the tachometer, in the unit of T.
        noise_t,
        /// Noise on the current sensor, A.
        noise_i_m,
    }
}

impl Inputs<f64> {
    /// Nothing acts.
    pub const NONE: Self = Self {
        reference: 0.0,
        u: 0.0,
        load: 0.0,
        c_g: 0.0,
        noise_reference: 0.0,
        noise_t: 0.0,
        noise_i_m: 0.0,
    };
}

lanes! {
    /// The signals of a sample, held until the next.
    Signals / SignalLanes {
        /// Control signal C_m, V (open loop: the u that was asked for).
        c_m,
        /// Tachometer signal T, in its unit.
        t,
        /// Measured armature current I_m, A.
        i_m,
        /// Armature voltage or force signal that acts.
        u,
        /// Generator current I_g, A.
        i_g,
        /// Load torque that acts, faults and generator included, N m (N).
        load,
    }
}

/// Share of the stall torque that counts as rated torque where the file does not say: small DC
/// motors are rated at a fifth to a third of it.
const RATED_SHARE_OF_STALL: f64 = 0.25;

/// Rated torque of the drive, N m (N): given, or a quarter of the torque at standstill under
/// full voltage; nothing if neither is known.
pub fn rated_torque(drive: &Drive) -> Option<f64> {
    drive.motor.rated_torque.or_else(|| {
        let limit = input_limit(drive)?;
        let full = match drive.motor.r {
            Some(r) => drive.motor.k_m * limit / r,
            None => drive.motor.k_m * limit,
        };
        Some(RATED_SHARE_OF_STALL * full)
    })
}

/// Speeds that a drive is stepped for where its limits do not say: 3000 rpm, or 1 m/s.
const USUAL_SPEEDS: (f64, f64) = (314.0, 1.0);

/// Greatest speed to expect, rad/s (m/s): no-load speed at the greatest u.
pub fn speed_bound(drive: &Drive) -> f64 {
    let usual = match drive.motion {
        Motion::Rotary => USUAL_SPEEDS.0,
        Motion::Linear => USUAL_SPEEDS.1,
    };
    let slope = match drive.motor.input {
        Input::Voltage => drive.motor.k_e.unwrap_or(0.0),
        Input::Force => drive.motor.b_m / drive.motor.k_m,
    };
    match input_limit(drive) {
        Some(limit) if slope > 0.0 => limit / slope,
        _ => usual,
    }
}

/// Greatest magnitude of u that controller and amplifier can give, if they limit it.
pub fn input_limit(drive: &Drive) -> Option<f64> {
    let gain = drive.amplifier.map_or(1.0, |amplifier| amplifier.gain);
    let control = drive.controller.and_then(|c| c.limit).map(|limit| limit * gain);
    let amplifier = drive.amplifier.and_then(|amplifier| amplifier.limit);
    match (control, amplifier) {
        (Some(a), Some(b)) => Some(a.min(b)),
        (a, b) => a.or(b),
    }
}

/// `N` drives with their sampled layer.
#[derive(Debug, Clone)]
pub struct Sampled<const N: usize, S> {
    stepper: S,
    healthy: Motors<f64, N>,
    controller: Option<ControllerData>,
    amplifier: Option<AmplifierData>,
    generator: Option<GeneratorData>,
    rated_torque: f64,
    sensors: Sensors<N>,
    pi: Pi<N>,
    state: State<f64, N>,
    signals: SignalLanes<f64, N>,
    /// Reference less what disturbs the tachometer: what a continuous controller follows.
    command: [f64; N],
    /// What holds u back, where the drive has a delay.
    delay: Option<DelayLine<f64, N>>,
    /// The continuous controllers that the stepper is set up with.
    controls: Option<Controls<f64, N>>,
    /// Sizes of the faults in the motors for which the stepper is set up.
    in_motors: [[f64; 5]; N],
}

impl<const N: usize, S: Stepper<N>> Sampled<N, S> {
    /// The drives of that stepper, at rest; `controlled` closes the loop of the drive's
    /// controller, else u is an input.
    pub fn new(drive: &Drive, stepper: S, controlled: bool) -> Self {
        let state = State::at_rest(stepper.model());
        let healthy = stepper.model().motors;
        let zero = Signals { c_m: 0.0, t: 0.0, i_m: 0.0, u: 0.0, i_g: 0.0, load: 0.0 };
        let mut made = Self {
            healthy,
            controller: drive.controller.filter(|_| controlled),
            amplifier: drive.amplifier,
            generator: drive.generator,
            rated_torque: rated_torque(drive).unwrap_or(0.0),
            sensors: Sensors::new(drive.sensors),
            pi: Pi::at_rest(),
            state,
            signals: SignalLanes::splat(zero),
            command: [0.0; N],
            delay: stepper.model().delays().map(DelayLine::new),
            controls: None,
            in_motors: [[0.0; 5]; N],
            stepper,
        };
        if made.is_continuous() {
            // The controller brings its integrator into the state.
            made.close_loop(&InputLanes::splat(Inputs::NONE), &FaultLanes::splat(Faults::NONE));
        }
        made
    }

    /// What advances the continuous drives.
    pub fn stepper(&self) -> &S {
        &self.stepper
    }

    /// State of the continuous drives.
    pub fn state(&self) -> &State<f64, N> {
        &self.state
    }

    /// State of the continuous drives, to set a start or to follow another integrator.
    pub fn state_mut(&mut self) -> &mut State<f64, N> {
        &mut self.state
    }

    /// The continuous drives with the faults that act.
    pub fn model(&self) -> &Model<f64, N> {
        self.stepper.model()
    }

    /// Signals of the last sample.
    pub fn signals(&self) -> &SignalLanes<f64, N> {
        &self.signals
    }

    /// What acts on the continuous drives since the last sample.
    #[inline(always)]
    pub fn applied(&self, time: f64) -> Applied<f64, N> {
        let set = self.set_now(time);
        let held_back = self.delay.as_ref().and_then(|line| line.acting(time));
        Applied { u: held_back.unwrap_or(set.u), ..set }
    }

    /// The same without the delay of u.
    fn set_now(&self, time: f64) -> Applied<f64, N> {
        let u = if self.is_continuous() { self.command } else { self.signals.u };
        Applied { u, load: self.signals.load, time }
    }

    /// What the controllers remember, V.
    pub fn integrals(&self) -> [f64; N] {
        self.pi.integral
    }

    /// Puts back what the controllers remember and the held signals.
    pub fn restore(&mut self, integrals: [f64; N], signals: SignalLanes<f64, N>) {
        self.pi.integral = integrals;
        self.signals = signals;
    }

    /// What ideal sensors show at that time.
    #[inline(always)]
    pub fn outputs(&self, time: f64) -> OutputLanes<f64, N> {
        self.stepper.model().outputs(&self.state.x, &self.applied(time))
    }

    /// The same drives with other parameters: the state and the held signals stay.
    #[must_use]
    pub fn with_parameters(&self, drive: &Drive, stepper: S) -> Self {
        let mut changed = Self::new(drive, stepper, self.controller.is_some());
        changed.state.clone_from(&self.state);
        changed.pi = self.pi;
        changed.signals = self.signals;
        if let (Some(line), Some(before)) = (&mut changed.delay, &self.delay) {
            line.restore(before.history());
        }
        changed
    }

    /// Sample k at time t_k: reads the sensors, runs the controller, and applies its output.
    #[inline]
    pub fn sample(&mut self, time: f64, inputs: &InputLanes<f64, N>, faults: &FaultLanes<f64, N>) {
        self.sample_inlined(time, inputs, faults, true);
    }

    /// The same as part of compiled work; the motors are looked at where faults may have changed.
    #[inline(always)]
    fn sample_inlined(
        &mut self,
        time: f64,
        inputs: &InputLanes<f64, N>,
        faults: &FaultLanes<f64, N>,
        may_have_changed: bool,
    ) {
        let shown = self.outputs(time);
        self.sensors.read(&shown, inputs, faults, &mut self.signals);
        if self.is_continuous() {
            self.signals = self.with_continuous(time, self.signals);
        }
        if let Some(data) = self.controller.as_ref().filter(|data| data.period.is_some()) {
            self.pi.sample(data, &self.sensors, inputs, &mut self.signals);
        }
        if may_have_changed {
            self.put_faults_into_motors(faults);
        }
        self.apply_held(inputs, faults);
    }

    /// The signals with T and I_m read at that time.
    #[inline(always)]
    pub fn measured(
        &self,
        time: f64,
        inputs: &InputLanes<f64, N>,
        faults: &FaultLanes<f64, N>,
    ) -> SignalLanes<f64, N> {
        let mut signals = self.signals;
        self.sensors.read(&self.outputs(time), inputs, faults, &mut signals);
        if self.is_continuous() {
            signals = self.with_continuous(time, signals);
        }
        signals
    }

    /// Applies inputs and faults to the continuous drives: they act at once, also between
    /// samples, on the control signal of the last sample.
    #[inline]
    pub fn apply(&mut self, inputs: &InputLanes<f64, N>, faults: &FaultLanes<f64, N>) {
        self.put_faults_into_motors(faults);
        self.apply_held(inputs, faults);
    }

    /// The same with the faults already in the motors.
    #[inline(always)]
    fn apply_held(&mut self, inputs: &InputLanes<f64, N>, faults: &FaultLanes<f64, N>) {
        if self.controller.is_none() {
            self.signals.c_m = inputs.u;
        }
        if self.is_continuous() {
            self.close_loop(inputs, faults);
        } else {
            let amplifier = if self.controller.is_some() { self.amplifier } else { None };
            amplify(amplifier, faults, &mut self.signals);
        }
        let generator =
            self.generator.unwrap_or(GeneratorData { k_m: 0.0, gain: 0.0, limit: None });
        for l in 0..N {
            let i_g = limited(generator.gain * inputs.c_g[l], generator.limit);
            self.signals.i_g[l] = i_g;
            self.signals.load[l] =
                inputs.load[l] + self.rated_torque * faults.load[l] + generator.k_m * i_g;
        }
    }

    /// Moves the drives on by `h` under the held inputs.
    #[inline(always)]
    pub fn advance(&mut self, time: f64, h: f64) {
        let applied = self.set_now(time);
        match &mut self.delay {
            None => self.stepper.advance(&mut self.state, &applied, h),
            Some(line) => line.advance(&mut self.stepper, &mut self.state, &applied, h),
        }
    }

    /// Whether a continuous controller closes the loop: it is part of the drives then.
    #[inline(always)]
    fn is_continuous(&self) -> bool {
        self.controller.is_some_and(|data| data.period.is_none())
    }

    /// Sets command and gains of the continuous controllers.
    #[inline(never)]
    fn close_loop(&mut self, inputs: &InputLanes<f64, N>, faults: &FaultLanes<f64, N>) {
        let Some(data) = self.controller else { return };
        for l in 0..N {
            let noise = inputs.noise_t[l] * (1.0 + faults.tacho_noise[l]);
            let disturbed = self.sensors.speed(noise) + faults.tacho_bias[l];
            self.command[l] = inputs.reference[l] + inputs.noise_reference[l] - disturbed;
        }
        let control = |l: usize| {
            let supply = 1.0 + faults.supply[l];
            let limit = self.amplifier.and_then(|a| a.limit).unwrap_or(f64::INFINITY);
            Control {
                k_p: data.k_p,
                k_i: data.k_i,
                limit: data.limit.unwrap_or(f64::INFINITY),
                gain: self.amplifier.map_or(1.0, |a| a.gain) * supply * (1.0 + faults.actuator[l]),
                u_limit: limit * supply,
                tacho: 1.0 + faults.tacho[l],
            }
        };
        let mut controls = Controls::splat(control(0));
        (1..N).for_each(|l| controls.set_lane(l, control(l)));
        if self.controls != Some(controls) {
            self.controls = Some(controls);
            self.stepper.change(|model| model.set_control(controls));
            let states = self.stepper.model().states();
            self.state.x.resize(states, [0.0; N]);
        }
    }

    /// The signals with C_m and u of the continuous controllers at that time.
    #[inline(never)]
    fn with_continuous(&self, time: f64, mut signals: SignalLanes<f64, N>) -> SignalLanes<f64, N> {
        let applied = self.applied(time);
        for l in 0..N {
            if let Some(now) = self.stepper.model().controlled(&self.state.x, &applied, l) {
                signals.c_m[l] = now.c_m;
                signals.u[l] = now.u;
            }
        }
        signals
    }

    fn put_faults_into_motors(&mut self, faults: &FaultLanes<f64, N>) {
        let now: [[f64; 5]; N] = std::array::from_fn(|l| faults.lane(l).of_motor());
        if now == self.in_motors {
            return;
        }
        let changed = std::array::from_fn(|l| now[l] != self.in_motors[l]);
        self.in_motors = now;
        let healthy = self.healthy;
        self.stepper.change_lanes(&changed, |model| {
            for l in (0..N).filter(|l| changed[*l]) {
                model.motors.set_lane(l, faults.lane(l).in_motor(&healthy.lane(l)));
            }
        });
    }
}

/// The value within plus or minus the limit, if there is one.
#[inline(always)]
fn limited(value: f64, limit: Option<f64>) -> f64 {
    let limit = limit.unwrap_or(f64::INFINITY);
    let capped = if value > limit { limit } else { value };
    if capped < -limit { -limit } else { capped }
}
