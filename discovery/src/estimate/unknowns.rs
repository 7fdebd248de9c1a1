//! What is estimated: parameters of the machine, parameters that differ from recording to
//! recording, and the state in which each piece of a recording begins.
//!
//! One vector of coordinates holds them all: first the machine's, then, recording by recording,
//! its own and its starts.

use drivescope_plant::drive::Drive;
use drivescope_plant::parameters::NamedParameter;

use super::Evidence;
use super::scale::{Reach, Scale, recorded_speeds};
use super::swing::swing;
use crate::measured::Measured;
use crate::start::Start;

/// One unknown.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Unknown {
    /// A parameter of the machine.
    Shared(String),
    /// A parameter that may differ from recording to recording.
    Own {
        recording: usize,
        /// The parameter.
        name: String,
    },
    /// A state at the beginning of a piece.
    Start {
        recording: usize,
        piece: usize,
        /// Its number in [`Start::values`].
        state: usize,
    },
}

/// The unknowns with their scales.
#[derive(Debug, Clone)]
pub(crate) struct Unknowns {
    pub(crate) all: Vec<Unknown>,
    pub(crate) scales: Vec<Scale>,
    /// A first guess of every recording's starts.
    pub(crate) starts: Vec<Vec<Start>>,
    /// Weight of the guess of each unknown, 1 / sd in its coordinate: 0 but for starts, which
    /// the recording may not tell.
    pub(crate) weights: Vec<f64>,
    /// Coordinates of the guess.
    pub(crate) guess: Vec<f64>,
}

/// Which parameters are estimated.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Which<'a> {
    /// All that a fit estimates but these.
    AllBut(&'a [String]),
    /// Those of each recording alone: the machine is as it is.
    Own,
    /// None: only the starts.
    StartsOnly,
}

impl Unknowns {
    pub(crate) fn new(
        base: &Drive,
        evidence: &Evidence,
        starts: Vec<Vec<Start>>,
        which: Which<'_>,
    ) -> Self {
        let speeds = recorded_speeds(&evidence.recordings, &evidence.noise);
        let mut made =
            Self { all: vec![], scales: vec![], starts: vec![], weights: vec![], guess: vec![] };
        let kept = |it: &&NamedParameter| match which {
            Which::AllBut(kept) => !kept.contains(&it.name),
            Which::Own => base.per_recording.contains(&it.name),
            Which::StartsOnly => false,
        };
        let fitted = base.fitted();
        let (own, shared): (Vec<_>, Vec<_>) =
            fitted.iter().filter(kept).partition(|it| base.per_recording.contains(&it.name));
        for parameter in shared {
            made.parameter(Unknown::Shared(parameter.name.clone()), parameter, speeds);
        }
        for (recording, measured) in evidence.recordings.iter().enumerate() {
            for parameter in &own {
                let name = parameter.name.clone();
                made.parameter(Unknown::Own { recording, name }, parameter, speeds);
            }
            for (piece, start) in starts[recording].iter().enumerate() {
                for state in start.free_states(base, measured, piece) {
                    made.start(Unknown::Start { recording, piece, state }, start, base, measured);
                }
            }
        }
        made.starts = starts;
        made
    }

    fn parameter(&mut self, unknown: Unknown, parameter: &NamedParameter, speeds: (f64, f64)) {
        let scale = Scale::of(parameter, speeds);
        self.guess.push(scale.coordinate(parameter.value));
        self.add(unknown, scale, 0.0);
    }

    fn start(&mut self, unknown: Unknown, start: &Start, base: &Drive, measured: &Measured) {
        let Unknown::Start { state, .. } = unknown else { return };
        // A start is anywhere within the signal's own swing.
        let scale = Scale::linear(swing(base, measured, state), (f64::NEG_INFINITY, f64::INFINITY));
        self.guess.push(scale.coordinate(start.values()[state]));
        self.add(unknown, scale, 1.0);
    }

    fn add(&mut self, unknown: Unknown, scale: Scale, weight: f64) {
        self.all.push(unknown);
        self.scales.push(scale);
        self.weights.push(weight);
    }

    /// Coordinates with the values of that drive, the starts as guessed.
    pub(crate) fn with_values_of(&self, drive: &Drive) -> Vec<f64> {
        let all = drive.parameters();
        let of = |k: usize| match &self.all[k] {
            Unknown::Shared(name) | Unknown::Own { name, .. } => {
                let value = all.iter().find(|it| it.name == *name).map(|it| it.value);
                value.map_or(self.guess[k], |value| self.scales[k].coordinate(value))
            }
            Unknown::Start { .. } => self.guess[k],
        };
        (0..self.all.len()).map(of).collect()
    }

    pub(crate) fn reaches(&self) -> Vec<Reach> {
        self.scales.iter().map(|scale| scale.reach).collect()
    }

    /// Numbers of the unknowns that a recording's run depends on.
    pub(crate) fn of_recording(&self, number: usize) -> Vec<usize> {
        let matters = |unknown: &Unknown| match unknown {
            Unknown::Shared(_) => true,
            Unknown::Own { recording, .. } | Unknown::Start { recording, .. } => {
                *recording == number
            }
        };
        (0..self.all.len()).filter(|k| matters(&self.all[*k])).collect()
    }

    /// The drive of a recording, and its starts, at those coordinates.
    pub(crate) fn at(
        &self,
        base: &Drive,
        number: usize,
        coordinates: &[f64],
    ) -> (Drive, Vec<Start>) {
        let (mut drive, mut starts) = (base.clone(), self.starts[number].clone());
        for k in self.of_recording(number) {
            let value = self.scales[k].value(coordinates[k]);
            match &self.all[k] {
                Unknown::Shared(name) | Unknown::Own { name, .. } => set(&mut drive, name, value),
                Unknown::Start { piece, state, .. } => {
                    starts[*piece] = starts[*piece].with(*state, value);
                }
            }
        }
        (drive, starts)
    }
}

/// Sets a parameter; a tied K_m follows K_e.
pub(crate) fn set(drive: &mut Drive, name: &str, value: f64) {
    // The bounds of the search lie within what is possible.
    let set = drive.set(name, value);
    debug_assert!(set.is_ok(), "{set:?}");
    if drive.motor.tie_k && name == "K_e" {
        drive.motor.k_m = value;
    }
}
