//! A mass on a spring with dry friction, pushed by a square wave and by two inputs.
//!
//! ```text
//! x' = v
//! m v' = F - F_c sign(v)   sliding,   F = u + push + (+-A) - k x - d v
//! v' = 0                   stuck, until |F| >= F_c
//! ```
//!
//! The square wave changes its sign every 0.1 s: a time event. Sticking and breaking away are
//! state events with the indicators `sign * v` and `F_c - |F|`.

use std::path::Path;

use drivescope_fmu::description::ModelDescription;
use drivescope_fmu::export::{Continuous, DiscreteUpdate, Model};

#[path = "variables.rs"]
mod variables;
use variables::{A, DER_V, DER_X, EVENTS, FORCE, M, PANICS, PUSH, STUCK, U, V, X, Z_BREAK, Z_STOP};

/// Half a period of the square wave, s.
const HALF_PERIOD: f64 = 0.1;
/// Times that differ by less, s, are the same: sums of steps round.
const SAME_TIME: f64 = 1e-9;
/// Longest step of the own integration, s: the error of RK4 is below 1e-12 at 1 Hz.
const LONGEST_STEP: f64 = 1e-3;

/// The oscillator with its parameters and its state.
#[derive(Clone, Debug, PartialEq)]
pub struct Oscillator {
    /// m, k, d, F_c, A
    parameters: [f64; 5],
    u: f64,
    push: f64,
    t: f64,
    /// x, v
    states: [f64; 2],
    derivatives: [f64; 2],
    indicators: [f64; 2],
    /// Direction of sliding: -1, 1, or 0 when stuck.
    direction: f64,
    /// Time events so far.
    events: f64,
    start: f64,
    panics: f64,
}

/// What the oscillator refuses.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum OscillatorError {
    /// No such variable, or none that can be set.
    #[error("value reference {0} cannot be set")]
    NotSettable(u32),
    /// A state that is not as long as one.
    #[error("a state has {expected} bytes, not {given}")]
    Length {
        /// Bytes of a state.
        expected: usize,
        /// Bytes given.
        given: usize,
    },
    /// The integration left the finite numbers.
    #[error("the state is no longer finite at {0} s")]
    Diverged(f64),
}

impl Oscillator {
    /// The force on the mass without dry friction.
    fn force(&self, [x, v]: [f64; 2]) -> f64 {
        let [_, k, d, _, amplitude] = self.parameters;
        let wave = if self.events % 2.0 == 0.0 { amplitude } else { -amplitude };
        self.u + self.push + wave - k * x - d * v
    }

    fn rates(&self, states: [f64; 2]) -> [f64; 2] {
        if self.direction == 0.0 {
            return [0.0, 0.0];
        }
        let [m, _, _, friction, _] = self.parameters;
        [states[1], (self.force(states) - friction * self.direction) / m]
    }

    fn crossings(&self, states: [f64; 2]) -> [f64; 2] {
        let friction = self.parameters[3];
        match self.direction {
            0.0 => [1.0, friction - self.force(states).abs()],
            direction => [direction * states[1], 1.0],
        }
    }

    fn next_event(&self) -> f64 {
        self.start + (self.events + 1.0) * HALF_PERIOD
    }

    /// Time and state events at the present time; whether a state was set anew.
    fn happen(&mut self) -> bool {
        if self.t >= self.next_event() - SAME_TIME {
            self.events += 1.0;
        }
        let [stop, _] = self.crossings(self.states);
        let at_rest = self.direction == 0.0 || stop <= 0.0;
        if !at_rest {
            return false;
        }
        let moved = self.states[1] != 0.0;
        self.states[1] = 0.0;
        let force = self.force(self.states);
        let breaks_away = force.abs() >= self.parameters[3];
        self.direction = if breaks_away { force.signum() } else { 0.0 };
        moved
    }

    /// One step of the classical Runge-Kutta method.
    fn advanced(&self, h: f64) -> [f64; 2] {
        let along = |rate: [f64; 2], h: f64| [0, 1].map(|i| self.states[i] + h * rate[i]);
        let k1 = self.rates(self.states);
        let k2 = self.rates(along(k1, h / 2.0));
        let k3 = self.rates(along(k2, h / 2.0));
        let k4 = self.rates(along(k3, h));
        [0, 1].map(|i| self.states[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]))
    }

    /// The longest step up to `h` in which no indicator changes its sign, by bisection; `None`
    /// where none does in the whole of it.
    fn until_crossing(&self, h: f64) -> Option<f64> {
        let crossed = |h: f64| self.crossings(self.advanced(h)).iter().any(|z| *z < 0.0);
        if !crossed(h) {
            return None;
        }
        let (mut before, mut after) = (0.0, h);
        while after - before > f64::EPSILON * LONGEST_STEP {
            let middle = 0.5 * (before + after);
            if crossed(middle) { after = middle } else { before = middle }
        }
        Some(after)
    }

    fn parameter(reference: u32) -> Option<usize> {
        (M..=A).contains(&reference).then(|| (reference - M) as usize)
    }
}

impl Model for Oscillator {
    type Error = OscillatorError;

    fn instantiate(_: Option<&Path>) -> Result<Self, Self::Error> {
        Ok(Self {
            parameters: [1.0, 40.0, 0.2, 0.5, 1.0],
            u: 0.0,
            push: 0.0,
            t: 0.0,
            states: [0.05, 0.0],
            derivatives: [0.0; 2],
            indicators: [0.0; 2],
            direction: 0.0,
            events: 0.0,
            start: 0.0,
            panics: 0.0,
        })
    }

    fn description(&self) -> ModelDescription {
        variables::description().expect("the units are known")
    }

