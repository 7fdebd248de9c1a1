//! The paper's isolation over many draws: perceptron (26) beside a quadratic discriminant, for each of
//! several designs over many draws of the noise, then over machines drawn anew, beside the bank.
//!
//! ```text
//! design seed --> diagnoser, symptoms of two draws --> perceptron, discriminant
//! other seeds --> symptoms --> answers: by sample, and by the majority of a run's samples
//! machines drawn anew --> the same answers, and those of the bank
//! ```

use drivescope_diagnoser::{
    Discriminant, FaultSymptoms, Isolated, Isolator, IsolatorOptions, Partition, Symptoms,
};
use drivescope_plant::drive::Drive;
use rayon::prelude::*;
use serde::Serialize;
use thiserror::Error;

use super::bench::Bench;
use super::classes::{Classes, classes};
use super::machine::Group;
use super::{TrialError, TrialOptions};
use crate::experiment::Experiment;
use crate::faults::{Fault, twelve};
use crate::results::{FaultName, TorqueReading};
use crate::shares::{Share, Spread};
use crate::study::{Designed, STARTS, StudyError, symptoms};

/// What is tried.
#[derive(Debug, Clone, Copy)]
pub struct IsolationOptions {
    /// Draws of the noise that each design is judged on.
    pub draws: u64,
    /// Machines drawn anew.
    pub machines: usize,
    /// Reading of the torque faults.
    pub torque: TorqueReading,
    /// Seed of the bank's design; machines have another.
    pub seed: u64,
}

/// Why there are no trials.
#[derive(Debug, Error)]
pub enum IsolationTrialError {
    /// Of the paper's classifiers.
    #[error(transparent)]
    Study(#[from] StudyError),
    /// Of the bank.
    #[error(transparent)]
    Trial(#[from] TrialError),
}

/// One classifier over fresh draws.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ClassifierRow {
    /// `perceptron` or `discriminant`.
    pub classifier: &'static str,
    /// `paper` for its ten classes, `twelve` for every fault alone.
    pub classes: &'static str,
    /// Share of samples answered right, over the draws.
    pub samples: Spread,
    /// The same of the fault that it does worst on.
    pub worst: Spread,
    pub worst_fault: FaultName,
    /// Runs of which most samples were answered right.
    pub runs: Share,
    /// The same held against the next fault: must collapse.
    pub shuffled: Share,
}

/// One design.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DesignRow {
    pub seed: u64,
    pub classifiers: Vec<ClassifierRow>,
}

/// The table.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct IsolationTrials {
    /// Random starts of each perceptron.
    pub starts: usize,
    /// Draws of the noise for each design.
    pub draws: u64,
    /// Designs, judged on the drive that they were made for.
    pub designs: Vec<DesignRow>,
    /// Machines drawn anew.
    pub machines: usize,
    /// The classifiers of the first design on these machines.
    pub on_machines: Vec<ClassifierRow>,
    /// The bank on as many machines.
    pub bank: Classes,
}

/// A classifier at work.
enum Classifier {
    Perceptron(Box<Isolator>),
    Discriminant(Discriminant),
}

/// A classifier and its classes.
struct Trained {
    classifier: Classifier,
    partition: Partition,
    names: (&'static str, &'static str),
}

impl Trained {
    /// The class of a symptom; nothing where it is unknown.
    fn class(&self, symptom: &[f64]) -> Option<usize> {
        match &self.classifier {
            Classifier::Perceptron(isolator) => match isolator.answer(symptom) {
                Ok(Isolated::Class(class)) => Some(class),
                Ok(Isolated::Unknown) | Err(_) => None,
            },
            Classifier::Discriminant(of) => {
                of.answer(symptom).and_then(|fault| self.partition.class_of(fault))
            }
        }
    }

    /// Of each fault: the share of its samples answered as its class, whether most are, and whether
    /// most are answered as the class of the next fault.
    fn judge(&self, symptoms: &Symptoms) -> Vec<(f64, bool, bool)> {
        let faults = symptoms.faults();
        let own = |fault: usize| self.partition.class_of(fault);
        let next = |fault: usize| {
            let later = (1..faults.len()).map(|step| (fault + step) % faults.len());
            later.map(own).find(|class| *class != own(fault)).flatten()
        };
        let of_fault = |(fault, of): (usize, &FaultSymptoms)| {
            let answers: Vec<Option<usize>> = of.samples.iter().map(|x| self.class(x)).collect();
            let share = |class: Option<usize>| {
                let hits = answers.iter().filter(|answer| answer.is_some() && **answer == class);
                hits.count() as f64 / answers.len() as f64
            };
            let right = share(own(fault));
            (right, right > 0.5, share(next(fault)) > 0.5)
        };
        faults.iter().enumerate().map(of_fault).collect()
    }
}

