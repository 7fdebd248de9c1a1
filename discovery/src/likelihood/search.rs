//! The search for the randomness with which recordings are most probable.

use drivescope_plant::drive::Input;

use super::climb::Climb;
use super::gram::References;
use super::judge::{FINE, Judge, Number};
use super::randomness::Randomness;
use super::scene::{Recorded, Scene};
use super::state::SENSORS;
use crate::measured::Output;

/// Turns through the numbers one by one where nothing is known, and steps of all of them at most.
const TURNS: usize = 2;
const STEPS: usize = 4;

/// Share of the voltage's first guess with which a search begins that is to find a load.
const QUIET: f64 = 0.02;

impl Randomness {
    /// As [`Self::searched`] where nothing is known yet: with no current, a random voltage passes for
    /// a load, and leaves out what is slow of it: the search begins with little voltage too.
    pub(super) fn sought(
        &self,
        scene: &Scene,
        references: &References,
        first: f64,
    ) -> Option<Self> {
        let found = self.searched(scene, references, first)?;
        let has_current = |it: &Recorded| it.measured.output(Output::Current).is_some();
        let force = scene.drive.motor.input == Input::Force;
        if force || scene.recordings.iter().all(has_current) {
            return Some(found);
        }
        let quiet = Self { voltage_sd: QUIET * self.voltage_sd, ..*self };
        let Some(other) = quiet.searched(scene, references, first) else { return Some(found) };
        let judge = Judge::of(scene, references, &found)?;
        let worth = |it: &Self| judge.of_randomness(it).unwrap_or(f64::NEG_INFINITY);
        Some(if worth(&other) > worth(&found) { other } else { found })
    }

    /// Found by a search that begins here with changes of that size, ln, the plant linearised as it
    /// is here.
    pub(super) fn searched(
        &self,
        scene: &Scene,
        references: &References,
        first: f64,
    ) -> Option<Self> {
        let judge = Judge::of(scene, references, self)?;
        let mut climb = Climb::from(*self, &judge, self.numbers(scene), first)?;
        if first > FINE {
            (0..TURNS).all(|_| climb.one_by_one());
        }
        (0..STEPS).all(|_| climb.together());
        Some(climb.best)
    }

    /// Its numbers that the recordings may tell.
    fn numbers(&self, scene: &Scene) -> Vec<Number> {
        let has = |output| scene.recordings.iter().any(|it| it.measured.output(output).is_some());
        let outputs = [Output::Current, Output::Speed, Output::Position];
        let mut numbers = vec![Number::LoadSize, Number::LoadTime];
        if scene.drive.motor.input == Input::Voltage {
            numbers.push(Number::VoltageSize);
        }
        if self.cycle.is_some() {
            numbers.extend((0..3).map(Number::Cycle));
        }
        numbers.extend((0..SENSORS).filter(|it| has(outputs[*it])).map(Number::Sensor));
        numbers
    }
}
