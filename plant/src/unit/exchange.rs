//! The continuous-time interface: an importer integrates, the unit answers.
//!
//! Event indicators of a drive with dry friction (or a law that is kinked at zero speed): while the shaft slips, its speed in the
//! direction of motion; while it sticks, what is missing to break away forward and backward.
//! Each is shifted by a hair, so that it lies clear of zero just after an event.

use drivescope_numerics::{Dual, Real};

use super::{SAME_INSTANT, Unit};
use crate::effects::law::Outputs;
use crate::model::{Applied, Controls, Model, SPEED, at_rest, field};
use crate::sampled::FROZEN;
use crate::unit::variables::{InputSlot, OutputSlot, Slot};

/// Shift of the speed indicator, rad/s (m/s).
const SPEED_SHIFT: f64 = 1e-10;
/// Shift of the break-away indicators, relative to the level.
const LEVEL_SHIFT: f64 = 1e-10;

/// What an event did.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Update {
    /// Continuous states were set anew.
    pub states_changed: bool,
    /// Time of the next sample, or of the next change of a delayed input, s.
    pub next_event: Option<f64>,
}

impl Unit {
    /// Sets the present time, s.
    pub fn set_time(&mut self, time: f64) {
        self.time = time;
    }

    /// Number of continuous states.
    pub fn state_count(&self) -> usize {
        self.states.len()
    }

    /// The continuous states, in the order of the state variables.
    pub fn continuous_states(&self) -> &[f64] {
        self.sampled.state().x.as_flattened()
    }

    /// Sets the continuous states; the sign of the motion changes at events alone.
    pub fn set_continuous_states(&mut self, states: &[f64]) {
        for (value, state) in self.sampled.state_mut().x.iter_mut().zip(states) {
            *value = [*state];
        }
    }

    /// Time derivatives of the states now.
    pub fn derivatives(&mut self) -> &[f64] {
        self.take_changes();
        let state = self.sampled.state();
        let applied = self.sampled.applied(self.time);
        let mut dx = vec![[0.0]; state.x.len()];
        field(self.sampled.model(), &state.x, &applied, &state.sign, &mut dx, None);
        self.derivatives.copy_from_slice(dx.as_flattened());
        &self.derivatives
    }

    /// The event indicators now.
    pub fn event_indicators(&mut self) -> &[f64] {
        self.take_changes();
        if !self.indicators.is_empty() {
            let state = self.sampled.state();
            let sign = state.sign[0];
            let values = if sign == 0.0 {
                let torques = at_rest(self.sampled.model(), &state.x, &self.applied());
                let shift = LEVEL_SHIFT * (torques.forward + torques.backward);
                [torques.forward - torques.net + shift, torques.backward + torques.net + shift]
            } else {
                [sign * state.x[SPEED][0] + SPEED_SHIFT, 1.0]
            };
            self.indicators.copy_from_slice(&values);
        }
        &self.indicators
    }

    fn applied(&self) -> Applied<f64, 1> {
        self.sampled.applied(self.time)
    }

    /// Lets events at the present time happen: a due sample, sticking, breaking away.
    pub fn update_discrete(&mut self) -> Update {
        self.take_changes();
        if let Some(period) = self.period() {
            let near = SAME_INSTANT * period;
            if self.time >= self.sample_time(period) - near {
                self.sample();
                // Samples that the importer passed over are gone: what the sensors would have shown
                // at their times is not known any more.
                let due = ((self.time - self.start) / period + SAME_INSTANT).floor() as u64;
                self.next_sample = self.next_sample.max(due.saturating_add(1));
            }
        }
        self.sampled.remember_input(self.time);
        let states_changed = self.sampled.model().directed() && self.update_sign();
        let sample = self.period().map(|period| self.sample_time(period));
        let change = self.sampled.delay().and_then(|line| line.next_change(self.time));
        let next_event = [sample, change].into_iter().flatten().reduce(f64::min);
        Update { states_changed, next_event }
    }

    /// Decides the sign of the motion anew; true if the speed was set to zero.
    fn update_sign(&mut self) -> bool {
        let applied = self.applied();
        let state = self.sampled.state();
        let sign = state.sign[0];
        if sign == 0.0 {
            let now = at_rest(self.sampled.model(), &state.x, &applied).sign();
            self.sampled.state_mut().sign = [now];
            return false;
        }
        if sign * state.x[SPEED][0] >= 0.0 {
            return false;
        }
        if !self.sampled.model().dry() {
            // Nothing sticks: the kink of the law is passed, and the state is continuous.
            self.sampled.state_mut().sign = [-sign];
            return false;
        }
        let mut x = state.x.clone();
        x[SPEED] = [0.0];
        let now = at_rest(self.sampled.model(), &x, &applied).sign();
        let state = self.sampled.state_mut();
        state.x[SPEED] = [0.0];
        state.sign = [now];
        true
    }

