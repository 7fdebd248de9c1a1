//! Learning faults from recordings of them, labelled by who made them.
//!
//! The symptoms that are learned are those that will be answered to: the samples at which model
//! error modelling has the fault declared. Half of them (of several recordings of a fault the last)
//! is held out: it picks the best start of the classifier and yields the rates that are reported.
//! Faults whose symptoms cannot be told apart share a class.

use std::sync::Arc;

use thiserror::Error;

use super::isolator::{IsolationMatrix, IsolationReport, Isolator};
use super::known::KnownFaults;
use super::options::{IsolationError, IsolatorOptions};
use super::separability::Separability;
use super::symptoms::{FaultSymptoms, SymptomError, Symptoms};
use crate::data::Data;
use crate::detector::DetectorError;
use crate::detectors::DetectorKind;
use crate::diagnoser::Diagnoser;
use crate::identification::thresholds_off;

/// Symptoms of a fault that are learned and that are held out, at most: the paper's number.
const SYMPTOMS: usize = 100;
/// Samples at which a fault must stand declared in a recording: two halves of 20.
const LEAST: usize = 40;

/// A recording of a fault.
#[derive(Debug, Clone)]
pub struct FaultyRun<'a> {
    /// Name of the fault; several recordings may have the same.
    pub fault: &'a str,
    /// Name of the recording, for messages.
    pub recording: &'a str,
    /// Its signals.
    pub data: Data<'a>,
}

/// What was found while learning faults.
#[derive(Debug, Clone, PartialEq)]
pub struct FaultsReport {
    /// Which faults can be told apart.
    pub separability: Separability,
    /// The training of the classifier.
    pub training: IsolationReport,
    /// Its answers to symptoms held out.
    pub held_out: IsolationMatrix,
}

/// Why faults cannot be learned.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum FaultsError {
    /// Too few symptoms.
    #[error(
        "{recording}: fault {fault} stands declared at {samples} samples, at least {LEAST} are needed: give a longer recording of it, or a larger fault"
    )]
    Unseen {
        fault: String,
        recording: String,
        /// Samples at which it stands declared.
        samples: usize,
    },
    /// A recording does not suit.
    #[error("{recording}: {source}")]
    Detector {
        recording: String,
        /// Why it cannot be watched.
        source: DetectorError,
    },
    /// The symptoms do not serve.
    #[error(transparent)]
    Symptoms(#[from] SymptomError),
    /// The classifier cannot be trained.
    #[error(transparent)]
    Isolation(#[from] IsolationError),
}

/// What is gathered of one fault: symptoms of every recording, and the sum of |r| / T.
struct Gathered<'a> {
    fault: &'a str,
    recordings: Vec<Vec<Vec<f64>>>,
    thresholds: f64,
}

impl Diagnoser {
    /// Adds the faults of labelled recordings: their classes, a classifier and their sizes.
    pub fn with_faults(
        mut self,
        runs: &[FaultyRun],
        options: &IsolatorOptions,
    ) -> Result<(Self, FaultsReport), FaultsError> {
        let mut faults: Vec<Gathered> = Vec::new();
        for run in runs {
            let (symptoms, thresholds) = self.standing(run)?;
            let known = faults.iter().position(|known| known.fault == run.fault);
            let place = known.unwrap_or_else(|| {
                faults.push(Gathered { fault: run.fault, recordings: Vec::new(), thresholds: 0.0 });
                faults.len() - 1
            });
            faults[place].recordings.push(symptoms);
            faults[place].thresholds += thresholds;
        }
        let (mut learning, mut held_out, mut sizes) = (Vec::new(), Vec::new(), Vec::new());
        for Gathered { fault, mut recordings, thresholds } in faults {
            let samples: usize = recordings.iter().map(Vec::len).sum();
            sizes.push(thresholds / samples as f64);
            let last = recordings.pop().unwrap_or_default();
            let (first, last) = match recordings.is_empty() {
                true => last.split_at(last.len() / 2),
                false => (&recordings.concat()[..], &last[..]),
            };
            let spread = |samples: &[Vec<f64>]| FaultSymptoms {
                fault: fault.to_owned(),
                samples: spread(samples, SYMPTOMS),
            };
            learning.push(spread(first));
            held_out.push(spread(last));
        }
        let (learning, held_out) = (Symptoms::new(learning)?, Symptoms::new(held_out)?);
        let separability = Separability::test(&learning, Separability::LIMIT);
        let (isolator, training) =
            Isolator::train(&learning, &held_out, &separability.partition, options)?;
        let held_out = isolator.matrix(&held_out)?;
        self.faults = Some(Arc::new(KnownFaults { sizes, isolator }));
        Ok((self, FaultsReport { separability, training, held_out }))
    }

