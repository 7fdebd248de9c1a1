//! A run of the drive without any FMU: the reference for what the FMU must give, bit for bit.

use drivescope_plant::drive::Drive;
use drivescope_plant::effects::law::OutputLanes;
use drivescope_plant::fault::{FaultLanes, Faults, Mechanism};
use drivescope_plant::integrate::{Block, Integrator, Stepper};
use drivescope_plant::model::Model;
use drivescope_plant::sampled::{
    InputLanes, Inputs, Sampled, Samples, SignalLanes, Span, speed_bound,
};
use drivescope_recording::{Recording, Signal};

/// Signals of a sample that a run records, with the FMU's names.
pub const RECORDED: [&str; 6] = ["C_m", "T", "I_m", "i", "omega", "theta"];

/// Runs the closed loop over the inputs, one sample a row. Row k of the result holds C_m, T and
/// I_m of sample k and the ideal i, omega and theta at its end.
pub fn closed_loop(drive: &Drive, inputs: &Recording) -> Recording {
    let integrator = Integrator::new(drive.model(), speed_bound(drive));
    let mut rows = run(Sampled::new(drive, integrator, true), [inputs], 1);
    recording(inputs, rows.remove(0))
}

/// Runs several closed loops of one drive side by side, each over its own inputs of the same
/// length and sampling time; the last lanes repeat the last inputs where there are fewer than
/// `N`. A lane gives the same bits as [`closed_loop`].
pub fn closed_loops<const N: usize>(drive: &Drive, inputs: &[Recording]) -> Vec<Recording> {
    let Some(last) = inputs.last() else { return Vec::new() };
    let model = drive.model();
    let block = Block::new(Model::side_by_side([&model; N]), speed_bound(drive));
    let lanes = std::array::from_fn(|l| inputs.get(l).unwrap_or(last));
    let rows = run(Sampled::<N, _>::new(drive, block, true), lanes, inputs.len());
    inputs.iter().zip(rows).map(|(of, rows)| recording(of, rows)).collect()
}

/// The signals of a run over those inputs.
fn recording(of: &Recording, rows: [Vec<f64>; RECORDED.len()]) -> Recording {
    let named = RECORDED.into_iter().zip(rows);
    let signals =
        named.map(|(name, values)| Signal { name: name.to_owned(), unit: String::new(), values });
    Recording {
        name: of.name.clone(),
        start_s: of.start_s,
        period_s: of.period_s,
        signals: signals.collect(),
    }
}

/// A column of each lane, where the lane has it.
type Column<'a, const N: usize> = [Option<&'a [f64]>; N];

/// The columns of all lanes.
struct Columns<'a, const N: usize> {
    reference: Column<'a, N>,
    load: Column<'a, N>,
    noise_reference: Column<'a, N>,
    noise_t: Column<'a, N>,
    noise_i_m: Column<'a, N>,
    /// Lane, mechanism and sizes of every fault.
    faults: Vec<(usize, usize, &'a [f64])>,
}

