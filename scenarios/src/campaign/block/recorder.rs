//! The signals of one scenario.

use drivescope_plant::effects::law::OutputLanes;
use drivescope_plant::sampled::{InputLanes, Samples, SignalLanes};
use drivescope_recording::{Recording, Signal};

use super::super::noise::NoiseLanes;
use super::super::plan::Plan;

/// Names and units of what is recorded; `T` has the tachometer's unit, speeds and angles those of
/// the motion.
const RECORDED: [(&str, &str); 7] = [
    ("C_m", "V"),
    ("T", ""),
    ("I_m", "A"),
    ("i", "A"),
    ("omega", "rad/s"),
    ("theta", "rad"),
    ("T_l", "N m"),
];

/// Noise into the drive, its signals into columns.
pub(super) struct Recorder {
    noise: NoiseLanes<1>,
    inputs: InputLanes<f64, 1>,
    columns: [Vec<f64>; RECORDED.len()],
}

impl Recorder {
    pub(super) fn new(noise: NoiseLanes<1>, inputs: InputLanes<f64, 1>) -> Self {
        Self { noise, inputs, columns: Default::default() }
    }

    /// What was recorded.
    pub(super) fn recording(self, plan: &Plan, scenario: u64) -> Recording {
        let linear = plan.experiment.tacho_unit() == "m/s";
        let columns = RECORDED.into_iter().zip(self.columns);
        let signals = columns.map(|((name, unit), values)| {
            let (name, unit) = match (name, linear) {
                ("T", _) => (name, plan.experiment.tacho_unit()),
                ("omega", true) => ("v", "m/s"),
                ("theta", true) => ("x", "m"),
                ("T_l", true) => (name, "N"),
                _ => (name, unit),
            };
            Signal { name: name.to_owned(), unit: unit.to_owned(), values }
        });
        let name = format!("scenario {scenario}");
        Recording::new(name, 0.0, plan.experiment.period_s, signals.collect())
    }
}

impl Samples<1> for Recorder {
    #[inline(always)]
    fn inputs(&mut self, _: usize) -> &InputLanes<f64, 1> {
        self.noise.fill(&mut self.inputs);
        &self.inputs
    }

    #[inline(always)]
    fn keep(&mut self, _: usize, signals: &SignalLanes<f64, 1>, shown: &OutputLanes<f64, 1>) {
        let row =
            [signals.c_m, signals.t, signals.i_m, shown.i, shown.omega, shown.theta, signals.load];
        for (column, [value]) in self.columns.iter_mut().zip(row) {
            column.push(value);
        }
    }
}