    /// Symptoms (u_1.., r) at the samples at which the fault stands declared, and their sum of |r| / T.
    fn standing(&self, run: &FaultyRun) -> Result<(Vec<Vec<f64>>, f64), FaultsError> {
        let recording = || run.recording.to_owned();
        let mut detector = self
            .detector(DetectorKind::Mem)
            .map_err(|source| FaultsError::Detector { recording: recording(), source })?;
        let trace = detector
            .run(&run.data)
            .map_err(|source| FaultsError::Detector { recording: recording(), source })?;
        let threshold = self.constant.band(self.confidence);
        let (mut symptoms, mut thresholds) = (Vec::new(), 0.0);
        for (k, verdict) in trace.verdicts.iter().enumerate().filter(|(_, v)| v.declared) {
            let inputs = run.data.inputs().iter().map(|column| column.values[k]);
            symptoms.push(inputs.chain([verdict.residual]).collect());
            thresholds += thresholds_off(verdict.residual, &threshold);
        }
        if symptoms.len() < LEAST {
            let (fault, samples) = (run.fault.to_owned(), symptoms.len());
            return Err(FaultsError::Unseen { fault, recording: recording(), samples });
        }
        Ok((symptoms, thresholds))
    }
}

/// At most `count` of the samples, evenly spread.
fn spread(samples: &[Vec<f64>], count: usize) -> Vec<Vec<f64>> {
    let count = count.min(samples.len());
    (0..count).map(|i| samples[i * samples.len() / count].clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arx::{Arx, Orders};
    use crate::data::data;
    use crate::design::{Design, ErrorModel};
    use crate::file::FileError;
    use crate::identification::Size;
    use crate::interface::{Channel, Interface};
    use crate::isolation::{Isolated, Naming};
    use crate::model::Model;
    use crate::testing::{PERIOD, Run, closed_loop};
    use crate::threshold::Confidence;

    const ONSET: usize = 1000;

    /// A linear process model of the test's motor, which suffices about its set point.
    fn diagnoser() -> Diagnoser {
        let interface = Interface {
            period_s: PERIOD,
            inputs: vec![Channel::new("C_m", "V")],
            output: Channel::new("T", "rpm"),
        };
        let (healthy, widths) =
            (closed_loop(4000, 1, usize::MAX, 0.0), closed_loop(20_000, 2, usize::MAX, 0.0));
        let model = Arx { a: vec![-0.924], b: vec![vec![27.6]], constant: -9.2 };
        let orders = Orders { n_a: 6, n_b: 6, constant: true };
        let paper = Design::paper(Confidence::new(0.05).unwrap());
        let how = Design { error_model: ErrorModel::Arx(orders), ..paper };
        let model = Model::Arx(Arc::new(model));
        Diagnoser::design(interface, model, &data(&healthy), &data(&widths), &how).unwrap().0
    }

    fn named(diagnoser: &Diagnoser, fault: f64, seed: u64) -> crate::isolation::Named {
        let run = closed_loop(2000, seed, ONSET, fault);
        let data = data(&run);
        let mut detector = diagnoser.detector(DetectorKind::Mem).unwrap();
        let known = diagnoser.faults.clone().unwrap();
        let mut naming = Naming::new(known, diagnoser.constant.band(diagnoser.confidence));
        assert!(naming.named().is_none());
        for (u, y) in data.inputs()[0].values.iter().zip(data.output().values) {
            let verdict = detector.step(&[*u], *y).unwrap();
            if verdict.declared {
                naming.step(&[*u], verdict.residual).unwrap();
            }
        }
        naming.named().unwrap()
    }

    #[test]
    fn faults_that_were_shown_are_named_and_others_are_unknown() {
        let shown =
            [("+5 %", 0.05), ("-5 %", -0.05), ("+10 %", 0.1), ("five", 0.05), ("-20 %", -0.2)];
        let runs: Vec<Run> = (10..)
            .zip(shown)
            .map(|(seed, (_, fault))| closed_loop(2000, seed, ONSET, fault))
            .collect();
        let faulty = |(run, (fault, _)): (&'static Run, (&'static str, f64))| FaultyRun {
            fault,
            recording: "a bench run",
            data: data(run),
        };
        let runs: &'static [Run] = runs.leak();
        let faulty: Vec<FaultyRun> = runs.iter().zip(shown).map(faulty).collect();
        let options = IsolatorOptions { starts: 2, ..IsolatorOptions::default() };
        let (diagnoser, report) = diagnoser().with_faults(&faulty, &options).unwrap();
        let known = diagnoser.faults.clone().unwrap();
        // The same fault under two labels is one class.
        assert_eq!(known.isolator.partition.classes, [vec![0, 3], vec![1], vec![2], vec![4]]);
        let right = report.held_out.right(&known.isolator.partition);
        assert!(right.iter().all(|share| *share > 0.9), "{right:?}");
        assert_eq!(known.groups()[4], Size::Large);
        for (fault, class) in [(0.05, 0), (-0.05, 1), (0.1, 2), (-0.2, 3)] {
            let found = named(&diagnoser, fault, 30);
            assert_eq!(found.answer, Isolated::Class(class), "{fault}: {found:?}");
            assert_eq!(found.group, known.groups()[known.isolator.partition.classes[class][0]]);
            assert!((found.shares.iter().sum::<f64>() - 1.0).abs() < 1e-9);
        }
        for never_shown in [0.2, -0.1] {
            let found = named(&diagnoser, never_shown, 31);
            assert_eq!(found.answer, Isolated::Unknown, "{never_shown}: {found:?}");
        }
        assert_eq!(known.class(0), ["+5 %", "five"]);
        the_file_holds_them(diagnoser);
    }

    fn the_file_holds_them(diagnoser: Diagnoser) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("motor.toml");
        diagnoser.save(&path).unwrap();
        let loaded = Diagnoser::load(&path).unwrap();
        assert_eq!(loaded, diagnoser);
        assert_eq!(named(&loaded, 0.1, 32), named(&diagnoser, 0.1, 32));
        let mut known = KnownFaults::clone(diagnoser.faults.as_ref().unwrap());
        known.sizes.pop();
        Diagnoser { faults: Some(Arc::new(known)), ..diagnoser }.save(&path).unwrap();
        assert!(matches!(Diagnoser::load(&path), Err(FileError::Faults { .. })));
    }

    #[test]
    fn faults_that_are_not_seen_cannot_be_learned() {
        let (small, large) = (closed_loop(2000, 3, ONSET, 0.002), closed_loop(2000, 4, ONSET, 0.1));
        let run = |fault, run| FaultyRun { fault, recording: "bench.csv", data: data(run) };
        let options = IsolatorOptions::default();
        let refused = |runs: &[FaultyRun]| diagnoser().with_faults(runs, &options).unwrap_err();
        let message = refused(&[run("large", &large), run("small", &small)]).to_string();
        assert!(message.starts_with("bench.csv: fault small stands declared at"), "{message}");
        let alone = refused(&[run("large", &large)]);
        assert_eq!(alone, FaultsError::Symptoms(SymptomError::TooFewFaults { faults: 1 }));
    }
}