impl<'a, const N: usize> Columns<'a, N> {
    fn new(inputs: [&'a Recording; N]) -> Self {
        let column =
            |name| inputs.map(|lane: &'a Recording| Some(lane.signal(name)?.values.as_slice()));
        let mut faults = Vec::new();
        for (l, lane) in inputs.iter().enumerate() {
            for signal in &lane.signals {
                let mechanism = signal.name.strip_prefix("fault_").and_then(Mechanism::find);
                if let Some(mechanism) = mechanism {
                    faults.push((l, mechanism, signal.values.as_slice()));
                }
            }
        }
        Self {
            reference: column("reference"),
            load: column("noise_T_l"),
            noise_reference: column("noise_reference"),
            noise_t: column("noise_T"),
            noise_i_m: column("noise_I_m"),
            faults,
        }
    }

    /// The inputs of the samples from `first` on, into as many rows as there are.
    fn fill(&self, first: usize, rows: &mut [InputLanes<f64, N>]) {
        turn(&self.reference, first, rows, |row| &mut row.reference);
        turn(&self.load, first, rows, |row| &mut row.load);
        turn(&self.noise_reference, first, rows, |row| &mut row.noise_reference);
        turn(&self.noise_t, first, rows, |row| &mut row.noise_t);
        turn(&self.noise_i_m, first, rows, |row| &mut row.noise_i_m);
    }

    /// Where a fault changes, in ascending order, the end last.
    fn changes(&self, samples: usize) -> Vec<usize> {
        let mut places = vec![samples];
        for (_, _, values) in &self.faults {
            let pairs = values.windows(2).enumerate();
            places.extend(pairs.filter(|(_, pair)| pair[0] != pair[1]).map(|(k, _)| k + 1));
        }
        places.sort_unstable();
        places.dedup();
        places
    }

    /// The faults that act at sample `k`.
    fn faults(&self, k: usize) -> FaultLanes<f64, N> {
        let mut acting = [Faults::NONE; N];
        for (lane, mechanism, values) in &self.faults {
            if let Some(size) = acting[*lane].size_mut(*mechanism) {
                *size = values[k];
            }
        }
        let mut lanes = FaultLanes::splat(Faults::NONE);
        acting.iter().enumerate().for_each(|(l, faults)| lanes.set_lane(l, *faults));
        lanes
    }
}

/// Turns a column a lane into lanes a sample; a lane without the column stays as it is.
#[inline(always)]
fn turn<const N: usize>(
    column: &Column<'_, N>,
    first: usize,
    rows: &mut [InputLanes<f64, N>],
    lanes: impl Fn(&mut InputLanes<f64, N>) -> &mut [f64; N],
) {
    for l in 0..N {
        let Some(values) = column[l] else { continue };
        for (row, value) in rows.iter_mut().zip(&values[first..]) {
            lanes(row)[l] = *value;
        }
    }
}

/// Samples that are made at once: their inputs and signals stay in the fastest cache.
const TILE: usize = 16;

/// Inputs and recorded signals of some samples, lane beside lane.
struct Tile<const N: usize> {
    first: usize,
    inputs: [InputLanes<f64, N>; TILE],
    kept: [[[f64; N]; RECORDED.len()]; TILE],
}

impl<const N: usize> Samples<N> for Tile<N> {
    #[inline(always)]
    fn inputs(&mut self, k: usize) -> &InputLanes<f64, N> {
        &self.inputs[k - self.first]
    }

    #[inline(always)]
    fn keep(&mut self, k: usize, signals: &SignalLanes<f64, N>, shown: &OutputLanes<f64, N>) {
        self.kept[k - self.first] =
            [signals.c_m, signals.t, signals.i_m, shown.i, shown.omega, shown.theta];
    }
}

/// The recorded signals of the first `wanted` lanes.
fn run<const N: usize, S: Stepper<N>>(
    mut sampled: Sampled<N, S>,
    inputs: [&Recording; N],
    wanted: usize,
) -> Vec<[Vec<f64>; RECORDED.len()]> {
    let Some(first) = inputs.first() else { return Vec::new() };
    let samples = first.len();
    let columns = Columns::new(inputs);
    let row = || RECORDED.map(|_| Vec::with_capacity(samples));
    let mut rows: Vec<_> = (0..wanted).map(|_| row()).collect();
    let mut tile = Tile {
        first: 0,
        inputs: [InputLanes::splat(Inputs::NONE); TILE],
        kept: [[[0.0; N]; RECORDED.len()]; TILE],
    };
    for until in columns.changes(samples) {
        let faults = columns.faults(tile.first);
        while tile.first < until {
            let samples = TILE.min(until - tile.first);
            columns.fill(tile.first, &mut tile.inputs[..samples]);
            let span = Span {
                start_s: first.start_s,
                period_s: first.period_s,
                samples: tile.first..tile.first + samples,
            };
            sampled.run(&span, &faults, &mut tile);
            for (l, rows) in rows.iter_mut().enumerate() {
                for (signal, row) in rows.iter_mut().enumerate() {
                    row.extend(tile.kept[..samples].iter().map(|kept| kept[signal][l]));
                }
            }
            tile.first += samples;
        }
    }
    rows
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
