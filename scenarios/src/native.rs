//! A run of the drive without any FMU: the reference for what the FMU must give, bit for bit.

use drivescope_plant::drive::Drive;
use drivescope_plant::fault::{FaultLanes, Faults, Mechanism};
use drivescope_plant::integrate::{Block, Integrator, Stepper};
use drivescope_plant::model::Model;
use drivescope_plant::sampled::{InputLanes, Sampled, speed_bound};
use drivescope_recording::{Recording, Signal};

/// Signals of a sample that a run records, with the FMU's names.
pub const RECORDED: [&str; 6] = ["C_m", "T", "I_m", "i", "omega", "theta"];

/// Runs the closed loop over the inputs, one sample a row. Row k of the result holds C_m, T and
/// I_m of sample k and the ideal i, omega and theta at its end.
pub fn closed_loop(drive: &Drive, inputs: &Recording) -> Recording {
    let integrator = Integrator::new(drive.model(), speed_bound(drive));
    let mut rows = run(Sampled::new(drive, integrator, true), [inputs]);
    let signals = rows.remove(0);
    Recording { signals, ..inputs.clone() }
}

/// Runs several closed loops of one drive side by side, each over its own inputs of the same
/// length and sampling time; the last lanes repeat the last inputs where there are fewer than
/// `N`. A lane gives the same bits as [`closed_loop`].
pub fn closed_loops<const N: usize>(drive: &Drive, inputs: &[Recording]) -> Vec<Recording> {
    let Some(last) = inputs.last() else { return Vec::new() };
    let model = drive.model();
    let block = Block::new(Model::side_by_side([&model; N]), speed_bound(drive));
    let lanes = std::array::from_fn(|l| inputs.get(l).unwrap_or(last));
    let rows = run(Sampled::<N, _>::new(drive, block, true), lanes);
    inputs.iter().zip(rows).map(|(of, signals)| Recording { signals, ..of.clone() }).collect()
}

/// The inputs of all lanes by sample: which place each column goes to.
struct Columns<'a, const N: usize> {
    named: [[Option<&'a [f64]>; N]; 5],
    faults: Vec<(usize, usize, &'a [f64])>,
}

impl<'a, const N: usize> Columns<'a, N> {
    fn new(inputs: [&'a Recording; N]) -> Self {
        let names = ["reference", "noise_T_l", "noise_reference", "noise_T", "noise_I_m"];
        let column = |lane: &'a Recording, name| lane.signal(name).map(|s| s.values.as_slice());
        let mut faults = Vec::new();
        for (l, lane) in inputs.iter().enumerate() {
            for signal in &lane.signals {
                let mechanism = signal.name.strip_prefix("fault_").and_then(Mechanism::find);
                if let Some(mechanism) = mechanism {
                    faults.push((l, mechanism, signal.values.as_slice()));
                }
            }
        }
        Self { named: names.map(|name| inputs.map(|lane| column(lane, name))), faults }
    }

    #[inline]
    fn inputs(&self, k: usize) -> InputLanes<f64, N> {
        let [reference, load, noise_reference, noise_t, noise_i_m] =
            self.named.each_ref().map(|lanes| lanes.map(|values| values.map_or(0.0, |v| v[k])));
        let zero = [0.0; N];
        InputLanes { reference, u: zero, load, c_g: zero, noise_reference, noise_t, noise_i_m }
    }

    #[inline]
    fn faults(&self, k: usize, acting: &mut [Faults<f64>; N]) {
        for (lane, mechanism, values) in &self.faults {
            if let Some(size) = acting[*lane].size_mut(*mechanism) {
                *size = values[k];
            }
        }
    }
}

fn run<const N: usize, S: Stepper<N>>(
    mut sampled: Sampled<N, S>,
    inputs: [&Recording; N],
) -> Vec<Vec<Signal>> {
    let Some(first) = inputs.first() else { return Vec::new() };
    let columns = Columns::new(inputs);
    let h = first.period_s;
    let mut acting = [Faults::NONE; N];
    let mut lanes = FaultLanes::splat(Faults::NONE);
    let mut rows = vec![RECORDED.map(|_| Vec::with_capacity(first.len())); N];
    for k in 0..first.len() {
        columns.faults(k, &mut acting);
        for (l, faults) in acting.iter().enumerate() {
            lanes.set_lane(l, *faults);
        }
        let time = first.time(k);
        sampled.sample(time, &columns.inputs(k), &lanes);
        sampled.advance(time, h);
        let shown = sampled.outputs(time + h);
        let signals = sampled.signals();
        let values = [signals.c_m, signals.t, signals.i_m, shown.i, shown.omega, shown.theta];
        for (l, rows) in rows.iter_mut().enumerate() {
            for (row, value) in rows.iter_mut().zip(&values) {
                row.push(value[l]);
            }
        }
    }
    let signal = |(name, values): (&str, Vec<f64>)| Signal {
        name: name.to_owned(),
        unit: String::new(),
        values,
    };
    rows.into_iter().map(|rows| RECORDED.into_iter().zip(rows).map(signal).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drives::built_in;
    use crate::experiment::{Experiment, Stream};
    use crate::faults::twelve;
    use crate::results::TorqueReading;

    #[test]
    fn twelve_lanes_equal_twelve_runs_bit_for_bit() {
        let drive = built_in("dr300").expect("it is built in").expect("it is right");
        let experiment = Experiment::new(drive, 3).expect("it is controlled");
        let inputs: Vec<Recording> = twelve(TorqueReading::Flux)
            .iter()
            .zip(0..)
            .map(|(fault, k)| experiment.closed_loop(4500, Stream::Faulty(k), Some(fault)))
            .collect();
        let together = closed_loops::<16>(&experiment.drive, &inputs);
        assert_eq!(together.len(), 12);
        for (inputs, lane) in inputs.iter().zip(together) {
            assert!(closed_loop(&experiment.drive, inputs) == lane);
        }
    }
}
