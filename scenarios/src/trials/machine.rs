//! Machines of one kind, drawn anew, and what they show.

use drivescope_diagnoser::bank::Row;
use drivescope_plant::effects::registry::Entry;
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

use crate::experiment::{Experiment, Stream};
use crate::faults::Fault;
use crate::native::{ClosedLoops, LANES};
use crate::seen::rows;

/// Standard deviations over machines of one kind, as fractions.
const RESISTANCE: f64 = 0.03;
/// Torques of dry friction and the viscous one share it.
const FRICTION: f64 = 0.10;

/// What is tried, for seeds that do not meet.
#[derive(Debug, Clone, Copy)]
pub(super) enum Group {
    Design,
    Classes,
    Mechanisms,
    Delays,
    Known,
    Incipient,
    Unknown,
    Healthy,
    Curves,
    Hidden,
}

/// A machine, with noise of its own.
pub(super) struct Machine {
    pub(super) experiment: Experiment,
    pub(super) random: Pcg64Mcg,
}

/// A run of a machine.
pub(super) struct Plan {
    /// Speed that it follows, rad/s, one value a sample.
    pub(super) reference: Vec<f64>,
    pub(super) faults: Vec<Fault>,
}

/// The machine of that number, for that purpose.
pub(super) fn machine(experiment: &Experiment, group: Group, number: u64) -> Machine {
    /// Spreads neighbouring seeds and numbers: 2^64 over the golden ratio, odd.
    const SPREAD: u64 = 0x9E37_79B9_7F4A_7C15;
    let seed = experiment.seed.wrapping_mul(SPREAD).rotate_left(23)
        ^ ((group as u64) << 40 | number).wrapping_mul(SPREAD);
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut factor = |sd: f64| {
        let normal: f64 = StandardNormal.sample(&mut random);
        1.0 + sd * normal
    };
    let mut drive = experiment.drive.clone();
    drive.motor.r = drive.motor.r.map(|r| r * factor(RESISTANCE));
    let friction = factor(FRICTION);
    drive.motor.b_m *= friction;
    for effect in &mut drive.effects {
        let Some(law) = Entry::find(&effect.kind).filter(|law| law.info.dry) else { continue };
        let torque =
            |name: &str| law.parameters.iter().any(|it| it.name == name && it.unit == "N m");
        let torques = effect.parameters.iter_mut().filter(|(name, _)| torque(name));
        torques.for_each(|(_, torque)| *torque *= friction);
    }
    Machine { experiment: experiment.with_drive(drive).with_seed(seed), random }
}

impl Machine {
    /// From now on with the noise of that number: each thing that is tried on a machine has its own.
    pub(super) fn renew_noise(&mut self, number: usize) {
        self.experiment = self.experiment.with_seed(self.experiment.seed ^ number as u64);
    }

    /// What the sensors show over those runs, which have one length.
    pub(super) fn rows(&self, plans: &[Plan]) -> Vec<Vec<Row>> {
        let mut loops = ClosedLoops::new(&self.experiment.drive);
        let per_si = self.experiment.drive.sensors.tacho_unit.per_si();
        let mut made = Vec::with_capacity(plans.len());
        for (some, first) in plans.chunks(LANES).zip((0..).step_by(LANES)) {
            let inputs = some.iter().zip(first..).map(|(plan, number)| {
                let stream = Stream::Faulty(number);
                self.experiment.following(plan.reference.clone(), stream, &plan.faults)
            });
            let inputs: Vec<_> = inputs.collect();
            made.extend(loops.run(&inputs).iter().map(|run| rows(run, per_si)));
        }
        made
    }

    /// Plus or minus one.
    pub(super) fn sign(&mut self) -> f64 {
        if self.random.random() { 1.0 } else { -1.0 }
    }
}
