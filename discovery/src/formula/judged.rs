//! The formulas that are worth it, each fitted and judged at its own best like any law.

use std::collections::HashSet;

use drivescope_plant::drive::{Drive, EffectData, LawData};
use drivescope_plant::file::CUSTOM;
use rayon::prelude::*;

use super::compared::Compared;
use super::grammar::{Written, complexity};
use super::weighed::{Valued, Visited, Weighed, weighed};
use super::{Formula, FormulaLaw};
use crate::likelihood::{Alongside, Filtered};

/// Formulas that are fitted at most, and what each must be worth, of the best: their constants are on
/// a grid that misses a shape by less.
const FITTED: usize = 6;
const WORTH: f64 = 0.8;
/// What the best formula of other variables or the other balance must be worth, of the best, to be fitted too:
/// along the run of a drive that lacks it, a friction near standstill shows a fraction of its evidence.
const WORTH_OF_OTHERS: f64 = 0.25;
/// Formulas that are fitted from the curve of the best one on. Weighed beside the base, where a shape stands
/// on its grid, one may show the opposite of what it is in its place.
const NEAREST: usize = 4;
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
        let kinds = visited.proposals(drive);
        let all = weighed(&kinds, &visited, &alongside, stopped)?;
        let compared = Compared::of(&visited);
        let at_best = |it: &Valued| {
            if stopped() { None } else { judged(ground, drive, it, &visited) }
        };
        let some = promising(&all, &compared)?;
        let mut judged: Vec<(Formula, Valued)> = some.par_iter().filter_map(at_best).collect();
        let best = judged.iter().max_by(|a, b| a.0.worth().total_cmp(&b.0.worth()));
        let near = best.map_or_else(Vec::new, |(_, best)| {
            let is_fitted = |it: &&Valued| judged.iter().any(|(_, other)| other.kind == it.kind);
            let others: Vec<&Valued> =
                all.iter().map(|it| &it.valued).filter(|it| !is_fitted(it)).collect();
            compared.nearest(best, &others, &kinds, NEAREST)
        });
        judged.par_extend(near.par_iter().filter_map(at_best));
        (!stopped()).then(|| judged.into_iter().map(|it| it.0).collect())
    };
    let mut judged: Vec<Formula> = found().unwrap_or_default();
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

/// The formulas that are fitted: the best that differ, and the best of each other kind.
fn promising(all: &[Weighed], compared: &Compared<'_>) -> Option<Vec<Valued>> {
    let most = all.first()?.worth().max(0.0);
    let worth = |share: f64| all.iter().filter(move |it| it.worth() > share * most);
    let mut some = compared.different(worth(WORTH).map(|it| &it.valued), FITTED);
    for Weighed { valued: it, .. } in worth(WORTH_OF_OTHERS) {
        if some.iter().all(|other: &Valued| other.form.family() != it.form.family()) {
            some.push(it.clone());
        }
    }
    Some(some)
}

/// A formula at its best, with the values found; without a constant that its recordings do not tell from none.
fn judged(
    ground: &Filtered,
    drive: &Drive,
    it: &Valued,
    visited: &Visited,
) -> Option<(Formula, Valued)> {
    let mut best = at_best(ground, drive, it, visited)?;
    while let Some(form) = best.1.form.simpler(visited.greatest()) {
        let simpler = Valued { form, ..it.clone() };
        let Some(fitted) = at_best(ground, drive, &simpler, visited) else { break };
        if fitted.0.evidence < best.0.evidence - AS_PROBABLE {
            break;
        }
        best = fitted;
    }
    Some(best)
}

/// A formula fitted in the filter, with the values found.
fn at_best(
    ground: &Filtered,
    drive: &Drive,
    it: &Valued,
    visited: &Visited,
) -> Option<(Formula, Valued)> {
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
    let own = scene.drive.effects.iter().find(|effect| effect.id == id)?;
    let value = |name: &str| own.parameters.iter().find(|it| it.0 == name).map(|it| it.1);
    let (form, sign) = it.form.fitted(value);
    let values: Option<Vec<f64>> = coefficients.iter().map(|it| Some(sign * value(it)?)).collect();
    let fitted = Valued { form, coefficients: values?, ..*it };
    let shape = form.written(&visited.names).shape;
    let of_coefficients = coefficients.iter().copied().zip(fitted.coefficients.iter().copied());
    let parameters = of_coefficients.chain(shape).map(|(name, value)| (name.to_owned(), value));
    let formula = Formula {
        complexity: complexity(&text),
        law: FormulaLaw::of(it.form.target, text),
        parameters: parameters.collect(),
        evidence,
        probability: 0.0,
        price: it.price,
        size: optimum.size,
    };
    Some((formula, fitted))
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
