//! What a drive's balance of torques leaves over the windows of a recording, and its derivatives.

use std::sync::Arc;

use drivescope_numerics::Dual;
use drivescope_plant::drive::Drive;

use super::super::plant::Plant;
use super::super::rows::LANES;
use super::super::scene::Recorded;
use super::windows::Windows;
use crate::measured::Measured;

type Number = Dual<LANES>;

/// Torques over the windows of a recording, N m (N).
#[derive(Debug, Clone, Default)]
pub(super) struct Torques {
    /// J dω/dt less the torque of the model: what would have to act besides.
    pub(super) missing: Vec<f64>,
    /// What a unit of each parameter would take of it.
    pub(super) columns: Vec<Vec<f64>>,
}

impl Torques {
    /// Of a drive along the motion of a recording, by those parameters.
    pub(super) fn of(it: &Recorded, drive: &Drive, windows: &Windows, names: &[String]) -> Self {
        let mut all = Self::default();
        // Without a parameter there is still what is missing.
        let none: &[String] = &[];
        let chunks = names.chunks(LANES);
        for names in chunks.chain((names.is_empty()).then_some(none)) {
            let rows = rows(it, drive, windows, names);
            all.missing = rows.iter().map(|row| row.v).collect();
            let column = |place: usize| rows.iter().map(|row| -row.d[place]).collect();
            all.columns.extend((0..names.len()).map(column));
        }
        all
    }
}

fn rows(it: &Recorded, drive: &Drive, windows: &Windows, names: &[String]) -> Vec<Number> {
    let seed = |name: &str, value: f64| match names.iter().position(|it| it == name) {
        Some(place) => Number::parameter(value, place),
        None => Number { v: value, d: [0.0; LANES] },
    };
    let constant = |v: f64, _: usize| Number { v, d: [0.0; LANES] };
    let mut plant = Plant::new(drive, &it.measured, 0, seed);
    let inertia = plant.inertia();
    let of = |acceleration: &f64| inertia * constant(*acceleration, 0);
    let mut rows: Vec<Number> = windows.acceleration.iter().map(of).collect();
    for piece in 0..windows.pieces().len() {
        plant.begin();
        for (k, weights) in windows.weights(piece) {
            plant.enter(k);
            plant.rates(&windows.motion[k], it.direction.at(k), constant);
            let torque = plant.torque();
            for (window, weight) in weights.into_iter().flatten() {
                rows[window] -= torque * constant(weight, 0);
            }
            plant.advance();
        }
    }
    rows
}

/// The recording with the driving signal moved by so much.
pub(super) fn shifted(it: &Recorded, by: f64) -> Recorded {
    let u = it.measured.u.iter().map(|u| u + by).collect();
    Recorded { measured: Arc::new(Measured { u, ..(*it.measured).clone() }), ..it.clone() }
}

/// By how much what is missing of each window falls with the driving signal, over K: 1 where no law
/// depends on it.
pub(super) fn gains(it: &Recorded, drive: &Drive, windows: &Windows, by: f64) -> Vec<f64> {
    let at = |by: f64| Torques::of(&shifted(it, by), drive, windows, &[]).missing;
    let per = 2.0 * by * drive.motor.k_m;
    at(-by).iter().zip(at(by)).map(|(less, more)| (less - more) / per).collect()
}
