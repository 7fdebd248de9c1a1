//! `effects`: the library of physical effects, straight from the registry.

use std::fmt::Write;

use clap::Args;
use comfy_table::{ContentArrangement, Table, presets};
use drivescope_plant::effects::custom::Target;
use drivescope_plant::effects::learned::{Factor, Over};
use drivescope_plant::effects::registry::{Entry, REGISTRY};
use drivescope_plant::file::{BALANCES, CUSTOM, LEARNED};
use serde::Serialize;

use super::Run;
use crate::failure::{Ending, Failure};
use crate::next::Next;
use crate::session::Session;

/// Show the library of physical effects: law, parameters, fingerprint, confusions.
#[derive(Debug, Args)]
pub(crate) struct Effects {
    /// One effect in detail.
    id: Option<String>,
}

#[derive(Debug, Serialize)]
struct Shown {
    id: &'static str,
    law: &'static str,
    fingerprint: &'static str,
    /// Variables over which a model without it fails, most telling first.
    fails_over: Vec<&'static str>,
    /// Where the law stands: torque or voltage balance, sensor.
    acts_on: Vec<&'static str>,
    /// What it cannot be told from, at least on some recordings.
    confusion_set: &'static [&'static str],
    parameters: Vec<Quantity>,
    states: Vec<Quantity>,
    /// Parameter values at which the effect vanishes; `null` where that is an infinite value.
    vanishes_at: Vec<(&'static str, f64)>,
    /// Effects that cannot stand beside it in one drive.
    excludes: &'static [&'static str],
}

#[derive(Debug, Serialize)]
struct Quantity {
    name: &'static str,
    unit: &'static str,
    nominal: f64,
    /// Least and greatest possible value; `null` for none.
    range: Option<(Option<f64>, Option<f64>)>,
    description: &'static str,
}

impl Run for Effects {
    fn run(self, session: &Session) -> miette::Result<Ending> {
        match self.id.as_deref() {
            None => {
                let all: Vec<Shown> = REGISTRY.iter().map(shown).collect();
                session.say(&table(&all), &all, &Next::new("effects cogging"))?;
            }
            Some(CUSTOM) => session.say(&custom(), &custom_keys(), &add("ID"))?,
            Some(LEARNED) => session.say(&learned(), &learned_keys(), &add(LEARNED))?,
            Some(id) => {
                let entry = Entry::find(id).ok_or_else(|| unknown(id))?;
                let effect = shown(entry);
                session.say(&detail(&effect), &effect, &add(id))?;
            }
        }
        Ok(Ending::Done)
    }
}

/// The command that adds it.
fn add(id: &str) -> Next {
    Next::new("add DRIVE").with(id).options(" REC -o with_it.toml")
}

fn unknown(id: &str) -> Failure {
    let known: Vec<_> =
        REGISTRY.iter().map(|entry| entry.info.id).chain([CUSTOM, LEARNED]).collect();
    Failure::UnknownEffect { id: id.to_owned(), known: known.join(", ") }
}

fn shown(entry: &Entry) -> Shown {
    let bound = |limit: f64| Some(limit).filter(|limit| limit.is_finite());
    let parameter = |p: &drivescope_plant::effects::law::Parameter| Quantity {
        name: p.name,
        unit: p.unit,
        nominal: p.nominal,
        range: Some((bound(p.range.0), bound(p.range.1))),
        description: p.description,
    };
    let state = |s: &drivescope_plant::effects::law::OwnState| Quantity {
        name: s.name,
        unit: s.unit,
        nominal: s.nominal,
        range: None,
        description: s.description,
    };
    Shown {
        id: entry.info.id,
        law: entry.info.law,
        fingerprint: entry.info.fingerprint,
        fails_over: entry.info.fails_over.iter().map(|variable| variable.name()).collect(),
        acts_on: entry.info.acts_on.iter().map(|place| place.name()).collect(),
        confusion_set: entry.info.aliases,
        parameters: entry.parameters.iter().map(parameter).collect(),
        states: entry.states.iter().map(state).collect(),
        vanishes_at: entry.info.nulls.to_vec(),
        excludes: entry.info.excludes,
    }
}

/// The names joined, or a dash.
fn listed<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    let names: Vec<_> = names.into_iter().collect();
    if names.is_empty() { "-".to_owned() } else { names.join(", ") }
}

