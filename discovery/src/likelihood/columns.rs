//! Columns: what a small change of the drive would do to the innovations of a filtered recording.
//!
//! A change adds a share g to the state over each sample, and O to what the sensors show. Both come
//! from the plant itself at the filtered state, with the change as a dual (a law at its null, a
//! parameter), or with the change as it is (a law whose null is infinite); a free curve or a line in time acts through the disturbances d_T and d_V. The filter then does
//! with them what it does with the data:
//!
//! nu = H e + O,  w = nu / sd,  e <- A (e - K nu) + g.

use std::ops::Range;

use drivescope_numerics::dispatch::{Work, widest};
use drivescope_plant::drive::Drive;
use drivescope_plant::model::OWN;

use super::direction::Direction;
use super::rates::Rates;
use super::rows::{LANES, NO_ROWS, Row, Rows, add};
use super::share::Share;
use super::state::{LOAD, SENSORS, STATES, VOLTAGE, Vector, own_states};
use super::stepper::{Stepped, Stepper};
use super::track::{Tick, Track};
use crate::measured::Measured;

/// Where the columns of some changes come from; sub-steps of a drive are no longer than that.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Source<'a> {
    /// Derivatives by those parameters of the drive, at most [`A_PASS`].
    Parameters { drive: &'a Drive, names: &'a [String] },
    /// Shares of so many changes that are known, at most [`A_PASS`] of them.
    Given { shares: &'a [Share], count: usize },
    /// What a drive does otherwise than one that was stepped from every state of the track: one
    /// column; own states of which only the first few are `shared`, sub-steps no longer than that.
    Difference { of: &'a Drive, from: &'a [Stepped], shared: usize, longest_s: f64 },
    /// So many columns that are 0.
    Nothing(usize),
    /// Series in units of torque, voltage, and of what each sensor shows, by the sample's tick.
    Series(&'a [Series]),
}

impl Source<'_> {
    /// Number of its columns.
    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Parameters { names, .. } => names.len(),
            Self::Given { count, .. } | Self::Nothing(count) => *count,
            Self::Difference { .. } => 1,
            Self::Series(series) => series.len(),
        }
    }
}

/// A column's share in the balances and in what the sensors show, one value a tick; what is empty
/// is zero.
#[derive(Debug, Clone, Default)]
pub(crate) struct Series {
    pub(crate) torque: Vec<f64>,
    pub(crate) voltage: Vec<f64>,
    pub(crate) shown: [Vec<f64>; SENSORS],
}

