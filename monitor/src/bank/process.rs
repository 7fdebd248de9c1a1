//! A drive, with the effects of its file, as a process under faults.
//!
//! The state is the drive's (current, speed, own states of effects), the disturbance torque of the
//! noise model (22), held over a sample, and what machines of one kind differ by: resistance and
//! friction. Physics is the plant's own step.

use drivescope_diagnoser::bank::{
    Advanced, Belief, MECHANISMS, Mechanism, Process, Row, SENSORS, Sensed,
};
use drivescope_diagnoser::{MemoryError, Walk};
use drivescope_plant::drive::{Drive, Input};
use drivescope_plant::effects::law::Variable;
use drivescope_plant::effects::registry::Entry as Law;
use drivescope_plant::fault::Faults;
use drivescope_plant::model::{Applied, CURRENT, Motor, OWN, POSITION, SPEED};
use drivescope_plant::sampled::{rated_torque, speed_bound};
use thiserror::Error;

use super::lanes::{Lanes, above, differences, spread};
use super::mechanisms::{Entry, Ports, SMALL, entries, greatest_current, plus, shown};

/// A parameter of the machine that is learned: the mechanism that changes it, and the standard
/// deviation over healthy machines, as a fraction.
pub(super) type Learned = (&'static str, f64);
/// What is learned of each machine.
pub(super) const LEARNED: [Learned; 2] = [("resistance", 0.05), ("friction", 0.15)];
/// Drift of a learned parameter over a sample: one per cent over a million samples.
const DRIFT: f64 = 1e-5;
/// Noise of a sensor or of the load where the drive file has none, as a share of its range.
pub(super) const QUIET: f64 = 1e-4;
/// Correlation time of the disturbance torque where the file has none, s.
pub(super) const USUAL_TIME_S: f64 = 0.05;
/// Standard deviations of a sensor by which the state may differ from the first row.
const AT_FIRST: f64 = 10.0;

/// Why there is no process for a drive.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ProcessError {
    /// u is held back.
    #[error("the bank has no filter for a drive with a delay: take `delay` out of {drive}")]
    Delay { drive: String },
    /// The process was made for another number of states or lanes.
    #[error("{drive} has {states} states and needs {lanes} lanes")]
    Size {
        drive: String,
        states: usize,
        /// Lanes that it needs.
        lanes: usize,
    },
}

/// The drive in `N` states, `L` variations of it side by side.
#[derive(Debug, Clone)]
pub(super) struct DriveProcess<const N: usize, const L: usize> {
    lanes: Lanes<L>,
    ports: Ports,
    period_s: f64,
    /// States of the plant that move, in the order of the filter's.
    places: Vec<usize>,
    starts: Vec<f64>,
    entries: Vec<Entry>,
    mechanisms: Vec<Mechanism>,
    /// Lane of each mechanism; 0 for one on the sensors alone.
    lane: Vec<usize>,
    /// Each learned parameter: its mechanism, and the change of this machine.
    learned: Vec<(usize, f64)>,
    names: Vec<String>,
    faults: Faults<f64>,
    /// The same with a small one more, mechanism by mechanism.
    perturbed: Vec<Faults<f64>>,
    variance: [f64; SENSORS],
    quanta: [f64; SENSORS],
    /// Share of the disturbance torque that is left after a sample, its variance and what a sample
    /// adds to it.
    torque: [f64; 3],
}

/// States of a drive that move.
fn places(drive: &Drive) -> Vec<usize> {
    let over_angle = |kind: &str| {
        Law::find(kind).is_some_and(|law| law.info.fails_over.contains(&Variable::Theta))
    };
    let turns = drive.effects.iter().any(|it| it.law.is_some() || over_angle(&it.kind));
    let electrical = (drive.motor.input == Input::Voltage).then_some(CURRENT);
    let own = OWN..drive.model().states();
    electrical.into_iter().chain([SPEED]).chain(turns.then_some(POSITION)).chain(own).collect()
}

