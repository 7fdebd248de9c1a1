//! The rules of the `[detector]` table.

use toml::Spanned;

use super::super::error::{Flaw, Problem};
use super::super::layout::{DetectorTable, Given};
use super::super::quantity::Quantity;
use super::super::{DetectorPlan, Method};
use super::{at, within};

/// What a plan need not say.
const BETA: f64 = 0.05;
const WINDOW: f64 = 50.0;
const ARL_0: f64 = 1e5;
const KAPPA: f64 = 0.5;

/// Methods and settings.
pub(super) fn detector(table: &DetectorTable) -> Result<(Vec<Method>, DetectorPlan), Flaw> {
    let methods = match &table.methods {
        None => Method::ALL.to_vec(),
        Some(names) => {
            let mut methods = Vec::new();
            for name in names.get_ref() {
                let found = Method::ALL.into_iter().find(|it| it.id() == name.get_ref());
                let known = Method::ALL.map(Method::id).join(", ");
                let unknown = || Problem::Value {
                    key: "detector.methods".to_owned(),
                    what: format!("there is no method `{}`; known are {known}", name.get_ref()),
                };
                methods.push(found.ok_or_else(|| at(name, unknown()))?);
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
