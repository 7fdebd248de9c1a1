//! A study made up for tests: twelve faults with the shape of real ones, the paper's figures, and
//! names that try to leave their place.

use drivescope_scenarios::results::*;

use crate::report::plot::Point;

/// A name that a report must not take as markup.
pub(crate) const HOSTILE: &str = "DR300 <script>alert(1)</script> & \"co\" http://example.org/x";

/// Samples of a run.
const SAMPLES: usize = 6000;
/// Sd of the healthy residual.
const SD: f64 = 5.8;

/// A fault and the paper's figures: S of its Table 3, then r_td in per cent and t_dt of its Table 1,
/// for model error modelling and for constant thresholds.
struct Known {
    kind: &'static str,
    size: f64,
    label: &'static str,
    s: f64,
    mem: (f64, usize),
    constant: (f64, usize),
}

const fn known(
    (kind, size, label): (&'static str, f64, &'static str),
    s: f64,
    mem: (f64, usize),
    constant: (f64, usize),
) -> Known {
    Known { kind, size, label, s, mem, constant }
}

const FAULTS: [Known; 12] = [
    known(("tacho", 0.05, "f_1^1"), 2.45, (97.9, 4074), (98.1, 4072)),
    known(("tacho", -0.05, "f_2^1"), 3.32, (99.6, 4055), (99.4, 4067)),
    known(("tacho", 0.1, "f_3^1"), 5.34, (98.8, 4077), (98.8, 4064)),
    known(("tacho", -0.1, "f_4^1"), 6.19, (99.7, 4053), (99.4, 3147)),
    known(("tacho", 0.2, "f_5^1"), 10.9, (99.6, 4058), (98.9, 4063)),
    known(("tacho", -0.2, "f_6^1"), 11.64, (99.5, 4075), (100.0, 4018)),
    known(("flux", 0.2, "f_1^2"), 17.39, (99.2, 4058), (99.5, 4056)),
    known(("flux", -0.2, "f_2^2"), 8.27, (99.3, 4100), (99.7, 4059)),
    known(("flux", 0.1, "f_3^2"), 8.61, (99.2, 4060), (99.3, 4057)),
    known(("flux", -0.1, "f_4^2"), 8.65, (98.8, 4061), (99.1, 4059)),
    known(("flux", 0.05, "f_5^2"), 2.28, (99.1, 4060), (99.9, 3726)),
    known(("flux", -0.05, "f_6^2"), 1.73, (81.0, 4357), (98.4, 3132)),
];

fn names() -> impl Iterator<Item = FaultName> {
    FAULTS.iter().map(|f| FaultName { kind: f.kind.into(), size: f.size, label: f.label.into() })
}

/// Results as a study gives them; fmpy was not run.
pub(crate) fn study() -> StudyResults {
    let row = |(k, fault): (usize, FaultName), method: DetectorKind| {
        let late = if method == DetectorKind::Mem { 0 } else { 3 };
        let delay = 51 + (k * 5) % 9 + late;
        DetectionRow {
            fault,
            method,
            r_td: 0.999 - 0.001 * (k % 4) as f64 - 0.002 * late as f64,
            t_dt: Some(4000 + delay),
            delay: Some(delay),
            false_alarms: 0,
        }
    };
    let detection: Vec<DetectionRow> = DetectorKind::ALL
        .into_iter()
        .flat_map(|method| names().enumerate().map(move |fault| row(fault, method)))
        .collect();
    let readings = TorqueReading::ALL
        .into_iter()
        .map(|torque| ReadingRows { torque, detection: detection.clone() })
        .collect();
    let identification = FAULTS
        .iter()
        .zip(names())
        .map(|(f, fault)| IdentificationRow {
            s: 180.0 * f.size.abs(),
            s_paper: f.s,
            fault,
            group: SizeGroup::Small,
            group_paper: SizeGroup::Medium,
        })
        .collect();
    let paper = FAULTS.iter().flat_map(|f| {
        [(DetectorKind::Mem, f.mem), (DetectorKind::Constant, f.constant)].map(
            |(method, (r_td, t_dt))| PaperRow {
                label: f.label.into(),
                method,
                r_td: r_td / 100.0,
                t_dt,
            },
        )
    });
    StudyResults {
        hidden_effect: None,
        seed: 7,
        drive: DriveSummary {
            name: HOSTILE.into(),
            digest: "9f3c0d5e7a61".into(),
            set_point: 2000.0,
            tacho_unit: "rpm".into(),
            period_s: 0.005,
        },
        noise: NoiseSummary {
            reference: 2.094,
            omega: 0.314,
            i: 0.01,
            torque: 1e-3,
            torque_time: 0.05,
        },
        torque: TorqueReading::Flux,
        beta: 0.05,
        fault_span: FaultSpan { from: 4000, to: 5000 },
        profile: "step".to_owned(),
        window: 50,
        detection: detection.clone(),
        readings,
        further: Vec::new(),
        healthy: HealthySummary {
            samples: 90_000,
            runs: 16,
            run_up: 375,
            alarms: ByDetector::from_fn(|_| 0),
        },
        r_fd: ByDetector::from_fn(|kind| match kind {
            DetectorKind::Mem => 0.0502,
            DetectorKind::MemRecurrent => 0.051,
            DetectorKind::Constant => 0.0493,
            _ => 0.0,
        }),
        model: ModelSummary {
            process_model: "ARX (n_a = 4, n_b = 4), free run from C_m".into(),
            training_samples: 3000,
            training_sd: 21.4,
            residual_sd: 6.03,
            residual_mean: -0.21,
            n_a: 20,
            n_b: 20,
            error_model_sse: 31.2,
            error_model_samples: 3000,
            v: SD,
            whiteness_p: 0.0,
            normality_p: 0.31,
            design_samples: 200_000,
            constant: (-12.0, 11.6),
            recurrent_error: Some(RecurrentErrorSummary {
                v1: 2,
                v2: 1,
                order: 1,
                v: SD,
                whiteness_p: 0.0,
                normality_p: 0.2,
            }),
            gmdh: Some(GmdhSummary {
                layers: vec![31.0, 29.0, 28.9],
                kept: 2,
                neurons: 3,
                validation: 27.5,
                noise: [-24.0, 24.0],
                vertices: 1500,
            }),
        },
        levels: vec![LevelRows {
            beta: 0.01,
            r_fd: ByDetector::from_fn(|_| 0.0101),
            alarms: ByDetector::from_fn(|_| 0),
            detection,
            readings: Vec::new(),
        }],
        structures: [(1, 1, 1), (3, 6, 1)].map(structure).into(),
        theorem: TheoremSummary {
            epsilon: 0.05,
            horizon: 200,
            rows: vec![TheoremRow { v1: 5, v2: 1, order: 2, max_error: 0.04 }],
        },
        symptoms: names().enumerate().map(|(k, fault)| cloud(k, fault)).collect(),
        separability: SeparabilitySummary {
            limit: 0.1,
            draws: 20,
            merges: vec![Merge { faults: ["tacho +5 %".into(), "flux -5 %".into()], draws: 3 }],
            explained: 0.99,
            confusion: vec![vec![0.0; 12]; 12],
            classes: names().map(|name| vec![name.shown()]).collect(),
            classes_paper: vec![vec!["tacho +5 %".into(), "flux -5 %".into()]],
            merged_only_here: Vec::new(),
            merged_only_in_paper: vec![["tacho +5 %".into(), "flux -5 %".into()]],
        },
        isolation: isolation(12),
        isolation_paper: isolation(10),
        isolation_merged: isolation(12),
        identification,
        fmu: FmuSummary { max_relative_difference_native: 0.0, fmpy: Vec::new() },
        paper: PaperFigures {
            detection: paper.collect(),
            r_fd: PaperRates { mem: 0.012, constant: 0.098 },
            arx_sse: 0.0117,
            isolation: answers(10),
        },
    }
}