    /// Derivatives of the unknowns in the direction `seed` of the knowns, exact by duals;
    /// nothing if a reference is neither a derivative nor an output, or no state or input.
    pub fn directional(
        &self,
        unknowns: &[usize],
        knowns: &[usize],
        seed: &[f64],
    ) -> Option<Vec<f64>> {
        let mut now = self.clone();
        now.take_changes();
        let state = now.sampled.state();
        let lift = |value: f64, slope: f64| Dual { v: value, d: [slope] };
        let applied = now.applied();
        let mut x: Vec<[Dual<1>; 1]> = state.x.iter().map(|v| [lift(v[0], 0.0)]).collect();
        let (mut u, mut load) = (lift(applied.u[0], 0.0), lift(applied.load[0], 0.0));
        let (mut noise_t, mut noise_i) = (0.0, 0.0);
        // A continuous controller follows its command; a sampled one acts at events alone.
        let follows = now.sampled.model().control().is_some();
        let per_si = now.drive.sensors.tacho_unit.per_si();
        for (reference, slope) in knowns.iter().zip(seed) {
            match now.variables.get(*reference)?.slot {
                Slot::State(number) => x[number][0].d[0] += slope,
                Slot::Input(InputSlot::U) => u.d[0] += slope * now.input_gain(),
                Slot::Input(InputSlot::Load | InputSlot::NoiseLoad) => load.d[0] += slope,
                Slot::Input(InputSlot::Reference | InputSlot::NoiseReference) if follows => {
                    u.d[0] += slope;
                }
                Slot::Input(InputSlot::NoiseTacho) => {
                    noise_t += slope;
                    if follows {
                        u.d[0] -= slope * (1.0 + now.faults.tacho_noise) / per_si;
                    }
                }
                Slot::Input(InputSlot::NoiseCurrent) => noise_i += slope,
                // Sampled: they act at events alone.
                Slot::Input(_) | Slot::Fault(_) => {}
                Slot::Output(_) | Slot::Derivative(_) | Slot::Indicator(_) | Slot::Parameter(_) => {
                    return None;
                }
            }
        }
        let model = now.dual_model();
        let applied = Applied { u: [u], load: [load], time: now.time };
        let mut dx = vec![[Dual::zero()]; x.len()];
        field(&model, &x, &applied, &state.sign, &mut dx, None);
        let shown = model.outputs(&x, &applied).lane(0);
        let controlled = model.controlled(&x, &applied, 0);
        let c_m = controlled.map_or(0.0, |signals| signals.c_m.d[0]);
        let acting = controlled.map_or(u.d[0], |signals| signals.u.d[0]);
        unknowns
            .iter()
            .map(|reference| match now.variables.get(*reference)?.slot {
                Slot::Derivative(number) => Some(dx[number][0].d[0]),
                Slot::State(number) => Some(x[number][0].d[0]),
                Slot::Output(slot) => {
                    let held = (c_m, acting, load.d[0]);
                    Some(now.output_slope(slot, &shown, held, (noise_t, noise_i)))
                }
                _ => None,
            })
            .collect()
    }

    /// The continuous drive over duals, its parameters and motor faults as they are now.
    fn dual_model(&self) -> Model<Dual<1>, 1> {
        let values = self.drive.parameters();
        let mut model = self.drive.model_of(|name| {
            let value = values.iter().find(|parameter| parameter.name == name);
            Dual::constant(value.map_or(0.0, |parameter| parameter.value))
        });
        let motor = self.sampled.model().motors.lane(0);
        model.motors.set_lane(0, motor.map(Dual::constant));
        if let Some(controls) = self.sampled.model().control() {
            model.set_control(Controls::splat(controls.lane(0).map(Dual::constant)));
        }
        model
    }

    /// How the acting u follows the input u: the actuator's gain, or not at once.
    fn input_gain(&self) -> f64 {
        if self.sampled.delay().is_some() {
            return 0.0;
        }
        (1.0 + self.faults.actuator) * (1.0 + self.faults.supply)
    }

    fn output_slope(
        &self,
        slot: OutputSlot,
        shown: &Outputs<Dual<1>>,
        (c_m, u, load): (f64, f64, f64),
        (noise_t, noise_i): (f64, f64),
    ) -> f64 {
        let live = self.period().is_none();
        // A quantised or frozen signal is constant but for its jumps.
        let sensors = &self.drive.sensors;
        let tacho = live && sensors.tacho_quantum == 0.0 && self.faults.tacho_freeze <= FROZEN;
        let current =
            live && sensors.current_quantum == 0.0 && self.faults.current_freeze <= FROZEN;
        match slot {
            OutputSlot::Current => shown.i.d[0],
            OutputSlot::Speed => shown.omega.d[0],
            OutputSlot::Position => shown.theta.d[0],
            OutputSlot::Tacho if tacho => {
                let gain = (1.0 + self.faults.tacho) * sensors.tacho_unit.per_si();
                shown.omega.d[0] * gain + noise_t * (1.0 + self.faults.tacho_noise)
            }
            OutputSlot::MeasuredCurrent if current => {
                let gain = 1.0 + self.faults.current_sensor;
                shown.i.d[0] * gain + noise_i * (1.0 + self.faults.current_noise)
            }
            OutputSlot::Control => c_m,
            OutputSlot::Voltage if live => u,
            OutputSlot::Load => load,
            _ => 0.0,
        }
    }
}