    fn get(&self, reference: u32) -> Option<f64> {
        Some(match reference {
            X => self.states[0],
            V => self.states[1],
            DER_X => self.rates(self.states)[0],
            DER_V => self.rates(self.states)[1],
            U => self.u,
            PUSH => self.push,
            STUCK => f64::from(u8::from(self.direction == 0.0)),
            EVENTS => self.events,
            Z_STOP => self.crossings(self.states)[0],
            Z_BREAK => self.crossings(self.states)[1],
            PANICS => self.panics,
            FORCE => self.force(self.states),
            other => self.parameters[Self::parameter(other)?],
        })
    }

    fn set(&mut self, reference: u32, value: f64) -> Result<(), Self::Error> {
        match reference {
            X => self.states[0] = value,
            V => self.states[1] = value,
            U => self.u = value,
            PUSH => self.push = value,
            PANICS => self.panics = value,
            other => {
                let index = Self::parameter(other).ok_or(OscillatorError::NotSettable(other))?;
                self.parameters[index] = value;
            }
        }
        Ok(())
    }

    fn initialize(&mut self, start: f64) -> Result<(), Self::Error> {
        (self.t, self.start) = (start, start);
        self.direction = if self.states[1] == 0.0 { 0.0 } else { self.states[1].signum() };
        self.happen();
        Ok(())
    }

    fn step(&mut self, t: f64, h: f64) -> Result<(), Self::Error> {
        assert!(self.panics == 0.0, "the parameter `panics` is true");
        let end = t + h;
        self.t = t;
        // An input set since the last step may break the mass away.
        self.happen();
        while self.t < end - f64::EPSILON * end.abs() {
            let stop = end.min(self.next_event()).max(self.t);
            let whole = LONGEST_STEP.min(stop - self.t);
            let crossing = self.until_crossing(whole);
            let h = crossing.unwrap_or(whole);
            self.states = self.advanced(h);
            self.t = if h == stop - self.t { stop } else { self.t + h };
            if self.states.iter().any(|state| !state.is_finite()) {
                return Err(OscillatorError::Diverged(self.t));
            }
            if crossing.is_some() || self.t >= self.next_event() - SAME_TIME {
                self.happen();
            }
        }
        self.t = end;
        Ok(())
    }

    fn serialize(&self) -> Vec<u8> {
        let Self { parameters: [m, k, d, friction, amplitude], states: [x, v], .. } = *self;
        let run = [self.u, self.push, self.t, self.direction, self.events, self.start, self.panics];
        let numbers = [m, k, d, friction, amplitude, x, v];
        numbers.iter().chain(&run).flat_map(|number| number.to_le_bytes()).collect()
    }

    fn deserialize(&mut self, bytes: &[u8]) -> Result<(), Self::Error> {
        const NUMBERS: usize = 14;
        let (chunks, rest) = bytes.as_chunks::<8>();
        let length = OscillatorError::Length { expected: 8 * NUMBERS, given: bytes.len() };
        let numbers: Vec<f64> = chunks.iter().map(|chunk| f64::from_le_bytes(*chunk)).collect();
        let numbers: [f64; NUMBERS] = numbers.try_into().map_err(|_| length)?;
        if !rest.is_empty() {
            return Err(length);
        }
        let [m, k, d, friction, amplitude, x, v, ..] = numbers;
        self.parameters = [m, k, d, friction, amplitude];
        self.states = [x, v];
        let [.., u, push, t, direction, events, start, panics] = numbers;
        [self.u, self.push, self.t] = [u, push, t];
        [self.direction, self.events, self.start, self.panics] = [direction, events, start, panics];
        Ok(())
    }

    fn continuous(&mut self) -> Option<&mut dyn Continuous<Error = OscillatorError>> {
        Some(self)
    }

    fn directional(&self, unknowns: &[u32], knowns: &[u32], seed: &[f64]) -> Option<Vec<f64>> {
        let [m, k, d, _, _] = self.parameters;
        let slides = if self.direction == 0.0 { 0.0 } else { 1.0 };
        // Rows of the Jacobian over x, v, u; push acts as u does.
        let row = |unknown: &u32| match *unknown {
            X => Some([1.0, 0.0, 0.0]),
            V => Some([0.0, 1.0, 0.0]),
            DER_X => Some([0.0, slides, 0.0]),
            DER_V => Some([-k, -d, 1.0].map(|entry| slides * entry / m)),
            FORCE => Some([-k, -d, 1.0]),
            _ => None,
        };
        let mut direction = [0.0; 3];
        for (known, seed) in knowns.iter().zip(seed) {
            let column = [X, V, U, PUSH].iter().position(|reference| reference == known)?;
            direction[column.min(2)] += seed;
        }
        let along = |row: [f64; 3]| row.iter().zip(direction).map(|(a, b)| a * b).sum();
        unknowns.iter().map(|unknown| row(unknown).map(along)).collect()
    }
}

impl Continuous for Oscillator {
    type Error = OscillatorError;

    fn set_time(&mut self, t: f64) {
        self.t = t;
    }

    fn states(&self) -> &[f64] {
        &self.states
    }

    fn set_states(&mut self, states: &[f64]) {
        self.states.copy_from_slice(states);
    }

    fn derivatives(&mut self) -> Result<&[f64], OscillatorError> {
        self.derivatives = self.rates(self.states);
        Ok(&self.derivatives)
    }

    fn event_indicators(&mut self) -> Result<&[f64], OscillatorError> {
        self.indicators = self.crossings(self.states);
        Ok(&self.indicators)
    }

    fn update_discrete(&mut self) -> Result<DiscreteUpdate, OscillatorError> {
        let states_changed = self.happen();
        Ok(DiscreteUpdate { again: false, states_changed, next_event: Some(self.next_event()) })
    }
}