impl<const N: usize, const L: usize> DriveProcess<N, L> {
    /// The process of a drive that is sampled every `period_s`, without those mechanisms; of each
    /// machine those parameters are learned.
    ///
    /// # Errors
    /// A drive with a delay, or of another size than `N` and `L`.
    pub(super) fn new(
        drive: &Drive,
        period_s: f64,
        left_out: &[&str],
        learned: &[Learned],
    ) -> Result<Self, ProcessError> {
        if drive.model().delays().is_some() {
            return Err(ProcessError::Delay { drive: drive.name.clone() });
        }
        let places = places(drive);
        // What is learned needs its lane whether or not it is a hypothesis.
        let all = entries(drive, &[]);
        let kept = |entry: &Entry| {
            let id = entry.about.id.as_str();
            !left_out.contains(&id)
        };
        let learnable = |id: &str| drive.motor.input == Input::Voltage || id != "resistance";
        let is_learned =
            |entry: &Entry| learned.iter().any(|(id, _)| *id == entry.about.id && learnable(id));
        let (mut entries, others): (Vec<Entry>, Vec<Entry>) = all.into_iter().partition(kept);
        let hypotheses = entries.len();
        entries.extend(others.into_iter().filter(is_learned));
        let mut next = above(places.len() + 1);
        let mut lane = Vec::with_capacity(entries.len());
        for entry in &entries {
            lane.push(if entry.on_sensors { 0 } else { next });
            next += usize::from(!entry.on_sensors);
        }
        let learned: Vec<(usize, f64)> =
            (0..entries.len()).filter(|j| is_learned(&entries[*j])).map(|j| (j, 0.0)).collect();
        let states = places.len() + 1 + learned.len();
        if states != N || next > L {
            let drive = drive.name.clone();
            return Err(ProcessError::Size { drive, states, lanes: next });
        }
        let (noise, sensors) = (drive.noise, drive.sensors);
        let variance = |sd: f64, quantum: f64, range: f64| {
            (sd * sd + quantum * quantum / 12.0).max((QUIET * range).powi(2))
        };
        let time = if noise.torque_time > 0.0 { noise.torque_time } else { USUAL_TIME_S };
        let left = (-period_s / time).exp();
        let torque = noise.torque.max(QUIET * rated_torque(drive).unwrap_or(1.0));
        let mechanisms = entries[..hypotheses].iter().map(|entry| entry.about.clone()).collect();
        let names = learned.iter().map(|(j, _)| entries[*j].about.id.clone()).collect();
        let mut made = Self {
            lanes: Lanes::new(&drive.model(), speed_bound(drive)),
            ports: Ports::new(drive),
            period_s,
            starts: starts(drive, &places),
            places,
            entries,
            mechanisms,
            lane,
            learned,
            names,
            faults: Faults::NONE,
            perturbed: Vec::new(),
            variance: [
                variance(noise.omega, sensors.tacho_quantum, speed_bound(drive)),
                variance(noise.i, sensors.current_quantum, greatest_current(drive)),
                0.0,
            ],
            quanta: [sensors.tacho_quantum, sensors.current_quantum, 0.0],
            torque: [left, torque * torque, torque * torque * (1.0 - left * left)],
        };
        made.set_motors();
        Ok(made)
    }

    /// What this machine differs by, as fractions, in the order of [`Process::learned`].
    pub(super) fn machine(&self) -> Vec<f64> {
        self.learned.iter().map(|(_, change)| *change).collect()
    }

    /// The motor of this machine with those faults.
    fn motor(&self, faults: &Faults<f64>) -> Motor<f64> {
        let of_machine = |motor: Motor<f64>, (j, change): &(usize, f64)| {
            plus(Faults::NONE, self.entries[*j].number, *change).in_motor(&motor)
        };
        faults.in_motor(&self.learned.iter().fold(self.ports.motor, of_machine))
    }

    fn set_motors(&mut self) {
        let small = |entry: &Entry| plus(self.faults, entry.number, SMALL);
        self.perturbed = self.entries.iter().map(small).collect();
        let mut motors = [self.motor(&self.faults); L];
        for (faults, lane) in self.perturbed.iter().zip(&self.lane) {
            if *lane > 0 {
                motors[*lane] = self.motor(faults);
            }
        }
        // A block that changes prepares its steps anew; many faults leave the motor.
        let model = self.lanes.block.model();
        if motors.iter().enumerate().any(|(l, motor)| model.motors.lane(l) != *motor) {
            self.lanes.block.change(|model| {
                let lanes = motors.into_iter().enumerate();
                lanes.for_each(|(l, motor)| model.motors.set_lane(l, motor));
            });
        }
    }

