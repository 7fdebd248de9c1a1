//! The bank on the laboratory rig.

use drivescope_diagnoser::bank::{
    Calibration, Cause, Driving, Event, Judgement, LearnedNoise, Limits, Row,
};
use drivescope_diagnoser::{Memory, MemoryError, Walk, recall, remember};
use drivescope_plant::drive::Drive;

use crate::drives::built_in;
use crate::experiment::{Experiment, Stream};
use crate::faults::Fault;
use crate::native::closed_loop;
use crate::profile::Profile;
use crate::results::FaultName;
use drivescope_monitor::bank::{
    AnyProcess, AnyWatch, Columns, learn_noise, process, with_noise, without_current,
};

const BASELINE: usize = 1000;
const HORIZON: usize = 100;
/// Limits for 1e6 samples between false alarms, rounded up.
const LIMITS: Limits = Limits { ratio: 20.0, squares: 16.0 };

fn experiment() -> Experiment {
    let drive = built_in("dr300").expect("it is built in").expect("it is right");
    Experiment::new(drive, 3).expect("it is controlled")
}

fn rows(
    experiment: &Experiment,
    samples: usize,
    stream: Stream,
    fault: Option<&Fault>,
) -> Vec<Row> {
    let inputs = experiment.closed_loop(samples, stream, fault);
    let mut run = closed_loop(&experiment.drive, &inputs);
    run.signals.truncate(3);
    for (signal, unit) in run.signals.iter_mut().zip(["V", "rpm", "A"]) {
        unit.clone_into(&mut signal.unit);
    }
    Columns::of(&run).expect("they are there").1
}

fn dr300(experiment: &Experiment) -> Box<dyn AnyProcess> {
    process(&experiment.drive, experiment.period_s, &[]).expect("it fits")
}

#[test]
fn noise_is_learned_whatever_the_drive_file_says() {
    let experiment = experiment();
    let healthy: Vec<Vec<Row>> =
        (0..2).map(|k| rows(&experiment, 2000, Stream::Design(k), None)).collect();
    let mut wrong: Drive = experiment.drive.clone();
    wrong.noise.omega *= 4.0;
    wrong.noise.i *= 0.2;
    wrong.noise.torque *= 3.0;
    let found = learn_noise(&wrong, experiment.period_s, &healthy).expect("it fits");
    let LearnedNoise { omega, i, torque, torque_time } = found;
    let true_noise = experiment.drive.noise;
    for (found, exact, tolerance) in [
        (omega, true_noise.omega, 0.1),
        (i, true_noise.i, 0.1),
        (torque, true_noise.torque, 0.25),
        (torque_time, true_noise.torque_time, 0.5),
    ] {
        assert!((found / exact - 1.0).abs() < tolerance, "{found} for {exact}");
    }
    assert_eq!(with_noise(&wrong, &found).noise.torque, torque);
}

#[test]
fn limits_hold_on_machines_that_they_were_not_designed_on() {
    let experiment = experiment();
    let healthy = rows(&experiment, 2000, Stream::Design(0), None);
    let driving = Driving::of(healthy.iter(), experiment.period_s).expect("it is driven");
    let how =
        Calibration { driving, baseline: BASELINE, horizon: HORIZON, samples: 140_000, seed: 1 };
    let of = dr300(&experiment);
    let limits = of.calibrate(&how).expect("they are enough").limits(1e5);
    let found = of.verify(limits, &Calibration { seed: 2, ..how }).expect("they are learned");
    // At the designed rate 1.4 are expected; more than six would be one in a thousand.
    assert!(found.samples >= 140_000 && found.alarms <= 6, "{found:?}");
    assert!(found.arl_0_at_least() > 1e4);
    // Limits that are far too low are seen to be.
    let low = Limits { ratio: 0.6 * limits.ratio, ..limits };
    let found = of.verify(low, &Calibration { samples: 20_000, ..how }).expect("as before");
    assert!(found.alarms > 3, "{found:?}");
}

/// The judgement about a fault from sample 1500 on.
fn judged(rows: &[Row], of: &dyn AnyProcess) -> Judgement {
    let (baseline, rest) = rows.split_at(BASELINE);
    let mut watch = of.learn(baseline, LIMITS, HORIZON).expect("it is healthy");
    let judged = rest.iter().find_map(|row| match watch.step(row)? {
        Event::Judged(judgement) => Some(judgement),
        _ => None,
    });
    judged.expect("it is seen")
}

#[test]
fn faults_that_were_never_shown_are_named_and_without_the_current_are_in_a_set() {
    let experiment = experiment();
    let of = dr300(&experiment);
    let id = |j: usize| of.mechanisms()[j].id.clone();
    for (kind, size) in [("tacho", 0.05), ("flux", -0.1), ("load", 0.2), ("resistance", 0.2)] {
        let name = FaultName { kind: kind.to_owned(), size, label: String::new() };
        let fault = Fault { name, from: 1500, until: 3000, profile: Profile::Step };
        let rows = rows(&experiment, 2000, Stream::Faulty(0), Some(&fault));
        let found = judged(&rows, of.as_ref());
        let Cause::Mechanism(named) = found.cause else { panic!("{kind}: {found:?}") };
        let set: Vec<String> =
            found.candidates[..found.confused].iter().map(|it| id(it.mechanism)).collect();
        assert!(set.contains(&kind.to_owned()), "{kind}: {} of {set:?}", id(named));
        let same = found.candidates.iter().find(|it| id(it.mechanism) == kind);
        let size_found = same.expect("it is a candidate");
        assert!((size_found.size - size).abs() < 4.0 * size_found.sd, "{kind}: {size_found:?}");
        assert!(found.onset.abs_diff(500) <= 3, "{kind}: {}", found.onset);
        let blind = judged(&without_current(&rows), of.as_ref());
        assert!(blind.confused >= found.confused, "{kind}: {blind:?}");
    }
}

/// A watch whose memory is saved and restored.
struct Remembered(Box<dyn AnyWatch>);

impl Memory for Remembered {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        self.0.walk(walk)
    }
}

#[test]
fn a_watch_goes_on_from_its_memory_bit_by_bit() {
    let experiment = experiment();
    let of = dr300(&experiment);
    let name = FaultName { kind: "flux".to_owned(), size: -0.1, label: String::new() };
    let fault = Fault { name, from: 1500, until: 2000, profile: Profile::Step };
    let rows = rows(&experiment, 2600, Stream::Faulty(0), Some(&fault));
    let (baseline, rest) = rows.split_at(BASELINE);
    let mut watch = Remembered(of.learn(baseline, LIMITS, HORIZON).expect("it is healthy"));
    // Watching, an alarm being judged, the named fault acting, and after its end.
    let mut others: Vec<Remembered> = Vec::new();
    let mut events = 0;
    for (k, row) in rest.iter().enumerate() {
        if [40, 503, 560, 700, 1003, 1300].contains(&k) {
            let bytes = remember(&mut watch);
            let mut other = Remembered(of.unlearned(LIMITS, HORIZON));
            recall(&mut other, &bytes).expect("they are its own");
            assert_eq!(remember(&mut other), bytes);
            others.push(other);
            let mut broken = Remembered(of.unlearned(LIMITS, HORIZON));
            assert!(recall(&mut broken, &bytes[1..]).is_err());
        }
        let event = watch.0.step(row);
        events += usize::from(event.is_some());
        for other in &mut others {
            assert_eq!(other.0.step(row), event, "sample {k}");
            assert_eq!(other.0.statistics(), watch.0.statistics(), "sample {k}");
        }
    }
    assert!(events >= 3 && others.len() == 6, "{events}");
}
