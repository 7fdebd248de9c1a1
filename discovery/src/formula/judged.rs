//! The formulas that are worth it, each fitted and judged at its own best like any law.

use std::collections::BTreeMap;

use drivescope_plant::drive::{Drive, EffectData, LawData};
use drivescope_plant::file::CUSTOM;
use rayon::prelude::*;

use super::weighed::{Visited, Weighed, different, weighed};
use super::{Formula, FormulaLaw};
use crate::likelihood::{Alongside, Filtered};

/// Formulas that are fitted at most, and what each must be worth, of the best: their constants are on
/// a grid that misses a shape by less.
const FITTED: usize = 6;
const WORTH: f64 = 0.8;
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
    let most = judged.first().map_or(0.0, Formula::worth);
    let all: f64 = judged.iter().map(|it| (it.worth() - most).exp()).sum();
    for it in &mut judged {
        it.probability = (it.worth() - most).exp() / all;
    }
    judged
}

fn judged(ground: &Filtered, drive: &Drive, it: &Weighed, visited: &Visited) -> Option<Formula> {
    let written = it.form.written(&visited.names);
    let coefficients = it.form.coefficients();
    let start = coefficients.iter().zip(&it.coefficients).map(|(name, value)| (*name, *value));
    let parameters: Vec<(String, f64)> =
        start.chain(written.shape).map(|(name, value)| (name.to_owned(), value)).collect();
    let id = drive.free_id(ID);
    let free: Vec<String> = parameters.iter().map(|(name, _)| format!("{id}.{name}")).collect();
    let own: Vec<String> = coefficients.iter().map(|name| (*name).to_owned()).collect();
    let law = LawData::Typed { target: it.form.target, text: written.text.clone() };
    let effect = EffectData { kind: CUSTOM.to_owned(), id: id.clone(), parameters, law: Some(law) };
    let (scene, optimum) = ground.with(&[effect], &free, &own)?;
    let [_, evidence, repeats] = optimum.over(&ground.base);
    if repeats <= 0.0 {
        return None;
    }
    let fitted = scene.drive.effects.iter().find(|effect| effect.id == id)?;
    let parameters: BTreeMap<String, f64> = fitted.parameters.iter().cloned().collect();
    Some(Formula {
        law: FormulaLaw::of(it.form.target, written.text),
        parameters,
        evidence,
        probability: 0.0,
        complexity: it.complexity,
        price: it.price,
        size: optimum.size,
    })
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