/// Trains the four on two draws of a design's own symptoms.
fn trained(
    experiment: &Experiment,
    designed: &Designed,
    faults: &[Fault],
) -> Result<Vec<Trained>, StudyError> {
    let [learning, held_out] = [0, 1].map(|k| symptoms(experiment, &designed.diagnoser, faults, k));
    let (learning, held_out) = (learning?, held_out?);
    let options =
        IsolatorOptions { starts: STARTS, seed: experiment.seed, ..IsolatorOptions::default() };
    let mut made = Vec::new();
    for (name, partition) in
        [("paper", Partition::paper()), ("twelve", Partition::singletons(faults.len()))]
    {
        let (isolator, _) = Isolator::train(&learning, &held_out, &partition, &options)?;
        let perceptron = Classifier::Perceptron(Box::new(isolator));
        let discriminant = Classifier::Discriminant(Discriminant::of(&learning));
        for (classifier, kind) in [(perceptron, "perceptron"), (discriminant, "discriminant")] {
            made.push(Trained { classifier, partition: partition.clone(), names: (kind, name) });
        }
    }
    Ok(made)
}

/// Rows of the classifiers over many symptoms.
fn rows(trained: &[Trained], faults: &[Fault], draws: &[Symptoms]) -> Vec<ClassifierRow> {
    let row = |trained: &Trained| {
        let judged: Vec<Vec<(f64, bool, bool)>> =
            draws.par_iter().map(|draw| trained.judge(draw)).collect();
        let n = judged.len() as f64;
        let mean = |fault: usize| judged.iter().map(|draw| draw[fault].0).sum::<f64>() / n;
        let of_draw = |draw: &Vec<(f64, bool, bool)>| {
            draw.iter().map(|it| it.0).sum::<f64>() / draw.len() as f64
        };
        let worst = (0..faults.len()).min_by(|a, b| mean(*a).total_cmp(&mean(*b))).unwrap_or(0);
        let count = |hit: fn(&(f64, bool, bool)) -> bool| {
            let all = judged.iter().flatten();
            Share::new(all.clone().filter(|it| hit(it)).count(), all.count())
        };
        ClassifierRow {
            classifier: trained.names.0,
            classes: trained.names.1,
            samples: Spread::of(judged.iter().map(of_draw)),
            worst: Spread::of(judged.iter().map(|draw| draw[worst].0)),
            worst_fault: faults[worst].name.clone(),
            runs: count(|it| it.1),
            shuffled: count(|it| it.2),
        }
    };
    trained.iter().map(row).collect()
}

/// Tries the designs, each with the experiment that it was made for; ends where `advance`, called
/// after each, answers true.
///
/// # Errors
/// [`IsolationTrialError`], which says what did not suit.
pub fn isolation(
    drive: &Drive,
    designs: &[(Experiment, Designed)],
    options: &IsolationOptions,
    advance: &(dyn Fn() -> bool + Sync),
) -> Result<IsolationTrials, IsolationTrialError> {
    let &IsolationOptions { draws, machines, torque, seed } = options;
    let faults = twelve(torque);
    let step = || if advance() { Err(TrialError::Stopped) } else { Ok(()) };
    let (mut found, mut first) = (Vec::new(), None);
    for (experiment, designed) in designs {
        let classifiers = trained(experiment, designed, &faults)?;
        // Seeds beyond those of all designs.
        let fresh = |k: u64| {
            let seed = experiment.seed.wrapping_add((k + 1) << 32);
            symptoms(&experiment.with_seed(seed), &designed.diagnoser, &faults, 0)
        };
        let fresh = (0..draws).into_par_iter().map(fresh).collect::<Result<Vec<_>, _>>()?;
        let classifiers_rows = rows(&classifiers, &faults, &fresh);
        found.push(DesignRow { seed: experiment.seed, classifiers: classifiers_rows });
        first.get_or_insert((classifiers, designed));
        step()?;
    }
    let bench =
        Bench::new(drive.clone(), &TrialOptions { machines, healthy: 0, arl_0: 1e6, seed })?;
    let mut on_machines = Vec::new();
    if let Some((classifiers, designed)) = first {
        let of_machines = bench.each(Group::Classes, machines, |machine, _| {
            symptoms(&machine.experiment, &designed.diagnoser, &faults, 0)
        });
        let of_machines = of_machines.into_iter().collect::<Result<Vec<_>, _>>()?;
        on_machines = rows(&classifiers, &faults, &of_machines);
    }
    step()?;
    let bank = classes(&bench);
    step()?;
    Ok(IsolationTrials { starts: STARTS, draws, designs: found, machines, on_machines, bank })
}
