//! Laws that the user typed and left at their null in the drive file (`parameters = { c = 0 }`):
//! candidates like those of the library, weighed, fitted, ranked and named by the user's own name.

use drivescope_plant::drive::{Drive, EffectData};
use drivescope_plant::effects::law::Info;
use drivescope_plant::effects::registry::Entry;
use drivescope_plant::file::CUSTOM;

use super::candidate::{Candidate, Variant};

/// What is known of any typed law.
static TYPED: Info = Info::new(CUSTOM, "a law of the user", "");

/// The drive without the typed laws that stand at their null in it, and these: what a discovery
/// begins with, and what it ranks among the library.
pub(crate) fn apart(drive: &Drive) -> (Drive, Vec<EffectData>) {
    let mut bare = drive.clone();
    let (at_null, rest) = bare.effects.into_iter().partition(|effect| is_at_null(effect, drive));
    bare.effects = rest;
    (bare, at_null)
}

/// The found drive as the user's file goes on: its effects in their order, typed laws that were not
/// named as they stand there, then what was added; and nothing fixed but what the user fixed (what was
/// frozen for the search, how often a ripple repeats, is theirs to fit).
pub(crate) fn restored(mut found: Drive, of_user: &Drive) -> Drive {
    let mut effects = Vec::new();
    for effect in &of_user.effects {
        let kept = found.effects.iter().position(|other| other.id == effect.id);
        effects.push(kept.map_or_else(|| effect.clone(), |place| found.effects.remove(place)));
    }
    effects.append(&mut found.effects);
    found.effects = effects;
    found.fixed.clone_from(&of_user.fixed);
    found
}

/// One candidate: the coefficients that are zero are its own, the others are its shape.
pub(crate) fn candidate(effect: &EffectData) -> Candidate {
    let coefficients: Vec<String> = zero(effect).map(str::to_owned).collect();
    Candidate {
        name: effect.id.clone(),
        info: &TYPED,
        fails_over: effect.fails_over(),
        id: effect.id.clone(),
        ranges: vec![(f64::NEG_INFINITY, f64::INFINITY); coefficients.len()],
        coefficients,
        variants: vec![Variant { effect: effect.clone() }],
        frozen: Vec::new(),
    }
}

fn zero(effect: &EffectData) -> impl Iterator<Item = &str> {
    effect.parameters.iter().filter(|(_, value)| *value == 0.0).map(|(name, _)| name.as_str())
}

/// Whether it is a typed law that changes nothing, with a coefficient that may be fitted; one that
/// bears the name of a kind of the library would be mistaken for it, and stays in the drive.
fn is_at_null(effect: &EffectData, drive: &Drive) -> bool {
    let values: Vec<f64> = effect.parameters.iter().map(|(_, value)| *value).collect();
    let free = |name: &str| !drive.fixed.contains(&format!("{}.{name}", effect.id));
    Entry::find(&effect.id).is_none()
        && zero(effect).next().is_some()
        && zero(effect).all(free)
        && effect.typed().is_some_and(|law| law.vanishes(&values))
}
