//! What a drive's balance of torques leaves over the windows of a recording, and its derivatives.

use std::collections::BTreeMap;
use std::sync::{Arc, OnceLock};

use drivescope_numerics::Dual;
use drivescope_plant::drive::Drive;
use drivescope_plant::model::{Along, OWN, SPEED};

use super::super::plant::{Plant, sign};
use super::super::rows::LANES;
use super::super::scene::Recorded;
use super::super::state::own_states;
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
        Self::every(it, drive, (windows, 1), names)
    }

    /// The same at some points of each window, as laws are weighed.
    pub(super) fn at_points(
        it: &Recorded,
        drive: &Drive,
        windows: &Windows,
        names: &[String],
    ) -> Self {
        Self::every(it, drive, (windows, apart(drive, windows)), names)
    }

    fn every(it: &Recorded, drive: &Drive, windows: (&Windows, usize), names: &[String]) -> Self {
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

/// Samples of which one stands for the others where a law is weighed: states of its own go on from
/// sample to sample.
fn apart(drive: &Drive, windows: &Windows) -> usize {
    if own_states(drive) > 0 { 1 } else { windows.apart() }
}

/// A drive along a recording, to see by how much another one lacks less of the torque.
pub(super) struct Without<'a> {
    it: &'a Recorded,
    windows: &'a Windows,
    /// What it lacks itself, by the samples of which one stands for the others.
    missing: BTreeMap<usize, OnceLock<Vec<f64>>>,
}

impl<'a> Without<'a> {
    pub(super) fn new(it: &'a Recorded, windows: &'a Windows) -> Self {
        let missing = [1, windows.apart()].map(|apart| (apart, OnceLock::new())).into();
        Self { it, windows, missing }
    }

    /// What the other drive takes of what is missing: both at the same points, for what drives is in
    /// it too.
    pub(super) fn taken_by(&self, other: &Drive) -> Vec<f64> {
        let apart = apart(other, self.windows);
        let of = |drive: &Drive| Torques::every(self.it, drive, (self.windows, apart), &[]).missing;
        let without = self.missing[&apart].get_or_init(|| of(&self.it.drive));
        without.iter().zip(of(other)).map(|(without, with)| without - with).collect()
    }
}

fn rows(
    it: &Recorded,
    drive: &Drive,
    (windows, apart): (&Windows, usize),
    names: &[String],
) -> Vec<Number> {
    let seed = |name: &str, value: f64| match names.iter().position(|it| it == name) {
        Some(place) => Number::parameter(value, place),
        None => Number { v: value, d: [0.0; LANES] },
    };
    let constant = |v: f64| Number { v, d: [0.0; LANES] };
    let mut plant = Plant::new(drive, &it.measured, 0, seed);
    let mut along = Along::new(plant.held().0.clone(), it.measured.period_s);
    let at = |k: usize| {
        let point = &windows.motion[k];
        std::array::from_fn::<_, OWN, _>(|place| constant(point[place]))
    };
    let follows = |k: usize| {
        let mut point = at(k);
        point[SPEED] = constant(windows.speed[k]);
        point
    };
    let mut rows = vec![constant(0.0); windows.len()];
    let mut inertia = constant(drive.motor.j);
    for (number, piece) in windows.pieces().iter().enumerate() {
        plant.begin();
        along.begin();
        for (k, weights) in windows.weights(number, apart) {
            plant.enter(k);
            let (model, held) = plant.held();
            let sign = sign(model, it.direction.at(k), windows.motion[k][SPEED]);
            let [torque, of_shaft] = along.balance(held, sign, at(k));
            inertia = of_shaft;
            for (window, weight) in weights.into_iter().flatten() {
                rows[window] -= torque * constant(weight);
            }
            along.advance(held, sign, [follows(k), follows((k + 1).min(piece.end - 1))]);
        }
    }
    for (row, acceleration) in rows.iter_mut().zip(&windows.acceleration) {
        *row += inertia * constant(*acceleration);
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
