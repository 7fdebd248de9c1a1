//! What might be missing: every registered effect that the drive can have and lacks.
//!
//! Each effect says itself at which shapes it is weighed, and what cannot show it
//! ([`drivescope_plant::effects::info::Info`]).

use drivescope_plant::drive::{Drive, EffectData};
use drivescope_plant::effects::grid::{Shape, Spans};
use drivescope_plant::effects::law::Variable;
use drivescope_plant::effects::registry::{Entry, REGISTRY};

use super::candidate::{Candidate, Variant};
use super::not_judged::NotJudged;
use super::typed;
use crate::estimate::Evidence;
use crate::measured::{Measured, Output};

/// The candidates of a drive with these recordings, those of the laws that the user typed among
/// them, and what cannot be judged.
pub(crate) fn candidates(
    drive: &Drive,
    evidence: &Evidence,
    spans: &Spans,
    typed: &[EffectData],
) -> (Vec<Candidate>, Vec<NotJudged>) {
    let is_in = |one: &EffectData| drive.effects.iter().any(|effect| effect.id == one.id);
    let remainder = typed.iter().filter(|one| !is_in(one));
    let constant = is_constant(drive, evidence);
    let (mut found, mut not) = (remainder.map(typed::candidate).collect::<Vec<_>>(), Vec::new());
    for entry in REGISTRY {
        let own = |reason: String, worth_saying| NotJudged {
            effect: entry.info.id.to_owned(),
            reason,
            worth_saying,
        };
        if let Some(refusal) = drive.refuses(entry) {
            not.push(own(format!("impossible in this drive: {refusal}"), false));
        } else if let Some(reason) = needless(entry, drive) {
            not.push(own(reason.to_owned(), false));
        } else if let Some(reason) = unseen(entry, constant, evidence, spans) {
            not.push(own(reason, true));
        } else {
            found.push(candidate(entry, drive, spans));
        }
    }
    (found, not)
}

/// One candidate by its effect.
pub(crate) fn candidate(entry: &'static Entry, drive: &Drive, spans: &Spans) -> Candidate {
    let info = entry.info;
    let finite = info.nulls.iter().all(|(_, null)| null.is_finite());
    let vanish = info.nulls.iter().filter(|_| finite).map(|(name, _)| *name);
    let range = |name: &str| {
        let own = entry.parameters.iter().find(|parameter| parameter.name == name);
        own.map_or((0.0, 0.0), |parameter| parameter.range)
    };
    let ranges = vanish.clone().map(range).collect();
    let coefficients = vanish.map(str::to_owned).collect();
    let id = drive.free_id(entry.info.id);
    let variants = (info.grid)(spans).iter().map(|shape| variant(entry, &id, shape)).collect();
    let frozen = if spans.rotary { info.counts.to_vec() } else { Vec::new() };
    let (name, fails_over) = (info.id.to_owned(), info.fails_over.to_vec());
    Candidate { name, info, fails_over, id, coefficients, ranges, variants, frozen }
}

/// Why the effect is no candidate for this drive, whatever is recorded.
fn needless(entry: &Entry, drive: &Drive) -> Option<&'static str> {
    let info = entry.info;
    if info.unweighed.is_some() {
        return info.unweighed;
    }
    if entry.parameters.is_empty() || info.nulls.is_empty() {
        return Some("it has no null from which it could be weighed");
    }
    if info.replaces_dry && !drive.effects.iter().any(dry) {
        return Some("bends the dry friction, and the drive has none: add coulomb first");
    }
    // Two of a law without a shape are one.
    let vanishes = |name: &str| info.nulls.iter().any(|(it, null)| *it == name && null.is_finite());
    let has_no_shape = entry.parameters.iter().all(|parameter| vanishes(parameter.name));
    (has_no_shape && drive.effects.iter().any(|effect| effect.kind == info.id))
        .then_some("the drive has it")
}

/// Why these recordings, whose current may be constant, cannot show the effect.
fn unseen(entry: &Entry, constant: bool, evidence: &Evidence, spans: &Spans) -> Option<String> {
    let has = |one: &Measured, output| one.output(output).is_some();
    let any = |wanted: &[Output]| {
        evidence.recordings.iter().all(|one| wanted.iter().any(|output| has(one, *output)))
    };
    let info = entry.info;
    if info.fails_over.first() == Some(&Variable::Current) && constant {
        return Some("the current is the same throughout but for its noise".to_owned());
    }
    if info.fails_over.contains(&Variable::Theta) && !any(&[Output::Speed, Output::Position]) {
        return Some("needs the position or the speed, and neither was recorded".to_owned());
    }
    if let Some(variable) = info.distorts {
        let output = if variable == Variable::Current { Output::Current } else { Output::Speed };
        if !any(&[output]) {
            let signal = variable.name();
            return Some(format!("distorts the signal {signal}, which was not recorded"));
        }
    }
    (info.unseen)(spans)
}

/// Whether a recorded current stays at one level, but for what a sample does not share with the next.
fn is_constant(drive: &Drive, evidence: &Evidence) -> bool {
    /// Correlation from a sample to the next below which it is noise.
    const WHITE: f64 = 0.2;
    /// Standard deviations that the level is from 0 at least.
    const HELD: f64 = 3.0;
    let each = || evidence.recordings.iter().map(|it| it.current(drive).collect::<Vec<f64>>());
    let all: Vec<f64> = each().flatten().collect();
    let n = all.len() as f64;
    let mean = all.iter().sum::<f64>() / n;
    let variance = all.iter().map(|i| (i - mean).powi(2)).sum::<f64>() / n;
    let product = |pair: &[f64]| (pair[0] - mean) * (pair[1] - mean);
    let shared: f64 = each().map(|it| it.windows(2).map(product).sum::<f64>()).sum::<f64>() / n;
    variance > 0.0 && shared < WHITE * variance && mean * mean > HELD * HELD * variance
}

fn dry(effect: &EffectData) -> bool {
    Entry::find(&effect.kind).is_some_and(|entry| entry.info.dry)
}

/// The effect with those values of its shape, nominal ones for the rest and nulls for its
/// coefficients.
fn variant(entry: &Entry, id: &str, shape: &Shape) -> Variant {
    let value = |parameter: &drivescope_plant::effects::law::Parameter| {
        let null = entry
            .info
            .nulls
            .iter()
            .find(|(name, null)| *name == parameter.name && null.is_finite());
        let chosen = shape.iter().find(|(name, _)| *name == parameter.name);
        let value = chosen.or(null).map_or(parameter.nominal, |(_, value)| *value);
        (parameter.name.to_owned(), value.clamp(parameter.range.0, parameter.range.1))
    };
    let parameters = entry.parameters.iter().map(value).collect();
    let (kind, id) = (entry.info.id.to_owned(), id.to_owned());
    Variant { effect: EffectData { kind, id, parameters, law: None } }
}
