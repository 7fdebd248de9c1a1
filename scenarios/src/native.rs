//! A run of the drive without any FMU: the reference for what the FMU must give, bit for bit.

use drivescope_numerics::dispatch::{prefetch, transposed};
use drivescope_plant::drive::Drive;
use drivescope_plant::effects::law::OutputLanes;
use drivescope_plant::fault::{FaultLanes, Faults, Mechanism};
use drivescope_plant::integrate::{Block, Integrator, Stepper};
use drivescope_plant::model::Model;
use drivescope_plant::sampled::{
    InputLanes, Inputs, Sampled, Samples, SignalLanes, Span, speed_bound,
};
use drivescope_plant::unit::Unit;
use drivescope_recording::{Recording, Signal};

use crate::experiment::unit_among;

/// Signals of a sample that a run records, with the FMU's names.
pub const RECORDED: [&str; 6] = ["C_m", "T", "I_m", "i", "omega", "theta"];

/// Runs the closed loop over the inputs, one sample a row. Row k of the result holds C_m, T and
/// I_m of sample k and the ideal i, omega and theta at its end.
pub fn closed_loop(drive: &Drive, inputs: &Recording) -> Recording {
    let integrator = Integrator::new(drive.model(), speed_bound(drive));
    let mut made = empty(inputs, &units(drive));
    run(&mut Sampled::new(drive, integrator, true), [inputs], std::slice::from_mut(&mut made));
    made
}

/// Closed loops of one drive side by side, and their recordings: a second run of them takes the memory
/// of the first, for fresh memory costs as much as the run itself.
///
/// Neither here nor for [`OneClosedLoop`] does the caller choose the number of lanes: what does the work
/// is compiled once then, here.
#[derive(Debug, Clone)]
pub struct ClosedLoops(Loops<LANES>);

/// Lanes of [`ClosedLoops`].
pub const LANES: usize = 16;

impl ClosedLoops {
    /// Loops of that drive.
    pub fn new(drive: &Drive) -> Self {
        Self(Loops::new(drive))
    }

    /// Runs a loop over each of the inputs, which have one length and sampling time; lanes that
    /// are left over repeat the last of them. A lane gives the same bits as [`closed_loop`].
    ///
    /// # Panics
    /// If there are more than [`LANES`] inputs, or one is shorter than the first.
    pub fn run(&mut self, inputs: &[Recording]) -> &[Recording] {
        self.0.run(inputs)
    }
}

/// One of [`ClosedLoops`] alone.
#[derive(Debug, Clone)]
pub struct OneClosedLoop(Loops<1>);

impl OneClosedLoop {
    /// The loop of that drive.
    pub fn new(drive: &Drive) -> Self {
        Self(Loops::new(drive))
    }

    /// Runs it over the inputs.
    pub fn run(&mut self, inputs: &Recording) -> Option<&Recording> {
        self.0.run(std::slice::from_ref(inputs)).first()
    }
}

#[derive(Debug, Clone)]
struct Loops<const N: usize> {
    at_rest: Sampled<N, Block<f64, N>>,
    units: Units,
    made: Vec<Recording>,
}

impl<const N: usize> Loops<N> {
    fn new(drive: &Drive) -> Self {
        let model = drive.model();
        let block = Block::new(Model::side_by_side([&model; N]), speed_bound(drive));
        let at_rest = Sampled::new(drive, block, true);
        Self { at_rest, units: units(drive), made: Vec::new() }
    }

    fn run(&mut self, inputs: &[Recording]) -> &[Recording] {
        assert!(inputs.len() <= N, "{} runs in {N} lanes", inputs.len());
        self.made.truncate(inputs.len());
        for (k, of) in inputs.iter().enumerate() {
            match self.made.get_mut(k) {
                Some(made) => reuse(made, of),
                None => self.made.push(empty(of, &self.units)),
            }
        }
        if let Some(last) = inputs.last() {
            let lanes = std::array::from_fn(|l| inputs.get(l).unwrap_or(last));
            run(&mut self.at_rest.clone(), lanes, &mut self.made);
        }
        &self.made
    }
}

/// Units of [`RECORDED`].
type Units = [String; RECORDED.len()];

/// Those that the drive's FMU has.
fn units(drive: &Drive) -> Units {
    let unit = Unit::new(drive.clone(), false);
    RECORDED.map(|name| unit_among(unit.variables(), name).unwrap_or_default().to_owned())
}

/// A recording of a run over those inputs, its rows still to be written.
fn empty(inputs: &Recording, units: &Units) -> Recording {
    let signals = RECORDED.iter().zip(units).map(|(name, unit)| Signal {
        name: (*name).to_owned(),
        unit: unit.clone(),
        values: vec![0.0; inputs.len()],
    });
    let name = inputs.name.clone();
    Recording::new(name, inputs.start_s, inputs.period_s, signals.collect())
}

