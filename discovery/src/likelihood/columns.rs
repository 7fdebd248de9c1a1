//! Columns: what a small change of the drive would do to the innovations of a filtered recording.
//!
//! A change adds a share g to the state over each sample, and O to what the sensors show. Both come
//! from the plant itself, which takes the sample from the filtered state with the change as a dual
//! (a law at its null, a parameter), or with the change as it is (a law whose null is infinite);
//! a free curve or a line in time acts through the disturbances d_T and d_V. The filter then does
//! with them what it does with the data:
//!
//! nu = H e + O,  w = nu / sd,  e <- A (e - K nu) + g.

use drivescope_numerics::Dual;
use drivescope_plant::drive::Drive;
use drivescope_plant::model::OWN;
use nalgebra::DMatrix;

use super::filter::{LOAD, SENSORS, Stepper, Tick, VOLTAGE, Vector, own_states};
use crate::measured::Measured;

/// Directions of a pass.
pub(crate) const A_PASS: usize = 8;

/// Where the columns of some changes come from; sub-steps of a drive are no longer than that.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Source<'a> {
    /// Derivatives by those parameters of the drive, at most [`A_PASS`].
    Parameters { drive: &'a Drive, names: &'a [String], longest_s: f64 },
    /// What another drive does otherwise than that of the track: one column.
    Difference { drive: &'a Drive, longest_s: f64 },
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

impl<'a> Source<'a> {
    pub(crate) fn parameters(drive: &'a Drive, names: &'a [String], longest_s: f64) -> Self {
        Self::Parameters { drive, names, longest_s }
    }
}

impl Share {
    fn none() -> Self {
        Self { state: Vector::zeros(), shown: [0.0; SENSORS] }
    }
}

enum Maker<'a> {
    Duals { stepper: Box<Stepper<'a, A_PASS>>, names: usize },
    Difference { stepper: Box<Stepper<'a, 1>> },
    Series(&'a [Series]),
}

/// A pass on its way along a track.
pub(crate) struct Pass<'a> {
    maker: Maker<'a>,
    known: usize,
    errors: Vec<Vector>,
    room: Vec<Share>,
}

impl<'a> Pass<'a> {
    /// `base` is the drive of the track.
    pub(crate) fn new(base: &Drive, measured: &'a Measured, source: Source<'a>) -> Self {
        let known = own_states(base);
        let (maker, count) = match source {
            Source::Parameters { drive, names, longest_s } => {
                let seed = |name: &str, value: f64| match names.iter().position(|it| it == name) {
                    Some(place) => Dual::parameter(value, place),
                    None => Dual { v: value, d: [0.0; A_PASS] },
                };
                let stepper = Stepper::new(drive, measured, known, longest_s, seed);
                (Maker::Duals { stepper: Box::new(stepper), names: names.len() }, names.len())
            }
            Source::Difference { drive, longest_s } => {
                let seed = |_: &str, value: f64| Dual { v: value, d: [0.0; 1] };
                let stepper = Stepper::new(drive, measured, known, longest_s, seed);
                (Maker::Difference { stepper: Box::new(stepper) }, 1)
            }
            Source::Series(series) => (Maker::Series(series), series.len()),
        };
        let errors = vec![Vector::zeros(); count];
        Self { maker, known: known.min(LOAD - OWN), errors, room: vec![Share::none(); count] }
    }

    /// Number of its columns.
    pub(crate) fn len(&self) -> usize {
        self.errors.len()
    }

    /// Shares of all its changes at that tick, whose number on the track is `number`.
    fn shares(&mut self, number: usize, tick: &Tick) {
        let Self { maker, known, room, .. } = self;
        let rows = OWN + *known;
        match maker {
            Maker::Duals { stepper, names } => {
                if tick.begins {
                    stepper.begin();
                }
                let constant = |v: f64, _: usize| Dual { v, d: [0.0; A_PASS] };
                let shown = stepper.shown(tick.sample, &tick.predicted, constant);
                let next = stepper.step(tick.sample, &tick.filtered, constant);
                for (place, share) in room.iter_mut().enumerate().take(*names) {
                    for row in 0..rows {
                        share.state[row] = next[row][0].d[place];
                    }
                    share.shown = shown.map(|it| it.d[place]);
                }
            }
            Maker::Difference { stepper } => {
                if tick.begins {
                    stepper.begin();
                }
                let constant = |v: f64, _: usize| Dual { v, d: [0.0; 1] };
                let shown = stepper.shown(tick.sample, &tick.predicted, constant);
                let next = stepper.step(tick.sample, &tick.filtered, constant);
                // One that has fewer own states than the drive of the track does nothing to them.
                for row in 0..rows.min(next.len()) {
                    room[0].state[row] = next[row][0].v - tick.propagated[row];
                }
                for sensor in 0..SENSORS {
                    room[0].shown[sensor] = shown[sensor].v - tick.shown[sensor];
                }
            }
            Maker::Series(series) => {
                for (share, one) in room.iter_mut().zip(series.iter()) {
                    let at = |values: &Vec<f64>| values.get(number).copied().unwrap_or(0.0);
                    let (torque, voltage) = (at(&one.torque), at(&one.voltage));
                    share.state = tick.transition.column(LOAD) * torque
                        + tick.transition.column(VOLTAGE) * voltage;
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
