//! Start values by linear least squares on the balances of a drive.
//!
//! R, L and K_e enter the voltage balance linearly, J, B_m, dry friction and most laws the torque
//! balance; where a law has a speed for its scale, a few are tried. The balances are integrated
//! over windows as short as the sensors' noise allows, what noise adds to the squares of a
//! regressor is taken away, signs are those of physics, and where the shaft may be at rest nothing
//! judges dry friction. The values depend on the recordings and on what is fixed, not on the
//! file's values (but for a law's speed, where no other is clearly better): every fit begins alike.
//!
//! [`sensors`] finds true values behind what is shown, [`runs`] makes means over intervals of the
//! signals, [`windows`] averages them as long as noise asks for; [`laws`] finds what is linear; [`torque`]
//! and [`voltage`] are the two problems, which [`solve`] solves and [`begin`](mod@begin) puts together.

mod begin;
mod laws;
mod runs;
mod scales;
mod sensors;
mod solve;
mod torque;
mod voltage;
mod windows;

use std::borrow::Cow;

use drivescope_plant::drive::Drive;
use serde::Serialize;

use crate::estimate::Evidence;
use crate::measured::Measured;
use crate::settling::{damping, mechanical_time_s};
use laws::{along_motion, without_states};
use runs::{Run, runs};
use sensors::behind;
use voltage::VoltageWindows;
use windows::{Reading, Windows};

pub use begin::begin;
pub(crate) use begin::friction_at_rest;

/// Share of the applied torque that an inertia which nothing tells may take.
pub(crate) const UNIDENTIFIED_INERTIA: f64 = 0.01;

/// What a balance leaves unexplained.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Unexplained {
    /// Root of its mean square, N m (N) or V.
    pub rms: f64,
    /// The same over that of the applied torque (voltage).
    pub share: f64,
}

/// What both balances leave unexplained; none where one was not measured, or the drive has states
/// that were not.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BothUnexplained {
    /// Of the balance of torques (forces).
    pub torque: Option<Unexplained>,
    /// Of the balance of voltages.
    pub voltage: Option<Unexplained>,
}

impl From<[Option<Unexplained>; 2]> for BothUnexplained {
    fn from([torque, voltage]: [Option<Unexplained>; 2]) -> Self {
        Self { torque, voltage }
    }
}

/// A drive at the values that the balances give.
#[derive(Debug, Clone, PartialEq)]
pub struct Begun {
    pub drive: Drive,
    /// The parameters that the recordings tell.
    pub identified: Vec<Identified>,
}

/// A parameter that the balances tell.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Identified {
    pub name: String,
    /// Standard error of its value, SI, for errors of the balance that are correlated in time.
    pub std_error: f64,
}

/// The balances of some recordings, averaged over windows.
struct Balances {
    reading: Reading,
    torque: Vec<Windows>,
    voltage: Vec<VoltageWindows>,
}

impl Balances {
    fn of(drive: &Drive, evidence: &Evidence) -> Option<Self> {
        let reading = Reading::of(drive, evidence.recordings.first()?);
        let each = || evidence.recordings.iter().zip(&evidence.noise);
        let of_true_values = |measured: &Measured| runs(&behind(drive, measured));
        let cut: Vec<Vec<Run>> = evidence.recordings.iter().map(of_true_values).collect();
        let torque = |((measured, sds), runs): ((&Measured, &Vec<f64>), &Vec<Run>)| {
            (Reading::of(drive, measured) == reading)
                .then(|| Windows::of(measured, runs, sds, reading))?
        };
        let voltage = |((measured, sds), runs): ((&Measured, &Vec<f64>), &Vec<Run>)| {
            (reading == Reading::Current).then(|| VoltageWindows::of(measured, runs, sds))?
        };
        let torque: Vec<Windows> = each().zip(&cut).filter_map(torque).collect();
        let voltage = each().zip(&cut).filter_map(voltage).collect();
        (!torque.is_empty()).then_some(Self { reading, torque, voltage })
    }
}

impl Balances {
    /// Root of the number of windows that overlap: their errors are alike.
    fn overlap(&self) -> f64 {
        let longest = self.torque.iter().map(|windows| windows.length).max().unwrap_or(1);
        ((2 * longest - 1) as f64).sqrt()
    }

    fn small_inertia(&self, drive: &Drive) -> Option<f64> {
        let applied = self.unexplained(drive, 0)?;
        let squares = self
            .torque
            .iter()
            .map(Windows::acceleration)
            .fold([0.0; 2], |sum, it| [sum[0] + it[0], sum[1] + it[1]]);
        let acceleration = (squares[0] / squares[1]).sqrt();
        let torque = applied.rms / applied.share;
        (acceleration > 0.0 && torque > 0.0).then(|| UNIDENTIFIED_INERTIA * torque / acceleration)
    }

    fn unexplained(&self, drive: &Drive, balance: usize) -> Option<Unexplained> {
        in_all(&[self.squares(drive, balance)])
    }

    /// Squares of what is left of a balance and of what was applied, and their number.
    fn squares(&self, drive: &Drive, balance: usize) -> [f64; 3] {
        let each: Vec<[f64; 3]> = match balance {
            0 => self.torque.iter().map(|it| torque::unexplained(it, drive)).collect(),
            _ => self.voltage.iter().map(|it| voltage::unexplained(it, drive)).collect(),
        };
        added(&each)
    }
}

