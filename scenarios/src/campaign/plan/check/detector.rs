//! The rules of the `[detector]` table.

use drivescope_diagnoser::bank::FEWEST_ROWS;
use drivescope_monitor::bank::process;
use toml::Spanned;

use super::super::error::{Flaw, Problem};
use super::super::layout::{DetectorTable, Given};
use super::super::quantity::Quantity;
use super::super::{DetectorPlan, Method};
use super::{at, within};
use crate::experiment::Experiment;

/// What a plan need not say.
const BETA: f64 = 0.05;
const WINDOW: f64 = 50.0;
const ARL_0: f64 = 1e5;
const KAPPA: f64 = 0.5;

/// Methods and settings, for scenarios with a run-up of so many samples.
pub(super) fn detector(
    table: &DetectorTable,
    experiment: &Experiment,
    run_up: usize,
) -> Result<(Vec<Method>, DetectorPlan), Flaw> {
    let methods = match &table.methods {
        None => Method::OF_RESIDUAL.to_vec(),
        Some(names) => {
            let mut methods = Vec::new();
            for name in names.get_ref() {
                let found = Method::ALL.into_iter().find(|it| it.id() == name.get_ref());
                let known = Method::ALL.map(Method::id).join(", ");
                let unknown = || Problem::Value {
                    key: "detector.methods".to_owned(),
                    what: format!("there is no method `{}`; known are {known}", name.get_ref()),
                };
                let found = found.ok_or_else(|| at(name, unknown()))?;
                if found == Method::Bank {
                    bank(name, experiment, run_up)?;
                }
                methods.push(found);
            }
            methods.sort_unstable();
            methods.dedup();
            methods
        }
    };
    let setting = |key: &str,
                   given: &Option<Spanned<Given>>,
                   usual: f64,
                   range: (f64, f64),
                   allowed: &str| match given {
        None => Ok(Quantity::fixed(usual)),
        Some(given) => within(&format!("detector.{key}"), given, range, allowed),
    };
    let plan = DetectorPlan {
        beta: setting("beta", &table.beta, BETA, (1e-12, 1.0 - 1e-12), "a share between 0 and 1")?,
        window: setting("window", &table.window, WINDOW, (1.0, 1e6), "a number of samples from 1")?,
        arl_0: setting("arl_0", &table.arl_0, ARL_0, (10.0, 1e12), "10 to 1e12 samples")?,
        kappa: setting("kappa", &table.kappa, KAPPA, (0.01, 10.0), "0.01 to 10")?,
    };
    Ok((methods, plan))
}

/// Whether a bank can be made for the drive, and has enough of the run-up to learn a machine from.
fn bank(name: &Spanned<String>, experiment: &Experiment, run_up: usize) -> Result<(), Flaw> {
    let wrong = |what| at(name, Problem::Value { key: "detector.methods".to_owned(), what });
    let period_s = experiment.period_s;
    process(&experiment.drive, period_s, &[])
        .map_err(|error| wrong(format!("{error}, or leave `bank` out")))?;
    if run_up < FEWEST_ROWS {
        return Err(wrong(format!(
            "the bank learns each machine from the run-up, of which it needs {FEWEST_ROWS} samples: \
             set detector.run_up = {} or more, or leave `bank` out",
            FEWEST_ROWS as f64 * period_s
        )));
    }
    Ok(())
}
