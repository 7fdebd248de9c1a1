//! False alarms on healthy machines at other set points, through steps, ramps and reversals.

use std::f64::consts::PI;

use drivescope_diagnoser::bank::Row;
use rand::RngExt;
use serde::Serialize;

use super::ARL_0;
use super::bench::{Bench, Group, Machine, NEVER, Plan, with_or_without};

/// Samples that a machine is watched over.
pub(super) const WATCHED: usize = 20_000;
/// Samples without an exceedance after which the next is another alarm.
const APART: usize = 400;
/// Greatest speed, as a share of the set point that was shown.
const GREATEST: f64 = 1.5;
/// Time between steps, s, and periods of reversals, s.
const STEP_S: (f64, f64) = (0.5, 3.0);
const PERIOD_S: (f64, f64) = (2.0, 20.0);
/// Least set point, as a share of that shown.
const LEAST: f64 = 0.2;

/// What a healthy machine follows after its baseline.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Course {
    /// One of other set points.
    SetPoint,
    /// Steps between random speeds of one sign.
    Steps,
    /// Sines through rest.
    Reversals,
    /// Steps between random speeds of either sign.
    SteppedReversals,
}

impl Course {
    /// All of them.
    pub const ALL: [Self; 4] =
        [Self::SetPoint, Self::Steps, Self::Reversals, Self::SteppedReversals];
}

/// Alarms along one course.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HealthyRow {
    /// The course.
    pub course: Course,
    /// Healthy samples.
    pub samples: usize,
    /// Alarms at each of the designed times between them.
    pub alarms: [usize; ARL_0.len()],
    /// The same without the current.
    pub alarms_without_current: [usize; ARL_0.len()],
}

/// All courses.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Healthy {
    /// Designed mean samples between false alarms.
    pub arl_0: [f64; ARL_0.len()],
    /// Each course.
    pub rows: Vec<HealthyRow>,
    /// Machines that their own baselines refused, of all.
    pub refused: usize,
    /// Machines.
    pub machines: usize,
}

pub(super) fn healthy(bench: &Bench, samples: usize) -> Healthy {
    let machines = samples.div_ceil(WATCHED).max(Course::ALL.len());
    let counts = bench.each(Group::Healthy, machines, |machine, number| {
        let course = Course::ALL[number % Course::ALL.len()];
        let reference = course.reference(bench, machine);
        let runs = machine.rows(&[Plan { reference, faults: Vec::new() }]);
        [true, false].map(|with_current| alarms(bench, with_current, &runs[0]))
    });
    let row = |(number, course): (usize, &Course)| {
        let of: Vec<_> = counts.iter().skip(number).step_by(Course::ALL.len()).collect();
        let sum = |which: usize| {
            let mut sum = [0; ARL_0.len()];
            for counted in of.iter().filter_map(|both| both[which]) {
                sum.iter_mut().zip(counted).for_each(|(sum, alarms)| *sum += alarms);
            }
            sum
        };
        HealthyRow {
            course: *course,
            samples: WATCHED * of.iter().filter(|both| both[0].is_some()).count(),
            alarms: sum(0),
            alarms_without_current: sum(1),
        }
    };
    Healthy {
        arl_0: ARL_0,
        rows: Course::ALL.iter().enumerate().map(row).collect(),
        refused: counts.iter().flatten().filter(|alarms| alarms.is_none()).count(),
        machines: 2 * machines,
    }
}

/// False alarms of that many machines at the set point that was shown.
pub(super) fn held(bench: &Bench, machines: usize) -> HealthyRow {
    let counts = bench.each(Group::Curves, machines, |machine, _| {
        let reference = vec![machine.experiment.set_point; bench.designed.how.baseline + WATCHED];
        let runs = machine.rows(&[Plan { reference, faults: Vec::new() }]);
        [true, false].map(|with_current| alarms(bench, with_current, &runs[0]))
    });
    let sum = |which: usize| {
        let mut sum = [0; ARL_0.len()];
        for counted in counts.iter().filter_map(|both| both[which]) {
            sum.iter_mut().zip(counted).for_each(|(sum, alarms)| *sum += alarms);
        }
        sum
    };
    HealthyRow {
        course: Course::SetPoint,
        samples: WATCHED * counts.iter().filter(|both| both[0].is_some()).count(),
        alarms: sum(0),
        alarms_without_current: sum(1),
    }
}

/// Alarms at each limit; nothing where the baseline is refused.
fn alarms(bench: &Bench, with_current: bool, rows: &[Row]) -> Option<[usize; ARL_0.len()]> {
    let tails = bench.tails(with_current);
    let limits = ARL_0.map(|arl_0| tails.limits(arl_0));
    let rows = with_or_without(rows, with_current);
    let (mut watch, rest) = bench.watch(bench.designed.process.as_ref(), NEVER, &rows)?;
    let (mut alarms, mut last) = ([0; ARL_0.len()], [None; ARL_0.len()]);
    for (at, row) in rest.iter().enumerate() {
        watch.step(row);
        let found = watch.statistics();
        for (k, limits) in limits.iter().enumerate() {
            if found.ratio > limits.ratio || found.squares > limits.squares {
                if last[k].is_none_or(|last| at > last + APART) {
                    alarms[k] += 1;
                }
                last[k] = Some(at);
            }
        }
    }
    Some(alarms)
}

impl Course {
    /// Speeds of a baseline at the set point that was shown, and of the course after it.
    pub(super) fn reference(self, bench: &Bench, machine: &mut Machine) -> Vec<f64> {
        self.speeds(machine.experiment.set_point, bench.designed.how.baseline, machine)
    }

    /// The same for a set point and a baseline of that many samples.
    pub(super) fn speeds(self, shown: f64, baseline: usize, machine: &mut Machine) -> Vec<f64> {
        let period_s = machine.experiment.period_s;
        let greatest = GREATEST * shown;
        let random = &mut machine.random;
        let mut made = vec![shown; baseline];
        let (held, amplitude): (f64, f64) =
            (random.random_range(LEAST..GREATEST), random.random_range(LEAST..GREATEST));
        let turn_s = random.random_range(PERIOD_S.0..PERIOD_S.1);
        let (mut level, mut left) = (0.0, 0);
        for k in 0..WATCHED {
            made.push(match self {
                Self::SetPoint => held * shown,
                Self::Reversals => {
                    let t = k as f64 * period_s;
                    amplitude * shown * (2.0 * PI * t / turn_s).cos()
                }
                Self::Steps | Self::SteppedReversals => {
                    if left == 0 {
                        left = (random.random_range(STEP_S.0..STEP_S.1) / period_s) as usize;
                        let least = if self == Self::Steps { LEAST * shown } else { -greatest };
                        level = random.random_range(least..greatest);
                    }
                    left -= 1;
                    level
                }
            });
        }
        made
    }
}
