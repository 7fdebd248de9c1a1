//! A scenario of which a foreign FMU is the machine: the same noise and faults, the same detectors.

use drivescope_plant::fault::Faults;
use drivescope_recording::{Recording, Signal};

use super::super::foreign::ForeignPlant;
use super::ready::Ready;
use super::{Blocks, Outcome};
use crate::cosimulated::RunError;

impl Blocks<'_> {
    /// What became of a scenario.
    ///
    /// # Errors
    /// The FMU gave no result.
    pub(super) fn of_foreign(
        &self,
        plant: &ForeignPlant,
        ready: &Ready,
    ) -> Result<Option<Outcome>, RunError> {
        let signals = self.foreign_trace(plant, ready)?;
        let Some(mut watch) = self.watch([ready], 1) else { return Ok(None) };
        let [c_m, t, i_m] = [0, 1, 2].map(|signal: usize| &signals.signals[signal].values);
        for k in 0..signals.len() {
            watch.take(k as u64, [&[c_m[k]], &[t[k]], &[i_m[k]]]);
        }
        Ok(Some(watch.outcome(0, self.plan)))
    }

    /// C_m, T and I_m of a scenario.
    ///
    /// # Errors
    /// As [`Self::of_foreign`].
    pub(super) fn foreign_trace(
        &self,
        plant: &ForeignPlant,
        ready: &Ready,
    ) -> Result<Recording, RunError> {
        plant.run(self.entering(ready), &ready.scenario.parameters, &self.plan.experiment)
    }

    /// What enters the machine, one row a sample.
    fn entering(&self, ready: &Ready) -> Recording {
        let entering = self.plan.entering();
        let samples = self.plan.samples;
        let mut columns: Vec<Vec<f64>> = vec![Vec::with_capacity(samples); entering.len()];
        let (mut noise, mut inputs) = (self.noise([ready]), self.inputs([ready]));
        let mut changes = ready.timeline.iter().peekable();
        let mut faults = Faults::NONE;
        for k in 0..samples {
            while let Some((_, now)) = changes.next_if(|(at, _)| *at <= k) {
                faults = *now;
            }
            noise.fill(&mut inputs);
            for (column, input) in columns.iter_mut().zip(&entering) {
                column.push(input.value(&inputs, faults));
            }
        }
        let signals = entering.iter().zip(columns).map(|(input, values)| {
            let name = input.name();
            let unit = self.plan.experiment.unit_of(&name).unwrap_or_default().to_owned();
            Signal { name, unit, values }
        });
        let name = format!("scenario {}", ready.scenario.index);
        Recording::new(name, 0.0, self.plan.experiment.period_s, signals.collect())
    }
}
