//! Shares of small changes of the drive, from its right-hand side at the mean state of each sample.
//!
//! What a change adds to the rates of the states, times what rates do over a sample, is what it adds
//! to the states; one evaluation of the plant with the law as a dual is enough where nothing turns
//! round within a sample.

use drivescope_numerics::Dual;
use drivescope_plant::drive::Drive;

use super::direction::Direction;
use super::plant::Plant;
use super::share::{A_PASS, Share};
use super::track::{Tick, Track};
use crate::measured::Measured;

type Number = Dual<A_PASS>;

pub(super) struct Rates<'a> {
    plant: Plant<'a, A_PASS>,
    direction: &'a Direction,
}

impl<'a> Rates<'a> {
    /// Of those parameters; `known` own states stand in the track's drive.
    pub(super) fn new(
        drive: &Drive,
        (measured, direction): (&'a Measured, &'a Direction),
        known: usize,
        names: &[String],
    ) -> Self {
        let seed = |name: &str, value: f64| match names.iter().position(|it| it == name) {
            Some(place) => Number::parameter(value, place),
            None => Number { v: value, d: [0.0; A_PASS] },
        };
        Self { plant: Plant::new(drive, measured, known, seed), direction }
    }

    /// Shares of the changes at that tick.
    pub(super) fn shares(&mut self, track: &Track, tick: &Tick, share: &mut Share) {
        let constant = |v: f64, _: usize| Number { v, d: [0.0; A_PASS] };
        let plant = &mut self.plant;
        if tick.begins {
            plant.begin();
        }
        plant.enter(tick.sample);
        if !plant.shows_state() {
            share.shown = plant.shown(&tick.predicted, constant).map(|it| it.d);
        }
        plant.rates(&tick.mean, self.direction.at(tick.sample), constant);
        share.state = track.step(tick).input.product(&plant.rate_rows());
        plant.advance();
    }
}