/// Makes the recording of another run one over those inputs, its rows still to be written.
fn reuse(made: &mut Recording, inputs: &Recording) {
    made.name.clone_from(&inputs.name);
    (made.start_s, made.period_s) = (inputs.start_s, inputs.period_s);
    for signal in &mut made.signals {
        signal.values.resize(inputs.len(), 0.0);
    }
}

/// A column of each lane; nothing if no lane has it.
type Column<'a, const N: usize> = Option<[&'a [f64]; N]>;

/// The columns of all lanes.
struct Columns<'a, const N: usize> {
    reference: Column<'a, N>,
    load: Column<'a, N>,
    noise_reference: Column<'a, N>,
    noise_t: Column<'a, N>,
    noise_i_m: Column<'a, N>,
    /// Every column once, to be asked for ahead.
    streams: Vec<&'a [f64]>,
    /// Lane, mechanism and sizes of every fault.
    faults: Vec<(usize, usize, &'a [f64])>,
}

impl<'a, const N: usize> Columns<'a, N> {
    /// The columns of those inputs; `zero` stands in for one that a lane does not have.
    fn new(inputs: [&'a Recording; N], zero: &'a [f64]) -> Self {
        let column = |name| {
            let of = inputs.map(|lane: &'a Recording| lane.signal(name));
            let some = of.iter().any(Option::is_some);
            some.then(|| of.map(|signal| signal.map_or(zero, |s| s.values.as_slice())))
        };
        let mut faults = Vec::new();
        for (l, lane) in inputs.iter().enumerate() {
            for signal in &lane.signals {
                let mechanism = signal.name.strip_prefix("fault_").and_then(Mechanism::find);
                if let Some(mechanism) = mechanism {
                    faults.push((l, mechanism, signal.values.as_slice()));
                }
            }
        }
        let names = ["reference", "noise_T_l", "noise_reference", "noise_T", "noise_I_m"];
        let columns = names.map(column);
        let mut streams: Vec<&[f64]> = columns.iter().flatten().flatten().copied().collect();
        streams.dedup_by(|a, b| std::ptr::eq(*a, *b));
        let [reference, load, noise_reference, noise_t, noise_i_m] = columns;
        Self { reference, load, noise_reference, noise_t, noise_i_m, streams, faults }
    }

    /// The inputs of the samples from `first` on, into as many rows as there are.
    #[inline(always)]
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
            for first in (0..values.len()).step_by(TILE) {
                let pairs = values[first..values.len().min(first + TILE + 1)].windows(2);
                // Most tiles hold no change: a sum over the pairs needs no branch.
                let count: u64 = pairs.clone().map(|pair| u64::from(pair[0] != pair[1])).sum();
                if count > 0 {
                    let changed = pairs.enumerate().filter(|(_, pair)| pair[0] != pair[1]);
                    places.extend(changed.map(|(k, _)| first + k + 1));
                }
            }
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

/// Turns a column a lane into lanes a sample, two lanes and two samples at a time.
#[inline(always)]
fn turn<const N: usize>(
    column: &Column<'_, N>,
    first: usize,
    rows: &mut [InputLanes<f64, N>],
    place: impl Fn(&mut InputLanes<f64, N>) -> &mut [f64; N],
) {
    let Some(column) = column else { return };
    let samples = first..first + rows.len();
    let (row_pairs, last_row) = rows.as_chunks_mut::<2>();
    let (lane_pairs, last_lane) = column.as_chunks::<2>();
    for (pair, columns) in lane_pairs.iter().enumerate() {
        let [(a, a_last), (b, b_last)] =
            columns.map(|values| values[samples.clone()].as_chunks::<2>());
        for (two, (a, b)) in row_pairs.iter_mut().zip(a.iter().zip(b)) {
            let [this, next] = two.each_mut().map(|row| &mut place(row).as_chunks_mut().0[pair]);
            [*this, *next] = transposed([*a, *b]);
        }
        for (row, (a, b)) in last_row.iter_mut().zip(a_last.iter().zip(b_last)) {
            place(row).as_chunks_mut().0[pair] = [*a, *b];
        }
    }
    for values in last_lane {
        for (row, value) in rows.iter_mut().zip(&values[samples.clone()]) {
            place(row)[N - 1] = *value;
        }
    }
}

/// Samples that are turned at once: their inputs and signals stay in the fastest cache.
const TILE: usize = 16;

/// Inputs and recorded signals of some samples, lane beside lane, between the columns that they
/// come from and the recordings of the first lanes that they go to. Both are turned as part of
/// the run, which is compiled for the widest instruction set.
#[repr(align(64))]
struct Tile<'a, const N: usize> {
    inputs: [InputLanes<f64, N>; TILE],
    kept: [[[f64; N]; RECORDED.len()]; TILE],
    columns: &'a Columns<'a, N>,
    made: &'a mut [Recording],
    /// The samples in the tile, and where the next one ends at the latest.
    first: usize,
    until: usize,
    end: usize,
}

impl<const N: usize> Samples<N> for Tile<'_, N> {
    #[inline(always)]
    fn inputs(&mut self, k: usize) -> &InputLanes<f64, N> {
        if k == self.until {
            self.first = k;
            self.until = self.end.min(k + TILE);
            self.columns.fill(k, &mut self.inputs[..self.until - k]);
        }
        self.ask_ahead(k - self.first);
        &self.inputs[k - self.first]
    }

    #[inline(always)]
    fn keep(&mut self, k: usize, signals: &SignalLanes<f64, N>, shown: &OutputLanes<f64, N>) {
        let [c_m, t, i_m, i, omega, theta] = &mut self.kept[k - self.first];
        (*c_m, *t, *i_m) = (signals.c_m, signals.t, signals.i_m);
        (*i, *omega, *theta) = (shown.i, shown.omega, shown.theta);
        if k + 1 == self.until {
            self.record();
        }
    }
}

impl<const N: usize> Tile<'_, N> {
    /// Asks, a few of them at each sample, for the inputs of the next tile and for the places of
    /// this one's signals: what is far from the processor arrives while it computes.
    #[inline(always)]
    fn ask_ahead(&mut self, sample: usize) {
        let share = |of: usize| sample * of / TILE..(sample + 1) * of / TILE;
        let next = self.first + TILE..self.first + 2 * TILE;
        for column in &self.columns.streams[share(self.columns.streams.len())] {
            prefetch(column.get(next.clone()).unwrap_or(&[]));
        }
        for made in &self.made[share(self.made.len())] {
            for signal in &made.signals {
                prefetch(&signal.values[self.first..self.until]);
            }
        }
    }

