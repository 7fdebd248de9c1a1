//! The rules of `fmu` and `[fmu_variables]`: whether a foreign FMU can be the machine of the plan.

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use drivescope_fmu::import::{Causality, Conversion, Fmu, Interface, Unit, convert};
use sha2::{Digest, Sha256};
use toml::Spanned;

use super::super::error::{Flaw, Problem};
use super::super::layout::Layout;
use super::super::{Plan, places};
use super::{at, out_of_range};
use crate::campaign::foreign::{ForeignPlant, SHOWN, units};

/// Time that a scenario may take where the plan does not say, and the longest that it can say, s.
const TIME_LIMIT_S: f64 = 60.0;
const LONGEST_S: f64 = 1e6;
/// How parameters of noise begin: it is drawn outside.
const NOISE: &str = "noise.";

/// The foreign FMU of a plan, if it has one.
pub(super) fn foreign(
    layout: &Layout,
    plan: &Plan,
    folder: &Path,
) -> Result<Option<ForeignPlant>, Flaw> {
    let Some(given) = &layout.fmu else {
        return match (layout.fmu_variables.first_key_value(), &layout.fmu_time_limit) {
            (Some((key, _)), _) => {
                Err(wrong(key, "there is no `fmu` that has variables".to_owned()))
            }
            (None, Some(limit)) => {
                Err(wrong(limit, "there is no `fmu` that takes time".to_owned()))
            }
            (None, None) => Ok(None),
        };
    };
    let name = given.get_ref();
    let path = places(name, folder).into_iter().find(|path| path.is_file());
    let path =
        path.ok_or_else(|| wrong(given, format!("there is no file `{name}` beside the plan")))?;
    let digest = digest_of(&path)
        .map_err(|error| wrong(given, format!("{name} cannot be read: {error}")))?;
    let fmu = Fmu::open(path).map_err(|error| at(given, Problem::Fmu(Box::new(error))))?;
    if fmu.description().capabilities(Interface::CoSimulation).is_none() {
        let what = format!("{name} has no Co-Simulation: export it so");
        return Err(wrong(given, what));
    }
    let time_limit_s = layout.fmu_time_limit.as_ref().map_or(TIME_LIMIT_S, |it| *it.get_ref());
    if let Some(given) = &layout.fmu_time_limit
        && !(time_limit_s > 0.0 && time_limit_s <= LONGEST_S)
    {
        let allowed = format!("a time up to {LONGEST_S} s");
        return Err(out_of_range(given, "fmu_time_limit", time_limit_s, allowed));
    }
    let of_plan = |name: &str| plan.parameters().any(|parameter| parameter.name == name);
    for key in layout.fmu_variables.keys() {
        if plan.experiment.unit_of(key.get_ref()).is_none() && !of_plan(key.get_ref()) {
            let what = format!(
                "`{}` is no variable of a drive's closed loop and no parameter of the plan: `drivescope \
                 export` and `drivescope fmu info` show what there is",
                key.get_ref()
            );
            return Err(wrong(key, what));
        }
    }
    let look = Look { layout, given, fmu: &fmu };
    for input in plan.entering() {
        let name = input.name();
        look.at(&name, Causality::Input, plan.experiment.unit_of(&name))?;
    }
    let mut shown = [Conversion::IDENTITY; SHOWN.len()];
    for ((shown, name), unit) in shown.iter_mut().zip(SHOWN).zip(units(&plan.experiment)) {
        *shown = look.at(name, Causality::Output, Some(unit))?.1;
    }
    let parameters = plan.parameters().map(|parameter| {
        if parameter.name.starts_with(NOISE) {
            return Ok(None);
        }
        look.at(&parameter.name, Causality::Parameter, Some(&parameter.unit)).map(Some)
    });
    let parameters = parameters.collect::<Result<Vec<_>, Flaw>>()?;
    let names = layout.fmu_variables.iter();
    let names = names.map(|(key, own)| (key.get_ref().clone(), own.get_ref().clone())).collect();
    Ok(Some(ForeignPlant {
        fmu,
        file: name.clone(),
        time_limit: Duration::from_secs_f64(time_limit_s),
        digest,
        names,
        parameters,
        shown,
        turn: Arc::default(),
    }))
}

/// Hexadecimal digest of a file.
fn digest_of(path: &Path) -> std::io::Result<String> {
    let sum = Sha256::digest(std::fs::read(path)?);
    Ok(sum.iter().map(|byte| format!("{byte:02x}")).collect())
}

fn wrong<T>(place: &Spanned<T>, what: String) -> Flaw {
    at(place, Problem::Value { key: "fmu".to_owned(), what })
}

/// Where variables of an FMU are looked for.
struct Look<'a> {
    layout: &'a Layout,
    given: &'a Spanned<String>,
    fmu: &'a Fmu,
}

impl Look<'_> {
    /// The FMU's name of a variable, and how its values are converted between our unit and its own:
    /// towards the FMU, or from it for what it shows.
    fn at(
        &self,
        name: &str,
        causality: Causality,
        unit: Option<&str>,
    ) -> Result<(String, Conversion), Flaw> {
        let mapped = self.layout.fmu_variables.iter().find(|(key, _)| key.get_ref() == name);
        let mapped = mapped.map(|(_, own)| own);
        let place = mapped.unwrap_or(self.given);
        let own = mapped.map_or(name, |own| own.get_ref());
        let about = self.fmu.description();
        let what = format!("{causality:?}").to_lowercase();
        let variable = about.scalars(causality).find(|variable| variable.name == own);
        let variable = variable.ok_or_else(|| {
            let instead = match (mapped, name.starts_with("noise_")) {
                (Some(_), _) => "name one that it has (`drivescope fmu info`)",
                (None, true) => {
                    "say under [fmu_variables] which it is, or set that noise to 0 under [parameters]"
                }
                (None, false) => {
                    "say under [fmu_variables] which it is, or leave out what needs it"
                }
            };
            wrong(place, format!("{} has no {what} `{own}`: {instead}", self.fmu.name()))
        })?;
        let ours = unit.map(|name| Unit { name: name.to_owned(), base: None });
        let theirs = variable.unit.as_ref().map(|unit| about.unit_of_name(unit));
        let (from, to) = match causality {
            Causality::Output => (theirs, ours),
            _ => (ours, theirs),
        };
        let conversion = convert(from.as_ref(), to.as_ref()).ok_or_else(|| {
            let [ours, theirs] = [unit, variable.unit.as_deref()].map(|it| it.unwrap_or("1"));
            let what =
                format!("{what} `{own}` of the FMU is in {theirs}, and not in {ours} or the like");
            wrong(place, what)
        })?;
        Ok((own.to_owned(), conversion))
    }
}
