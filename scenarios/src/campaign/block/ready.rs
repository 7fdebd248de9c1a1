//! What a scenario needs before it runs: its machine, when its faults change, and whether it fits
//! beside others.

use drivescope_plant::drive::Drive;
use drivescope_plant::fault::Faults;
use drivescope_plant::integrate::longest_substep;
use drivescope_plant::model::Model;
use drivescope_plant::sampled::{rated_torque, speed_bound};

use super::super::plan::Scenario;
use super::{Blocks, timeline};

/// A scenario that is ready to run.
#[derive(Debug)]
pub(in crate::campaign) struct Ready {
    pub(super) scenario: Scenario,
    pub(super) model: Model<f64, 1>,
    /// Its own drive, where the plan changes more than the balances.
    pub(super) drive: Option<Drive>,
    pub(super) timeline: Vec<(usize, Faults<f64>)>,
    /// Its own longest sub-step, where it needs shorter ones than the block has, or stands alone.
    pub(super) alone: Option<f64>,
}

impl Ready {
    pub(in crate::campaign) fn scenario(&self) -> &Scenario {
        &self.scenario
    }
}

impl Blocks<'_> {
    /// Prepares a scenario.
    pub(in crate::campaign) fn ready(&self, index: u64) -> Ready {
        let scenario = self.plan.scenario(index);
        let mut values: Vec<f64> = self.nominal.iter().map(|(_, value)| *value).collect();
        for (place, value) in self.places.iter().zip(&scenario.parameters) {
            values[*place] = *value;
        }
        let model = self.drive.model_of(|name| {
            let at = self.nominal.iter().position(|(known, _)| known == name);
            at.map_or(f64::NAN, |at| values[at])
        });
        let drive = self.beside.then(|| self.drive_of(&scenario));
        let speed = drive.as_ref().map_or(self.speed, speed_bound);
        let timeline = timeline::timeline(self.plan, &scenario);
        let own = self.own_substep(&model, &timeline, speed);
        let same_layer = drive.as_ref().is_none_or(|own| self.shares_layer(own));
        let same_delay = model.delays() == self.delays;
        let fits = own >= self.longest && same_layer && same_delay;
        Ready { model, drive, timeline, alone: (!fits).then_some(own.min(self.longest)), scenario }
    }

    fn drive_of(&self, scenario: &Scenario) -> Drive {
        let mut drive = self.drive.clone();
        for (parameter, value) in self.plan.parameters().zip(&scenario.parameters) {
            // The plan was refused if a value were not possible.
            let _ = drive.set(&parameter.name, *value);
        }
        drive
    }

    /// Whether controller, amplifier, sensors and what loads refer to are those of the block.
    fn shares_layer(&self, own: &Drive) -> bool {
        let layer = |drive: &Drive| {
            let rated = rated_torque(drive);
            (drive.controller, drive.amplifier, drive.sensors, drive.generator, rated)
        };
        layer(own) == layer(&self.drive)
    }

    /// The longest sub-step that resolves a scenario, its faults included, s.
    fn own_substep(
        &self,
        model: &Model<f64, 1>,
        timeline: &[(usize, Faults<f64>)],
        speed: f64,
    ) -> f64 {
        let healthy = longest_substep(model, speed);
        let mut faulty = model.clone();
        let mut shortest = healthy;
        let mut before = model.motors;
        for (_, faults) in timeline {
            faulty.motors.set_lane(0, faults.in_motor(&model.motors.lane(0)));
            if faulty.motors != before {
                shortest = shortest.min(longest_substep(&faulty, speed));
                before = faulty.motors;
            }
        }
        shortest
    }
}
