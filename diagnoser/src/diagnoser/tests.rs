//! The whole chain on a motor of its own: trained open loop, designed and judged closed loop.

use std::sync::{Arc, LazyLock};

use drivescope_recording::Signal;

use super::*;
use crate::arx::{Arx, Orders};
use crate::data::data;
use crate::design::{Design, DesignError, DesignReport, ErrorModel};
use crate::file::FileError;
use crate::flaw::Flaw;
use crate::interface::Channel;
use crate::network::{Structure, Trained, Training, train};
use crate::testing::{PERIOD, Run, closed_loop, multisine};

const SAMPLES: usize = 5000;
const ONSET: usize = 4000;
const RUN_UP: usize = 500;
/// Samples that the width is measured on. The load torque leaves some 50 independent values in
/// 3000 samples, so that a width from them would be 10 % off.
const DESIGN_SAMPLES: usize = 40_000;
/// For the same reason the exceedance rate of one run of 3500 samples scatters by 0.02, and
/// the mean of eight by 0.007; the width adds 0.004.
const RATE_SPREAD: f64 = 0.016;

fn interface() -> Interface {
    Interface {
        period_s: PERIOD,
        inputs: vec![Channel::new("C_m", "V")],
        output: Channel::new("T", "rpm"),
    }
}

fn recording(run: &Run) -> Recording {
    let signal = |name: &str, unit: &str, values: &[f64]| Signal {
        name: name.into(),
        unit: unit.into(),
        values: values.to_vec(),
    };
    let signals = vec![signal("C_m", "V", &run.control), signal("T", "rpm", &run.speed)];
    Recording::new("motor", 0.0, PERIOD, signals)
}

fn process_model() -> &'static Trained {
    static TRAINED: LazyLock<Trained> = LazyLock::new(|| {
        let (estimation, validation) = (multisine(1000, 1), multisine(1000, 2));
        let training = Training { starts: 4, seed: 1, ..Training::default() };
        train(Structure::PAPER, &data(&estimation), &data(&validation), &training).unwrap()
    });
    &TRAINED
}

fn design(how: &Design) -> Result<(Diagnoser, DesignReport), DesignError> {
    let (healthy, widths) = (
        closed_loop(RUN_UP + 3000, 11, usize::MAX, 0.0),
        closed_loop(RUN_UP + DESIGN_SAMPLES, 12, usize::MAX, 0.0),
    );
    let model = Model::Network(Arc::clone(&process_model().network));
    Diagnoser::design(interface(), model, &data(&healthy), &data(&widths), how)
}

fn designed() -> &'static (Diagnoser, DesignReport) {
    static DESIGNED: LazyLock<(Diagnoser, DesignReport)> =
        LazyLock::new(|| design(&Design::paper(Confidence::new(0.05).unwrap())).unwrap());
    &DESIGNED
}

fn diagnosed(seed: u64, fault: f64, kind: DetectorKind) -> Trace {
    let run = closed_loop(SAMPLES, seed, ONSET, fault);
    designed().0.diagnose(&recording(&run), kind).unwrap()
}

#[test]
fn a_five_per_cent_fault_leaves_the_bands_and_health_does_not() {
    for (seed, fault) in [(21, 0.05), (22, -0.05), (23, 0.2)] {
        let trace = diagnosed(seed, fault, DetectorKind::Mem);
        let r_td = trace.exceedance_rate(ONSET..SAMPLES).unwrap();
        assert!(r_td > 0.98, "fault {fault}: r_td {r_td}");
        let t_dt = trace.declarations()[0];
        assert!((ONSET + 50..=ONSET + 60).contains(&t_dt), "fault {fault}: t_dt {t_dt}");
    }
}

#[test]
fn health_exceeds_as_often_as_designed_whatever_the_span_is_called() {
    // Labels shuffled: the "fault's" span of a run without a fault yields beta, not r_td.
    let (mut r_td, mut r_fd) = (0.0, 0.0);
    for seed in 31..39 {
        let trace = diagnosed(seed, 0.0, DetectorKind::Mem);
        r_td += trace.exceedance_rate(ONSET..SAMPLES).unwrap() / 8.0;
        r_fd += trace.exceedance_rate(RUN_UP..ONSET).unwrap() / 8.0;
        assert!(trace.declarations().is_empty(), "seed {seed}");
    }
    assert!((r_fd - 0.05).abs() < RATE_SPREAD, "r_fd {r_fd}");
    assert!((r_td - 0.05).abs() < 2.0 * RATE_SPREAD, "r_td {r_td}");
}