    /// Puts the expected state and its variations into the lanes.
    fn fill(&mut self, x: &[f64; N], spreads: &[f64; N]) {
        for (n, place) in self.places.iter().enumerate() {
            let row = &mut self.lanes.state.x[*place];
            *row = [x[n]; L];
            row[above(n)] += spreads[n];
            row[above(n) + 1] -= spreads[n];
        }
    }

    /// What acts in each lane.
    fn applied(&self, x: &[f64; N], spreads: &[f64; N], row: &Row) -> Applied<f64, L> {
        let torque = self.places.len();
        let measured = row.shown[2];
        let u = |faults: &Faults<f64>| {
            if measured.is_finite() { measured } else { self.ports.voltage(faults, row.control) }
        };
        let load = x[torque] + self.ports.load(&self.faults);
        let mut applied = Applied { u: [u(&self.faults); L], load: [load; L], time: 0.0 };
        applied.load[above(torque)] += spreads[torque];
        applied.load[above(torque) + 1] -= spreads[torque];
        for (faults, lane) in self.perturbed.iter().zip(&self.lane) {
            if *lane > 0 {
                applied.u[*lane] = u(faults);
                applied.load[*lane] = x[torque] + self.ports.load(faults);
            }
        }
        applied
    }
}

/// Variance of each moving state at the start, where no sensor shows it.
fn starts(drive: &Drive, places: &[usize]) -> Vec<f64> {
    let of_effects = drive.effects.iter().filter_map(|it| Law::find(&it.kind));
    let nominal: Vec<f64> =
        of_effects.flat_map(|law| law.states.iter().map(|state| state.nominal)).collect();
    let start = |place: &usize| match *place {
        CURRENT => greatest_current(drive).powi(2),
        SPEED => speed_bound(drive).powi(2),
        POSITION => 1.0,
        own => nominal.get(own - OWN).map_or(1.0, |nominal| nominal * nominal),
    };
    places.iter().map(start).collect()
}

impl<const N: usize, const L: usize> Process<N> for DriveProcess<N, L> {
    fn mechanisms(&self) -> &[Mechanism] {
        &self.mechanisms
    }

    fn quanta(&self) -> [f64; SENSORS] {
        self.quanta
    }

    fn learned(&self) -> &[String] {
        &self.names
    }

    fn begin(&self, row: &Row) -> Belief<N> {
        let (mut mean, mut covariance) = ([0.0; N], [[0.0; N]; N]);
        for (n, place) in self.places.iter().enumerate() {
            covariance[n][n] = self.starts[n];
            let sensor = match *place {
                SPEED => 0,
                CURRENT => 1,
                _ => continue,
            };
            if row.shown[sensor].is_finite() {
                mean[n] = row.shown[sensor];
                covariance[n][n] = AT_FIRST * AT_FIRST * self.variance[sensor];
            }
        }
        let torque = self.places.len();
        covariance[torque][torque] = self.torque[1];
        for (k, name) in self.names.iter().enumerate() {
            let tolerance = LEARNED.iter().find(|(id, _)| id == name).map_or(0.0, |(_, sd)| *sd);
            covariance[torque + 1 + k][torque + 1 + k] = tolerance * tolerance;
        }
        Belief { mean, covariance }
    }