enum Evaluator<'a> {
    Rates(Box<Rates<'a>>),
    Given(&'a [Share]),
    Difference { of: Box<Stepper<'a>>, from: &'a [Stepped], rows: usize },
    Nothing,
    Series { all: &'a [Series], yields: Yields },
}

/// What a torque and a voltage that are held over a sample do to the next state.
struct Yields {
    /// Number of the derivatives for which they were made.
    step: usize,
    /// Of the drive of the track, kg m^2 (kg) and H.
    inertia: f64,
    inductance: f64,
    torque: Vector,
    voltage: Vector,
}

impl Yields {
    fn at(&mut self, track: &Track, tick: &Tick) {
        if self.step != tick.step {
            let transition = &track.step(tick).transition;
            self.torque = transition.column(LOAD) / self.inertia;
            self.voltage = transition.column(VOLTAGE) / self.inductance;
            self.step = tick.step;
        }
    }
}

/// A pass on its way along a track.
pub(crate) struct Pass<'a> {
    evaluator: Evaluator<'a>,
    count: usize,
    /// Errors of the state that the changes leave under each filter, [`LANES`] columns at a time.
    errors: Vec<Vec<Rows>>,
    room: Vec<Share>,
}

impl<'a> Pass<'a> {
    /// `base` is the drive of the track.
    pub(crate) fn new(
        base: &Drive,
        recording: (&'a Measured, &'a Direction),
        source: Source<'a>,
    ) -> Self {
        let known = own_states(base);
        let count = source.len();
        let evaluator = match source {
            Source::Parameters { drive, names } => {
                Evaluator::Rates(Box::new(Rates::new(drive, recording, known, names)))
            }
            Source::Given { shares, .. } => Evaluator::Given(shares),
            Source::Difference { of, from, shared, longest_s } => {
                let rows = OWN + shared.min(own_states(of)).min(known).min(LOAD - OWN);
                let of = Box::new(Stepper::new(of, recording.0, known, longest_s));
                Evaluator::Difference { of, from, rows }
            }
            Source::Nothing(_) => Evaluator::Nothing,
            Source::Series(all) => {
                let yields = Yields {
                    step: usize::MAX,
                    inertia: base.motor.j,
                    inductance: base.motor.l.unwrap_or(1.0),
                    torque: Vector::zeros(),
                    voltage: Vector::zeros(),
                };
                Evaluator::Series { all, yields }
            }
        };
        let groups =
            if matches!(evaluator, Evaluator::Nothing) { 0 } else { count.div_ceil(LANES) };
        Self { evaluator, count, errors: Vec::new(), room: vec![Share::none(); groups] }
    }

    /// Number of its columns.
    pub(crate) fn len(&self) -> usize {
        self.count
    }

    /// Whether its columns are 0.
    pub(crate) fn is_nothing(&self) -> bool {
        matches!(self.evaluator, Evaluator::Nothing)
    }

    /// Shares of all its changes along a track, at most [`A_PASS`] of them.
    pub(crate) fn all(mut self, track: &Track) -> Vec<Share> {
        let at = |(number, tick): (usize, &Tick)| self.shares(number, track, tick)[0];
        track.ticks.iter().enumerate().map(at).collect()
    }

    /// Shares of all its changes at that tick, whose number on the track is `number`.
    fn shares(&mut self, number: usize, track: &Track, tick: &Tick) -> &[Share] {
        let room = &mut self.room;
        match &mut self.evaluator {
            Evaluator::Nothing => {}
            Evaluator::Rates(rates) => rates.shares(track, tick, &mut room[0]),
            Evaluator::Given(shares) => return &shares[number..=number],
            Evaluator::Difference { of, from, rows } => {
                let (with, without) = (of.at(tick), &from[number]);
                // One that has fewer own states does nothing to those of the other.
                for row in 0..*rows {
                    room[0].state[row][0] = with.state[row] - without.state[row];
                }
                for (sensor, shown) in room[0].shown.iter_mut().enumerate() {
                    shown[0] = with.shown[sensor] - without.shown[sensor];
                }
            }
            Evaluator::Series { all, yields } => {
                yields.at(track, tick);
                for (share, series) in room.iter_mut().zip(all.chunks(LANES)) {
                    // What is empty in all of them stays zero.
                    let row = |of: &dyn Fn(&Series) -> &Vec<f64>| -> Option<Row> {
                        let some = series.iter().any(|it| !of(it).is_empty());
                        some.then(|| {
                            let mut row = [0.0; LANES];
                            for (value, one) in row.iter_mut().zip(series) {
                                *value = of(one).get(number).copied().unwrap_or(0.0);
                            }
                            row
                        })
                    };
                    share.state[..LOAD].fill([0.0; LANES]);
                    for (row, yields) in [
                        (row(&|it| &it.torque), &yields.torque),
                        (row(&|it| &it.voltage), &yields.voltage),
                    ] {
                        let Some(row) = row else { continue };
                        for (state, yields) in share.state[..LOAD].iter_mut().zip(yields) {
                            add(state, *yields, &row);
                        }
                    }
                    for (sensor, shown) in share.shown.iter_mut().enumerate() {
                        row(&|it| &it.shown[sensor]).into_iter().for_each(|row| *shown = row);
                    }
                }
            }
        }
        &self.room
    }

    /// Writes whitened columns of those ticks under each of the filters, which were linearised along
    /// the first one's track, into a block each: rows of [`Pass::len`] values, one a measured value.
    /// What the changes do is seen by `see`.
    pub(crate) fn fill(
        &mut self,
        tracks: &[&Track],
        ticks: Range<usize>,
        blocks: &mut [Vec<f64>],
        mut see: impl FnMut(&[Share]),
    ) {
        let mut all = std::mem::take(&mut self.errors);
        all.resize(tracks.len(), vec![NO_ROWS; self.room.len()]);
        let mut written = 0;
        for number in ticks {
            let first = &tracks[0].ticks[number];
            if first.begins {
                all.iter_mut().for_each(|errors| errors.fill(NO_ROWS));
            }
            let count = self.count;
            let shares = self.shares(number, tracks[0], first);
            see(shares);
            let values = first.inverse_sd.iter().filter(|it| **it > 0.0).count() * count;
            let place = written..written + values;
            widest(Filtered { tracks, number, shares, count, all: &mut all, blocks, place });
            written += values;
        }
        self.errors = all;
    }
}

/// What the filters make of shares of changes at a tick of that number, written into that place of
/// their blocks.
struct Filtered<'a> {
    tracks: &'a [&'a Track],
    number: usize,
    shares: &'a [Share],
    count: usize,
    all: &'a mut [Vec<Rows>],
    blocks: &'a mut [Vec<f64>],
    place: Range<usize>,
}

impl Work for Filtered<'_> {
    #[inline(always)]
    fn run(self) {
        for ((track, errors), block) in self.tracks.iter().zip(self.all).zip(self.blocks) {
            let block = &mut block[self.place.clone()];
            filter(track, &track.ticks[self.number], (self.shares, self.count), errors, block);
        }
    }
}

/// What a filter makes of shares of changes at a tick: whitened values of each measured one, and the
/// errors that the changes leave in the state.
#[inline(always)]
fn filter(
    track: &Track,
    tick: &Tick,
    (shares, count): (&[Share], usize),
    errors: &mut [Rows],
    block: &mut [f64],
) {
    let step = track.step(tick);
    // Columns after columns: what eight of them leave in the state stays in registers from sensor to
    // sensor and into the next sample.
    for (group, (errors, share)) in errors.iter_mut().zip(shares).enumerate() {
        let mut error = *errors;
        let (mut from, width) = (group * LANES, LANES.min(count - group * LANES));
        for sensor in 0..SENSORS {
            let inverse_sd = tick.inverse_sd[sensor];
            if inverse_sd <= 0.0 {
                continue;
            }
            // The gains stand one after the other: each sensor sees what the ones before left.
            let mut nu = share.shown[sensor];
            for state in 0..STATES {
                let sense = step.sense[sensor][state];
                if sense != 0.0 {
                    add(&mut nu, sense, &error[state]);
                }
            }
            for state in 0..STATES {
                let gain = tick.gain[sensor][state];
                if gain != 0.0 {
                    add(&mut error[state], -gain, &nu);
                }
            }
            for value in &mut nu {
                *value *= inverse_sd;
            }
            block[from..from + width].copy_from_slice(&nu[..width]);
            from += count;
        }
        track.wandering.advance(&step.transition, &mut error, &share.state);
        *errors = error;
    }
}