#[test]
fn a_band_around_nothing_alarms_always_and_its_r_fd_says_so() {
    let mut broken = designed().0.clone();
    broken.model_error.deviation = 1e-9;
    let run = closed_loop(SAMPLES, 25, ONSET, 0.05);
    let trace = broken.diagnose(&recording(&run), DetectorKind::Mem).unwrap();
    assert!(trace.exceedance_rate(ONSET..SAMPLES).unwrap() > 0.999);
    assert!(trace.exceedance_rate(RUN_UP..ONSET).unwrap() > 0.999);
    assert!(trace.declarations()[0] < ONSET);
}

#[test]
fn bands_stand_about_the_middle_of_the_design_data() {
    // An error model that was fitted where the sensor showed 4 rpm less: two thirds of v.
    let (mut shifted, widths) = (
        closed_loop(RUN_UP + 3000, 11, usize::MAX, 0.0),
        closed_loop(RUN_UP + DESIGN_SAMPLES, 12, usize::MAX, 0.0),
    );
    shifted.speed.iter_mut().for_each(|speed| *speed -= 4.0);
    let network = Structure { v1: 1, v2: 1, ..Structure::PAPER };
    let training = Training { starts: 2, seed: 3, ..Training::default() };
    for error_model in [
        ErrorModel::Arx(Orders { n_a: 20, n_b: 20, constant: true }),
        ErrorModel::Network(network, training),
    ] {
        let how = Design { error_model, ..Design::paper(Confidence::new(0.05).unwrap()) };
        let model = Model::Network(Arc::clone(&process_model().network));
        let designed = Diagnoser::design(interface(), model, &data(&shifted), &data(&widths), &how);
        let (diagnoser, report) = designed.unwrap();
        assert!((report.bands.mean - 4.0).abs() < 1.5, "{report:?}");
        let mut detector = diagnoser.detector(DetectorKind::Mem).unwrap();
        let verdicts = detector.run(&data(&widths)).unwrap().verdicts;
        let off = |v: &crate::Verdict| v.residual - 0.5 * (v.lower + v.upper);
        let mean = verdicts[RUN_UP..].iter().map(off).sum::<f64>() / DESIGN_SAMPLES as f64;
        // What the start from another constant leaves of its transient.
        assert!(mean.abs() < 0.01 * report.bands.deviation, "{mean}");
    }
}

#[test]
fn a_one_step_prediction_would_absorb_the_fault() {
    let diagnoser = &designed().0;
    let Model::Arx(error_model) = &diagnoser.model_error.model else { panic!("an ARX") };
    let run = closed_loop(SAMPLES, 26, ONSET, 0.05);
    let residual =
        crate::signal_model::residual(&mut diagnoser.model.run(), &data(&run), crate::Start::Rest);
    let measured = data(&run);
    let predicted = error_model.one_step(&measured.with_output("r", &residual).unwrap());
    let remainder: Vec<f64> = residual.iter().zip(&predicted).map(|(r, p)| r - p).collect();
    let (_, deviation) = crate::threshold::mean_and_deviation(&remainder[RUN_UP..ONSET]);
    let outside = remainder[ONSET..].iter().filter(|e| e.abs() > 1.96 * deviation).count();
    let free_run = diagnosed(26, 0.05, DetectorKind::Mem);
    let r_td = free_run.exceedance_rate(ONSET..SAMPLES).unwrap();
    let absorbed = outside as f64 / (SAMPLES - ONSET) as f64;
    assert!(r_td > 0.99 && absorbed < 0.95, "one step {absorbed}, free run {r_td}");
}

#[test]
fn constant_thresholds_hold_their_level_on_health() {
    let trace = diagnosed(27, 0.1, DetectorKind::Constant);
    let r_fd = trace.exceedance_rate(RUN_UP..ONSET).unwrap();
    assert!(r_fd < 0.05 + 4.0 * RATE_SPREAD, "{r_fd}");
    assert!(trace.exceedance_rate(ONSET..SAMPLES).unwrap() > 0.98);
}

#[test]
fn orders_by_aic_and_a_recurrent_error_model_serve_as_well() {
    let confidence = Confidence::new(0.05).unwrap();
    let widest = Orders { n_a: 8, n_b: 8, constant: true };
    let small = Structure { v1: 1, v2: 1, ..Structure::PAPER };
    let training = Training { starts: 2, seed: 3, ..Training::default() };
    for error_model in [ErrorModel::ArxUpTo(widest), ErrorModel::Network(small, training)] {
        let how = Design { error_model, ..Design::paper(confidence) };
        let (diagnoser, report) = design(&how).unwrap();
        assert!(report.bands.deviation < 1.2 * designed().1.bands.deviation, "{report:?}");
        let run = closed_loop(SAMPLES, 28, ONSET, -0.05);
        let trace = diagnoser.diagnose(&recording(&run), DetectorKind::Mem).unwrap();
        let r_td = trace.exceedance_rate(ONSET..SAMPLES).unwrap();
        let r_fd = trace.exceedance_rate(RUN_UP..ONSET).unwrap();
        assert!(r_td > 0.95, "{r_td}");
        assert!(r_fd < 0.05 + 4.0 * RATE_SPREAD, "{r_fd}");
    }
}

