//! When the faults of a scenario change, and to what.

use drivescope_plant::fault::Faults;

use super::super::plan::{Plan, Scenario, ScenarioFault, stream_of_fault};
use crate::profile::Profile;

/// Samples at which the faults change, in ascending order, each with what acts from then on.
pub(super) fn timeline(plan: &Plan, scenario: &Scenario) -> Vec<(usize, Faults<f64>)> {
    let acting: Vec<(usize, &ScenarioFault)> =
        scenario.faults.iter().enumerate().filter_map(|(k, it)| Some((k, it.as_ref()?))).collect();
    if acting.is_empty() {
        return Vec::new();
    }
    let courses: Vec<(usize, Course)> = acting
        .iter()
        .map(|(k, fault)| (fault.mechanism, course(plan, scenario, *k, fault)))
        .collect();
    let mut places: Vec<usize> =
        courses.iter().flat_map(|(_, course)| course.iter().map(|(at, _)| *at)).collect();
    places.sort_unstable();
    places.dedup();
    let mut next = vec![0; courses.len()];
    let mut sizes = vec![0.0; courses.len()];
    let at = |place: usize| {
        let mut faults = Faults::NONE;
        for (c, (mechanism, course)) in courses.iter().enumerate() {
            while let Some((_, size)) = course.get(next[c]).filter(|(at, _)| *at <= place) {
                sizes[c] = *size;
                next[c] += 1;
            }
            if let Some(sum) = faults.size_mut(*mechanism) {
                *sum += sizes[c];
            }
        }
        (place, faults)
    };
    places.into_iter().filter(|place| *place < plan.samples).map(at).collect()
}

/// Where one fault changes, and its size from then on.
type Course = Vec<(usize, f64)>;

fn course(plan: &Plan, scenario: &Scenario, number: usize, fault: &ScenarioFault) -> Course {
    let span = fault.from..fault.until;
    if fault.profile == Profile::Step {
        return vec![(span.start, fault.size), (span.end, 0.0)];
    }
    let seed = stream_of_fault(plan.seed, scenario.index, number);
    let shares = fault.profile.shares(span.clone(), span.end, plan.experiment.period_s, seed);
    let mut course = Course::new();
    let mut before = 0.0;
    for (at, share) in shares.into_iter().enumerate().skip(span.start) {
        if share != before {
            course.push((at, fault.size * share));
            before = share;
        }
    }
    course.push((span.end, 0.0));
    course
}
