//! Columns: what a small change of the drive would do to the innovations of a filtered recording.
//!
//! A change adds a share g to the state over each sample, and O to what the sensors show. Both come
//! from the plant itself at the filtered state, with the change as a dual (a law at its null, a
//! parameter), or with the change as it is (a law whose null is infinite); a free curve or a line in time acts through the disturbances d_T and d_V. The filter then does
//! with them what it does with the data:
//!
//! nu = H e + O,  w = nu / sd,  e <- A (e - K nu) + g.

use drivescope_plant::drive::Drive;
use drivescope_plant::model::OWN;
use nalgebra::DMatrix;

use super::direction::Direction;
use super::filter::{LOAD, SENSORS, Tick, VOLTAGE, Vector, own_states};
use super::rates::Rates;
use super::stepper::{Stepped, Stepper};
use crate::measured::Measured;

/// Directions of a pass.
pub(crate) const A_PASS: usize = 8;

/// Where the columns of some changes come from; sub-steps of a drive are no longer than that.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Source<'a> {
    /// Derivatives by those parameters of the drive, at most [`A_PASS`].
    Parameters { drive: &'a Drive, names: &'a [String] },
    /// Shares that are known, those of a tick after those of another.
    Given { shares: &'a [Share], count: usize },
    /// What a drive does otherwise than one that was stepped from every state of the track: one
    /// column; own states of which only the first few are `shared`, sub-steps no longer than that.
    Difference { of: &'a Drive, from: &'a [Stepped], shared: usize, longest_s: f64 },
    /// Series in units of torque, voltage, and of what each sensor shows, by the sample's tick.
    Series(&'a [Series]),
}

/// A column's share in the balances and in what the sensors show, one value a tick; what is empty
/// is zero.
#[derive(Debug, Clone, Default)]
pub(crate) struct Series {
    pub(crate) torque: Vec<f64>,
    pub(crate) voltage: Vec<f64>,
    pub(crate) shown: [Vec<f64>; SENSORS],
}

/// Shares of a change over a sample: in the next state, and in what the sensors show now.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Share {
    pub(crate) state: Vector,
    pub(crate) shown: [f64; SENSORS],
}

impl Share {
    pub(crate) fn none() -> Self {
        Self { state: Vector::zeros(), shown: [0.0; SENSORS] }
    }
}

enum Maker<'a> {
    Rates(Box<Rates<'a>>),
    Given(&'a [Share]),
    Difference { of: Box<Stepper<'a>>, from: &'a [Stepped], rows: usize },
    Series(&'a [Series]),
}

/// A pass on its way along a track.
pub(crate) struct Pass<'a> {
    maker: Maker<'a>,
    /// Of the drive of the track, kg m^2 (kg) and H.
    inertia: f64,
    inductance: f64,
    errors: Vec<Vector>,
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
        let (maker, count) = match source {
            Source::Parameters { drive, names } => {
                (Maker::Rates(Box::new(Rates::new(drive, recording, known, names))), names.len())
            }
            Source::Given { shares, count } => (Maker::Given(shares), count),
            Source::Difference { of, from, shared, longest_s } => {
                let rows = OWN + shared.min(own_states(of)).min(known).min(LOAD - OWN);
                let of = Box::new(Stepper::new(of, recording.0, known, longest_s));
                (Maker::Difference { of, from, rows }, 1)
            }
            Source::Series(series) => (Maker::Series(series), series.len()),
        };
        let errors = vec![Vector::zeros(); count];
        Self {
            maker,
            inertia: base.motor.j,
            inductance: base.motor.l.unwrap_or(1.0),
            errors,
            room: vec![Share::none(); count],
        }
    }

    /// Number of its columns.
    pub(crate) fn len(&self) -> usize {
        self.errors.len()
    }

    /// Shares of all its changes along a track, those of a tick after those of another.
    pub(crate) fn all(mut self, track: &[Tick]) -> Vec<Share> {
        let mut all = Vec::with_capacity(self.len() * track.len());
        for (number, tick) in track.iter().enumerate() {
            self.shares(number, tick);
            all.extend_from_slice(&self.room);
        }
        all
    }

    /// Shares of all its changes at that tick, whose number on the track is `number`.
    fn shares(&mut self, number: usize, tick: &Tick) {
        let Self { maker, room, inertia, inductance, .. } = self;
        match maker {
            Maker::Rates(rates) => rates.shares(tick, room),
            Maker::Given(shares) => {
                let count = room.len();
                room.copy_from_slice(&shares[number * count..][..count]);
            }
            Maker::Difference { of, from, rows } => {
                let (with, without) = (of.at(tick), from[number]);
                // One that has fewer own states does nothing to those of the other.
                for row in 0..*rows {
                    room[0].state[row] = with.state[row] - without.state[row];
                }
                room[0].shown = std::array::from_fn(|it| with.shown[it] - without.shown[it]);
            }
            Maker::Series(series) => {
                for (share, one) in room.iter_mut().zip(series.iter()) {
                    let at = |values: &Vec<f64>| values.get(number).copied().unwrap_or(0.0);
                    let (torque, voltage) = (at(&one.torque), at(&one.voltage));
                    share.state = tick.transition.column(LOAD) * (torque / *inertia)
                        + tick.transition.column(VOLTAGE) * (voltage / *inductance);
                    share.state[LOAD] = 0.0;
                    share.state[VOLTAGE] = 0.0;
                    share.shown = std::array::from_fn(|sensor| at(&one.shown[sensor]));
                }
            }
        }
    }

    /// Writes whitened columns of some ticks into rows, one column a measured value; `from` is the
    /// number of the first tick. What the changes do is seen by `see`.
    pub(crate) fn fill(
        &mut self,
        ticks: &[Tick],
        from: usize,
        block: &mut DMatrix<f64>,
        mut see: impl FnMut(&[Share]),
    ) {
        let mut column = 0;
        for (number, tick) in ticks.iter().enumerate() {
            if tick.begins {
                self.errors.fill(Vector::zeros());
            }
            self.shares(from + number, tick);
            let measured: usize = tick.inverse_sd.iter().filter(|it| **it > 0.0).count();
            see(&self.room);
            for (row, share) in self.room.iter().enumerate() {
                let before = self.errors[row];
                let (mut error, mut place) = (before, column);
                for sensor in 0..SENSORS {
                    let inverse_sd = tick.inverse_sd[sensor];
                    if inverse_sd == 0.0 {
                        continue;
                    }
                    // The gains stand one after the other: each sensor sees what the ones before
                    // left.
                    let nu = tick.sense[sensor].dot(&error) + share.shown[sensor];
                    error -= tick.gain[sensor] * nu;
                    block[(row, place)] = nu * inverse_sd;
                    place += 1;
                }
                self.errors[row] = tick.transition * error + share.state;
            }
            column += measured;
        }
    }
}