fn structure((v1, v2, order): (usize, usize, usize)) -> StructureSummary {
    StructureSummary {
        v1,
        v2,
        order,
        parameters: 48,
        effective_parameters: 16,
        aic: -5000.0 - v1 as f64,
        validation: 21.0,
        healthy: 6.0,
        paper: v1 == 3,
        best: v1 == 1,
        used: v1 == 1,
    }
}

fn cloud(k: usize, fault: FaultName) -> SymptomPoints {
    let point = |i: usize| [5.0 + 0.1 * k as f64 + 0.01 * i as f64, 40.0 * k as f64 - i as f64];
    SymptomPoints { fault, points: (0..20).map(point).collect() }
}

/// Shares of a classifier that is right but for a tenth.
fn answers(classes: usize) -> Vec<Vec<f64>> {
    let row = |fault: usize| {
        let mut row = vec![0.0; classes];
        row[fault % classes] = 0.9;
        row[(fault + 1) % classes] += 0.1;
        row
    };
    (0..12).map(row).collect()
}

fn isolation(classes: usize) -> IsolationTable {
    let mut matrix = answers(classes);
    matrix.iter_mut().for_each(|row| row.push(0.0));
    IsolationTable {
        classes: (0..classes).map(|class| format!("class {class}")).collect(),
        faults: names().map(|name| name.shown()).collect(),
        matrix,
        class_of: (0..12).map(|fault| fault % classes).collect(),
        discriminant: vec![0.9; 12],
    }
}

/// A run of each fault, then a healthy one.
pub(crate) fn pictures() -> Vec<Pictures> {
    names().map(Some).chain([None]).enumerate().map(|(k, fault)| picture(k, fault)).collect()
}

fn picture(run: usize, fault: Option<FaultName>) -> Pictures {
    let mut noise = Noise(run as u64 + 1);
    let size = fault.as_ref().map_or(0.0, |f| if f.kind == "tacho" { f.size } else { -f.size });
    let (mut error, mut level) = (0.0, 0.0);
    let points: Vec<(Point, Point, f64)> = (0..SAMPLES)
        .map(|k| {
            error = 0.9 * error + 0.8 * noise.next();
            let acts = (4000..5000).contains(&k);
            level += 0.08 * (if acts { 2000.0 * size } else { 0.0 } - level);
            let residual = error + 5.0 * noise.next() + level;
            let tacho = ((2000.0 + 4.0 * noise.next()) / 2.0).round() * 2.0;
            ((tacho, residual), (error - 1.96 * SD, error + 1.96 * SD), 5.3 - level / 400.0)
        })
        .collect();
    Pictures {
        declared: fault.as_ref().map(|_| 4051 + run),
        fault,
        c_m: points.iter().map(|p| p.2 + 0.06 * noise.next()).collect(),
        t: points.iter().map(|p| p.0.0).collect(),
        residual: points.iter().map(|p| p.0.1).collect(),
        lower: points.iter().map(|p| p.1.0).collect(),
        upper: points.iter().map(|p| p.1.1).collect(),
    }
}

/// About normal: a sum of twelve uniform numbers from a linear congruential generator.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        let mut uniform = || {
            self.0 = self
                .0
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    }
}