fn added(each: &[[f64; 3]]) -> [f64; 3] {
    each.iter().fold([0.0; 3], |sum, it| [sum[0] + it[0], sum[1] + it[1], sum[2] + it[2]])
}

/// What such squares leave together; none where nothing was applied.
fn in_all(each: &[[f64; 3]]) -> Option<Unexplained> {
    let [missing, all, n] = added(each);
    (all > 0.0).then(|| Unexplained { rms: (missing / n).sqrt(), share: (missing / all).sqrt() })
}

/// Whether least squares on the balances hold the drive whole: they know no states of its own.
pub(crate) fn hold(drive: &Drive) -> bool {
    without_states(drive).effects.len() == drive.effects.len()
}

/// What the drive leaves unexplained of the applied torque and of the voltage, each over windows
/// as short as noise allows; none where the balance was not measured, or the drive has states
/// that were not. What may differ from recording to recording is what each of them tells.
pub fn unexplained(drive: &Drive, evidence: &Evidence) -> [Option<Unexplained>; 2] {
    let parts = as_recorded(drive, evidence);
    let each: Vec<_> = parts.iter().map(|(drive, of)| squares(drive, of)).collect();
    std::array::from_fn(|balance| {
        in_all(&each.iter().filter_map(|it| it[balance]).collect::<Vec<_>>())
    })
}

/// Share of the acceleration that is no multiple of the torque that the drive leaves for it, whatever the
/// inertia; none where no torque was measured, or the drive has states that were not.
pub(crate) fn acceleration_left(drive: &Drive, evidence: &Evidence) -> Option<f64> {
    let products = |(drive, of): &(Cow<'_, Drive>, Cow<'_, Evidence>)| {
        let (plain, balances) = balanced(drive, of)?;
        let measured = balances.reading != Reading::Voltage;
        let each = || balances.torque.iter().map(|it| torque::accelerating(it, &plain));
        measured.then(|| added(&each().collect::<Vec<_>>()))
    };
    let parts = as_recorded(drive, evidence);
    let [a, t, both] = added(&parts.iter().filter_map(products).collect::<Vec<_>>());
    let explained = both.max(0.0).powi(2) / (a * t);
    explained.is_finite().then(|| (1.0 - explained).max(0.0).sqrt())
}

/// Squares of the balances of torque and voltage; none where one was not measured.
fn squares(drive: &Drive, evidence: &Evidence) -> [Option<[f64; 3]>; 2] {
    let Some((plain, balances)) = balanced(drive, evidence) else { return [None; 2] };
    let torque = (balances.reading != Reading::Voltage).then(|| balances.squares(&plain, 0));
    [torque, Some(balances.squares(&plain, 1))]
}

/// The drive in the recordings, all together; where something may differ from one to the next each alone,
/// with what its balances tell of that.
fn as_recorded<'a>(
    drive: &'a Drive,
    evidence: &'a Evidence,
) -> Vec<(Cow<'a, Drive>, Cow<'a, Evidence>)> {
    if drive.per_recording.is_empty() {
        return vec![(Cow::Borrowed(drive), Cow::Borrowed(evidence))];
    }
    let mut own = drive.clone();
    let shared = drive.fitted().into_iter().map(|it| it.name);
    own.fixed.extend(shared.filter(|name| !drive.per_recording.contains(name)));
    let alone = |k| {
        let alone = evidence.alone(k);
        (Cow::Owned(begin(&own, &alone).drive), Cow::Owned(alone))
    };
    (0..evidence.recordings.len()).map(alone).collect()
}

/// Share of what drives that the drive leaves unexplained: by the current or, for want of one, by the voltage,
/// whose balance then holds the induced voltage too. It compares drives at the same recordings.
pub fn unexplained_share(drive: &Drive, evidence: &Evidence) -> Option<f64> {
    let (plain, balances) = balanced(drive, evidence)?;
    balances.unexplained(&plain, 0).map(|it| it.share)
}

/// The drive along the motion, and its balances; nothing where it has states that were not measured.
fn balanced(drive: &Drive, evidence: &Evidence) -> Option<(Drive, Balances)> {
    let plain = along_motion(drive);
    let whole = plain.effects.len() == drive.effects.len();
    whole.then(|| Balances::of(drive, evidence)).flatten().map(|balances| (plain, balances))
}

/// An inertia that takes a small share of the applied torque, for a recording that tells none; none
/// if nothing was applied or moved.
pub fn small_inertia(drive: &Drive, evidence: &Evidence) -> Option<f64> {
    let balances = Balances::of(drive, evidence)?;
    balances.small_inertia(&without_states(drive))
}

/// How far the torque that a drive of this structure leaves unexplained at its best would move
/// its steady speed, as a share of the speed's root mean square, in the recording where that is
/// most; none where the torque balance was not measured, or the drive has states that were not.
pub(crate) fn drift(drive: &Drive, evidence: &Evidence) -> Option<f64> {
    let drive = &begin(drive, evidence).drive;
    let plain = without_states(drive);
    let balances = Balances::of(drive, evidence).filter(|it| it.reading != Reading::Voltage)?;
    if plain.effects.len() < drive.effects.len() {
        return None;
    }
    // What changes within the time in which the speed settles moves it less.
    let share = |windows: &Windows| {
        let torque = torque::slowly_missing(windows, &plain, mechanical_time_s(drive));
        torque / (damping(drive) * windows.speed())
    };
    balances.torque.iter().map(share).filter(|share| share.is_finite()).reduce(f64::max)
}