    /// Writes the signals of the tile into the recordings, two lanes and two samples at a time.
    #[inline(always)]
    fn record(&mut self) {
        let samples = self.first..self.until;
        let (kept_pairs, last_kept) = self.kept[..samples.len()].as_chunks::<2>();
        let (lane_pairs, last_lane) = self.made.as_chunks_mut::<2>();
        for signal in 0..RECORDED.len() {
            for (pair, made) in lane_pairs.iter_mut().enumerate() {
                let [(a, a_last), (b, b_last)] = made
                    .each_mut()
                    .map(|made| made.signals[signal].values[samples.clone()].as_chunks_mut::<2>());
                for (two, (a, b)) in kept_pairs.iter().zip(a.iter_mut().zip(b)) {
                    let lanes = two.each_ref().map(|rows| rows[signal].as_chunks().0[pair]);
                    [*a, *b] = transposed(lanes);
                }
                for (rows, (a, b)) in last_kept.iter().zip(a_last.iter_mut().zip(b_last)) {
                    [*a, *b] = rows[signal].as_chunks().0[pair];
                }
            }
            for made in last_lane.iter_mut() {
                let values = &mut made.signals[signal].values[samples.clone()];
                for (value, rows) in values.iter_mut().zip(&self.kept) {
                    *value = rows[signal][2 * lane_pairs.len()];
                }
            }
        }
    }
}

/// Runs the loops over their inputs and writes the signals into the recordings of the first lanes.
fn run<const N: usize, S: Stepper<N>>(
    sampled: &mut Sampled<N, S>,
    inputs: [&Recording; N],
    made: &mut [Recording],
) {
    let Some(first) = inputs.first() else { return };
    let zero = vec![0.0; first.len()];
    let columns = Columns::new(inputs, &zero);
    let mut tile = Tile::<N> {
        inputs: [InputLanes::splat(Inputs::NONE); TILE],
        kept: [[[0.0; N]; RECORDED.len()]; TILE],
        columns: &columns,
        made,
        first: 0,
        until: 0,
        end: 0,
    };
    for end in columns.changes(first.len()) {
        let samples = std::mem::replace(&mut tile.end, end)..end;
        let faults = columns.faults(samples.start);
        let span = Span { start_s: first.start_s, period_s: first.period_s, samples };
        sampled.run(&span, &faults, &mut tile);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drives::built_in;
    use crate::experiment::{Experiment, Stream};
    use crate::faults::twelve;
    use crate::results::TorqueReading;

    #[test]
    fn twelve_lanes_equal_twelve_runs_bit_for_bit_also_in_used_memory() {
        let drive = built_in("dr300").expect("it is built in").expect("it is right");
        let experiment = Experiment::new(drive, 3).expect("it is controlled");
        let inputs: Vec<Recording> = twelve(TorqueReading::Flux)
            .iter()
            .zip(0..)
            .map(|(fault, k)| experiment.closed_loop(4500, Stream::Faulty(k), Some(fault)))
            .collect();
        let mut loops = ClosedLoops::new(&experiment.drive);
        loops.run(&inputs[5..]);
        let together = loops.run(&inputs);
        assert_eq!(together.len(), 12);
        for (inputs, lane) in inputs.iter().zip(together) {
            assert!(closed_loop(&experiment.drive, inputs) == *lane);
            let units = lane.signals.iter().map(|signal| signal.unit.as_str());
            assert!(units.eq(["V", "rpm", "A", "A", "rad/s", "rad"]));
        }
    }
}