fn table(all: &[Shown]) -> String {
    let mut table = Table::new();
    table.load_style(presets::UTF8_FULL_CONDENSED);
    table.set_content_arrangement(ContentArrangement::Dynamic);
    table.set_header(["effect", "law", "parameters", "fingerprint", "confused with"]);
    for effect in all {
        table.add_row([
            effect.id.to_owned(),
            effect.law.to_owned(),
            listed(effect.parameters.iter().map(|p| p.name)),
            effect.fingerprint.to_owned(),
            listed(effect.confusion_set.iter().copied()),
        ]);
    }
    format!(
        "{table}\nA torque or a voltage of a law drives in the positive direction, as in a law that you \
         type.\n`drivescope effects ID` shows one in detail; `{CUSTOM}` is a law of your own, \
         `{LEARNED}` a curve.\n"
    )
}

fn detail(effect: &Shown) -> String {
    let mut text = format!(
        "{}\n  law            {}\n  acts on        {}\n  fingerprint    {}\n  fails over     {}\n  \
         confused with  {}\n",
        effect.id,
        effect.law,
        listed(effect.acts_on.iter().copied()),
        effect.fingerprint,
        listed(effect.fails_over.iter().copied()),
        listed(effect.confusion_set.iter().copied()),
    );
    let vanishes = effect.vanishes_at.iter().map(|(name, value)| format!("{name} = {value}"));
    let vanishes: Vec<_> = vanishes.collect();
    let _ = writeln!(text, "  vanishes at    {}", listed(vanishes.iter().map(String::as_str)));
    if !effect.excludes.is_empty() {
        let others = listed(effect.excludes.iter().copied());
        let _ = writeln!(text, "  not beside     {others}");
    }
    for (title, quantities) in [("parameters", &effect.parameters), ("own states", &effect.states)]
    {
        if quantities.is_empty() {
            continue;
        }
        let mut table = Table::new();
        table.load_style(presets::NOTHING);
        table.set_content_arrangement(ContentArrangement::Dynamic);
        table.set_header(["  name", "unit", "nominal", "range", "meaning"]);
        for q in quantities {
            let range = q.range.map_or("-".to_owned(), in_words);
            let nominal = q.nominal.to_string();
            table.add_row([&format!("  {}", q.name), q.unit, &nominal, &range, q.description]);
        }
        let _ = write!(text, "{title} (units for a rotary drive)\n{table}\n");
    }
    text
}

/// A range for a person.
fn in_words(range: (Option<f64>, Option<f64>)) -> String {
    match range {
        (None, None) => "any".to_owned(),
        (Some(f64::MIN_POSITIVE), None) => "above 0".to_owned(),
        (Some(low), None) => format!("{low} or more"),
        (None, Some(high)) => format!("{high} or less"),
        (Some(low), Some(high)) => format!("{low} to {high}"),
    }
}

fn custom_keys() -> serde_json::Value {
    let keys: Vec<_> = Target::ALL.iter().map(|(key, _)| *key).collect();
    serde_json::json!({ "id": CUSTOM, "laws": keys })
}

fn custom() -> String {
    let keys: Vec<_> = Target::ALL.iter().map(|(key, _)| *key).collect();
    format!(
        "{CUSTOM}\n  a law that you type in the drive file; it gives one of {}\n\n\
         [[effect]]\nkind = \"custom\"\nid = \"fan\"\n\
         torque = \"-c * omega * abs(omega)\"\nparameters = {{ c = 3.0e-7 }}\n\n\
         With its coefficients at 0, where it changes nothing, it is a candidate: `discover` ranks \
         it\namong the effects of the library and names it by its id, `add` adds it. Otherwise it \
         is part of\nthe drive, and `fit` estimates its parameters.\n",
        keys.join(", "),
    )
}

fn learned_keys() -> serde_json::Value {
    let [balances, variables, factors] = curve_words();
    serde_json::json!({ "id": LEARNED, "balance": balances, "over": variables, "times": factors })
}

/// The balances of a curve, what it goes over, and what may multiply it.
fn curve_words() -> [Vec<&'static str>; 3] {
    [
        BALANCES.iter().map(|(name, _)| *name).collect(),
        Over::ALL.iter().map(|(name, _)| *name).collect(),
        Factor::ALL.iter().map(|(name, _)| *name).collect(),
    ]
}

fn learned() -> String {
    let [balances, variables, factors] = curve_words().map(|names| names.join(", "));
    format!(
        "{LEARNED}\n  a curve by its values at knots, cubic between them; it gives one of {balances}\n  \
         over one of {variables},\n  perhaps `times` one of {factors}; a torque \
         times the sign of the\n  motion is a dry friction. Values are added to the motor torque, to \
         u, or to the nominal\n  flux, which is 1.\n\n\
         [[effect]]\nkind = \"learned\"\nbalance = \"torque\"\nover = \"omega\"\n\
         knots = [-100.0, 0.0, 100.0]\nvalues = [0.002, 0.0, -0.003]\n",
    )
}
