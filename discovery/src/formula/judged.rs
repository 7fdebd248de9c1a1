//! The formulas that are worth it, each fitted and judged at its own best like any law.

use std::collections::{BTreeMap, HashSet};

use drivescope_plant::drive::{Drive, EffectData, LawData};
use drivescope_plant::file::CUSTOM;
use rayon::prelude::*;

use super::grammar::{Form, Written, complexity};
use super::weighed::{Visited, Weighed, different, weighed};
use super::{Formula, FormulaLaw};
use crate::likelihood::{Alongside, Filtered};

/// Formulas that are fitted at most, and what each must be worth, of the best: their constants are on
/// a grid that misses a shape by less.
const FITTED: usize = 6;
const WORTH: f64 = 0.8;
/// What a formula may lose of its evidence, and be preferred for having fewer constants.
const AS_PROBABLE: f64 = 1.0;
/// Their name in the drive.
const ID: &str = "formula";

/// Formulas for what the drive of the ground lacks, the most probable first; each has evidence, less
/// what choosing it costs, of more than `asked`, and what was held out speaks for it. Nothing where
/// it is stopped.
pub(crate) fn formulas(
    ground: &Filtered,
    asked: f64,
    stopped: &(dyn Fn() -> bool + Sync),
) -> Vec<Formula> {
    let drive = &ground.scene.drive;
    let found = || {
        let alongside = Alongside::of(ground)?;
        let visited = Visited::of(drive, &alongside);
        let all = weighed(drive, &visited, &alongside, stopped)?;
        let most = all.first()?.worth();
        let promising = all.into_iter().filter(|it| it.worth() > WORTH * most.max(0.0));
        let some = different(promising, &visited, FITTED);
        let at_best = |it: &Weighed| {
            if stopped() { None } else { judged(ground, drive, it, &visited) }
        };
        let judged: Vec<Formula> = some.par_iter().filter_map(at_best).collect();
        (!stopped()).then_some(judged)
    };
    let mut judged = found().unwrap_or_default();
    judged.retain(|it| it.worth() > asked);
    judged.sort_by(|a, b| b.worth().total_cmp(&a.worth()));
    // Two that became one without the constants that are not told.
    let mut seen = HashSet::new();
    judged.retain(|it| seen.insert(it.law.clone()));
    let most = judged.first().map_or(0.0, Formula::worth);
    let all: f64 = judged.iter().map(|it| (it.worth() - most).exp()).sum();
    for it in &mut judged {
        it.probability = (it.worth() - most).exp() / all;
    }
    judged
}

/// A formula at its best; without a constant that its recordings do not tell from none.
fn judged(ground: &Filtered, drive: &Drive, it: &Weighed, visited: &Visited) -> Option<Formula> {
    let (mut best, mut form) = at_best(ground, drive, it, visited)?;
    while let Some(simpler) = form.simpler(visited.greatest()) {
        let it = Weighed { form: simpler, ..it.clone() };
        let Some((formula, fitted)) = at_best(ground, drive, &it, visited) else { break };
        if formula.evidence < best.evidence - AS_PROBABLE {
            break;
        }
        (best, form) = (formula, fitted);
    }
    Some(best)
}

/// A formula fitted in the filter, with its form at those values.
fn at_best(
    ground: &Filtered,
    drive: &Drive,
    it: &Weighed,
    visited: &Visited,
) -> Option<(Formula, Form)> {
    let Written { text, shape } = it.form.written(&visited.names);
    let coefficients = it.form.coefficients();
    let start = coefficients.iter().zip(&it.coefficients).map(|(name, value)| (*name, *value));
    let parameters: Vec<(String, f64)> =
        start.chain(shape).map(|(name, value)| (name.to_owned(), value)).collect();
    let id = drive.free_id(ID);
    let free: Vec<String> = parameters.iter().map(|(name, _)| format!("{id}.{name}")).collect();
    let own: Vec<String> = coefficients.iter().map(|name| (*name).to_owned()).collect();
    let law = LawData::Typed { target: it.form.target, text: text.clone() };
    let effect = EffectData { kind: CUSTOM.to_owned(), id: id.clone(), parameters, law: Some(law) };
    let (scene, optimum) = ground.with(&[effect], &free, &own)?;
    let [_, evidence, repeats] = optimum.over(&ground.base);
    if repeats <= 0.0 {
        return None;
    }
    let fitted = scene.drive.effects.iter().find(|effect| effect.id == id)?;
    let value = |name: &str| fitted.parameters.iter().find(|it| it.0 == name).map(|it| it.1);
    let (form, sign) = it.form.fitted(value);
    let coefficients = coefficients.iter().map(|name| Some((*name, sign * value(name)?)));
    let shape = form.written(&visited.names).shape;
    let parameters: Option<BTreeMap<String, f64>> = coefficients
        .chain(shape.into_iter().map(Some))
        .map(|it| it.map(|(name, value)| (name.to_owned(), value)))
        .collect();
    let formula = Formula {
        complexity: complexity(&text),
        law: FormulaLaw::of(it.form.target, text),
        parameters: parameters?,
        evidence,
        probability: 0.0,
        price: it.price,
        size: optimum.size,
    };
    Some((formula, form))
}

impl Formula {
    /// The drive with it as one more effect.
    pub(crate) fn added(&self, drive: &Drive) -> Drive {
        let (target, text) = self.law.parts();
        let parameters = self.parameters.iter().map(|(name, value)| (name.clone(), *value));
        let mut with = drive.clone();
        with.effects.push(EffectData {
            kind: CUSTOM.to_owned(),
            id: drive.free_id(ID),
            parameters: parameters.collect(),
            law: Some(LawData::Typed { target, text: text.to_owned() }),
        });
        with
    }
}
