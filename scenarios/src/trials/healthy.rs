//! False alarms on healthy machines at other set points, through steps, ramps and reversals.

use drivescope_diagnoser::bank::Row;
use serde::Serialize;

use super::ARL_0;
use super::bench::{Bench, NEVER, with_or_without};
use super::course::{Course, WATCHED};
use super::machine::{Group, Plan};

/// Samples without an exceedance after which the next is another alarm.
const APART: usize = 400;

/// Alarms along one course.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HealthyRow {
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