#[test]
fn a_saved_diagnoser_gives_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("motor.toml");
    let (diagnoser, _) = designed();
    diagnoser.save(&path).unwrap();
    let loaded = Diagnoser::load(&path).unwrap();
    assert_eq!(&loaded, diagnoser);
    let run = recording(&closed_loop(1000, 29, 800, 0.05));
    for kind in [DetectorKind::Mem, DetectorKind::Constant] {
        assert_eq!(loaded.diagnose(&run, kind), diagnoser.diagnose(&run, kind));
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "a temporary file stayed");
}

#[test]
fn a_file_of_the_first_version_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("motor.toml");
    let diagnoser = designed().0.clone();
    Diagnoser { schema: 1, ..diagnoser.clone() }.save(&path).unwrap();
    assert!(std::fs::read_to_string(&path).unwrap().starts_with("schema = 1\n"));
    assert_eq!(Diagnoser::load(&path).unwrap(), diagnoser);
}

#[test]
fn a_file_that_cannot_run_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("motor.toml");
    let refused = |change: &dyn Fn(&mut Diagnoser)| {
        let mut diagnoser = designed().0.clone();
        change(&mut diagnoser);
        diagnoser.save(&path).unwrap();
        Diagnoser::load(&path).unwrap_err()
    };
    let unstable = |arx: &mut Model| {
        *arx = Model::Arx(Arc::new(Arx { a: vec![-1.5], b: vec![vec![1.0]], constant: 0.0 }));
    };
    let error = refused(&|d| unstable(&mut d.model));
    assert!(
        matches!(error, FileError::Flaw { flaw: Flaw::Unstable { which: "process model" }, .. }),
        "{error}"
    );
    let error = refused(&|d| unstable(&mut d.model_error.model));
    assert!(
        matches!(error, FileError::Flaw { flaw: Flaw::Unstable { which: "error model" }, .. }),
        "{error}"
    );
    let error = refused(&|d| d.interface.inputs.push(Channel::new("I_m", "A")));
    assert!(
        matches!(error, FileError::Flaw { flaw: Flaw::Shape { inputs: 2, .. }, .. }),
        "{error}"
    );
    let error = refused(&|d| d.schema = 4);
    assert!(matches!(error, FileError::Schema { found: 4, .. }), "{error}");
    let error = refused(&|d| d.model_error.deviation = -1.0);
    assert!(error.to_string().contains("model_error.deviation = -1 must be positive"));
    std::fs::write(&path, "schema = 1\nrun_up = \"long\"\n").unwrap();
    let error = Diagnoser::load(&path).unwrap_err().to_string();
    assert!(error.contains("line 2"), "{error}");
    let missing = folder.path().join("none.toml");
    assert!(matches!(Diagnoser::load(&missing), Err(FileError::Read { .. })));
    let nowhere = folder.path().join("no/such/folder.toml");
    assert!(matches!(designed().0.save(&nowhere), Err(FileError::Write { .. })));
}

#[test]
fn other_signals_are_refused() {
    let run = closed_loop(100, 30, usize::MAX, 0.0);
    let mut renamed = recording(&run);
    renamed.signals[0].name = "u".into();
    let diagnoser = &designed().0;
    let kind = DetectorKind::Mem;
    let refusal = diagnoser.diagnose(&renamed, kind).unwrap_err();
    assert!(matches!(
        refusal,
        DiagnosisError::Interface(InterfaceError::MissingSignal { ref name, .. }) if name == "C_m"
    ));
    let slow = Recording { period_s: 0.01, ..recording(&run) };
    let refusal = diagnoser.diagnose(&slow, kind).unwrap_err();
    assert!(matches!(refusal, DiagnosisError::Interface(InterfaceError::Period { .. })));
}

#[test]
fn too_little_healthy_data_is_refused() {
    let run = closed_loop(RUN_UP + 50, 31, usize::MAX, 0.0);
    let model = Model::Network(Arc::clone(&process_model().network));
    let how = Design::paper(Confidence::new(0.05).unwrap());
    let refusal = Diagnoser::design(interface(), model, &data(&run), &data(&run), &how);
    let message = refusal.unwrap_err().to_string();
    assert!(message.contains("ARX(20,20)") && message.contains("there are 50"), "{message}");
}
