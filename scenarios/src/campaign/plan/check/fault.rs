//! The rules of a `[[fault]]` table.

use drivescope_plant::fault::{MECHANISMS, Mechanism};
use toml::Spanned;

use super::super::FaultPlan;
use super::super::error::{Flaw, Problem};
use super::super::layout::{FaultTable, Given, GivenWords};
use super::super::quantity::Words;
use super::{at, out_of_range, share, within};
use crate::profile::Profile;

/// A fault, of a run that is judged from and to those times.
pub(super) fn fault(
    key: &str,
    table: &FaultTable,
    (run_up_s, run_s): (f64, f64),
) -> Result<FaultPlan, Flaw> {
    let kind = words(&format!("{key}.kind"), &table.kind, |word| match word {
        "none" => Ok(None),
        kind => Mechanism::find(kind).map(Some).ok_or_else(|| Problem::Kind {
            key: format!("{key}.kind"),
            kind: kind.to_owned(),
            known: MECHANISMS.iter().map(|known| known.id).collect::<Vec<_>>().join(", "),
        }),
    })?;
    let lossless = |mechanism: &usize| {
        MECHANISMS[*mechanism].unit != "1" || MECHANISMS[*mechanism].id == "load"
    };
    let any_gain = kind.values().iter().flatten().any(|mechanism| !lossless(mechanism));
    let least = if any_gain { -1.0 } else { f64::NEG_INFINITY };
    let size = within(
        &format!("{key}.size"),
        &table.size,
        (least, f64::INFINITY),
        "a fraction of -1 or more, for more than everything cannot be lost (no normal distribution)",
    )?;
    let time = |name: &str, given: &Spanned<Given>| {
        let allowed = "a time of 0 s or more, with a last value (no normal distribution)";
        within(&format!("{key}.{name}"), given, (0.0, 1e9), allowed)
    };
    let onset_s = time("onset", &table.onset)?;
    let duration_s = table.duration.as_ref().map(|given| time("duration", given)).transpose()?;
    let (earliest, latest) = onset_s.bounds();
    if earliest < run_up_s {
        let key = format!("{key}.onset");
        return Err(at(&table.onset, Problem::InRunUp { key, onset_s: earliest, run_up_s }));
    }
    let longest = duration_s.as_ref().map_or(0.0, |duration| duration.bounds().1);
    let end_s = latest + longest;
    if end_s > run_s || latest >= run_s {
        let place = table.duration.as_ref().unwrap_or(&table.onset);
        return Err(at(place, Problem::AfterRun { key: key.to_owned(), end_s, run_s }));
    }
    if let Some(given) = table.duration.as_ref().zip(duration_s.as_ref())
        && given.1.bounds().0 <= 0.0
    {
        let allowed = "a time above 0 s".to_owned();
        return Err(out_of_range(given.0, &format!("{key}.duration"), given.1.bounds().0, allowed));
    }
    let profile = match &table.profile {
        None => Words::fixed(Profile::Step),
        Some(given) => words(&format!("{key}.profile"), given, |word| {
            let wrong = |error| Problem::Profile { key: format!("{key}.profile"), error };
            word.parse::<Profile>().map_err(wrong)
        })?,
    };
    let probability = share(table.probability.as_ref(), &format!("{key}.probability"), 1.0)?;
    Ok(FaultPlan { kind, size, onset_s, duration_s, profile, probability })
}

fn words<T: Clone>(
    key: &str,
    given: &Spanned<GivenWords>,
    parse: impl Fn(&str) -> Result<T, Problem>,
) -> Result<Words<T>, Flaw> {
    let value = |what| at(given, Problem::Value { key: key.to_owned(), what });
    Words::of(given.get_ref(), parse).map_err(value)?.map_err(|problem| at(given, problem))
}