    fn sense(&mut self, x: &[f64; N], row: &Row) -> Sensed<N> {
        let mut sensed = Sensed {
            shown: [0.0; SENSORS],
            rows: [[0.0; N]; SENSORS],
            variance: self.variance,
            columns: [[0.0; MECHANISMS]; SENSORS],
        };
        // What ideal sensors would show, and by the state.
        let mut ideal = [0.0; SENSORS];
        if self.lanes.block.model().shows_state() {
            (ideal[0], ideal[1]) = (x[1], x[0]);
            (sensed.rows[0][1], sensed.rows[1][0]) = (1.0, 1.0);
        } else {
            let spreads = [SMALL; N];
            self.fill(x, &spreads);
            let applied = self.applied(x, &spreads, row);
            let outputs = self.lanes.block.model().outputs(&self.lanes.state.x, &applied);
            for (m, lanes) in [outputs.omega, outputs.i].into_iter().enumerate() {
                ideal[m] = lanes[0];
                for n in 0..self.places.len() {
                    sensed.rows[m][n] = differences(&lanes, n, SMALL).0;
                }
                for (j, lane) in self.lane.iter().enumerate().take(self.mechanisms.len()) {
                    if *lane > 0 {
                        sensed.columns[m][j] = (lanes[*lane] - lanes[0]) / SMALL;
                    }
                }
            }
        }
        sensed.shown = shown(&self.faults, ideal);
        let gain = shown(&self.faults, [1.0; SENSORS]);
        let zero = shown(&self.faults, [0.0; SENSORS]);
        for m in 0..SENSORS {
            sensed.rows[m] = sensed.rows[m].map(|by| by * (gain[m] - zero[m]));
        }
        for (j, faults) in self.perturbed.iter().enumerate().take(self.mechanisms.len()) {
            if self.lane[j] == 0 {
                let other = shown(faults, ideal);
                for m in 0..SENSORS {
                    sensed.columns[m][j] = (other[m] - sensed.shown[m]) / SMALL;
                }
            }
        }
        sensed
    }

    fn advance(&mut self, belief: &Belief<N>, row: &Row) -> Advanced<N> {
        let (x, torque) = (&belief.mean, self.places.len());
        let spreads: [f64; N] = std::array::from_fn(|n| spread(belief.covariance[n][n]));
        self.fill(x, &spreads);
        let applied = self.applied(x, &spreads, row);
        self.lanes.advance(&applied, self.period_s);
        let mut made = Advanced {
            next: *x,
            transition: [[0.0; N]; N],
            added: [[0.0; N]; N],
            columns: [[0.0; MECHANISMS]; N],
        };
        let mut bends = [[0.0; N]; N];
        for (r, place) in self.places.iter().enumerate() {
            let lanes = &self.lanes.state.x[*place];
            made.next[r] = lanes[0];
            for n in 0..=torque {
                (made.transition[r][n], bends[n][r]) = differences(lanes, n, spreads[n]);
            }
            for (j, lane) in self.lane.iter().enumerate().take(self.mechanisms.len()) {
                if *lane > 0 {
                    made.columns[r][j] = (lanes[*lane] - lanes[0]) / SMALL;
                }
            }
            for (k, (j, _)) in self.learned.iter().enumerate() {
                let by = (lanes[self.lane[*j]] - lanes[0]) / SMALL;
                made.transition[r][torque + 1 + k] = by;
                made.next[r] += by * x[torque + 1 + k];
            }
        }
        for bend in &bends[..=torque] {
            for r in 0..torque {
                (0..torque).for_each(|c| made.added[r][c] += bend[r] * bend[c]);
            }
        }
        let [left, _, added] = self.torque;
        made.next[torque] = left * x[torque];
        made.transition[torque][torque] = left;
        made.added[torque][torque] = added;
        for n in torque + 1..N {
            made.transition[n][n] = 1.0;
            made.added[n][n] = DRIFT * DRIFT;
        }
        made
    }

    fn set_fault(&mut self, mechanism: usize, size: f64) {
        self.faults = plus(Faults::NONE, self.entries[mechanism].number, size);
        self.set_motors();
    }

    fn walk_machine(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        walk.each(self.learned.iter_mut().map(|(_, change)| change))?;
        if walk.restores() {
            self.set_motors();
        }
        Ok(())
    }

    fn settle(&mut self, belief: &mut Belief<N>) {
        let first = N - self.learned.len();
        for (k, (_, change)) in self.learned.iter_mut().enumerate() {
            let by = std::mem::take(&mut belief.mean[first + k]);
            *change = (1.0 + *change) * (1.0 + by) - 1.0;
        }
        self.set_motors();
    }
}
