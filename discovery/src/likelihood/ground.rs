//! A fitted drive at its own best, and structures beside it, each at its own.

use drivescope_plant::drive::EffectData;

use super::base::Known;
use super::gram::References;
use super::guess::{ENOUGH, excerpt};
use super::judge::{COARSE, FINE};
use super::optimum::{Law, Optimum, optimum};
use super::randomness::Randomness;
use super::refine::refined;
use super::scene::Scene;
use super::state::{CYCLE, holds_a_cycle};
use super::weigh::beside;
use super::weights::CurveWeight;
use crate::discover::{Oscillation, RandomLoad};
use crate::rms::rms;

/// Sizes of the random load, over that of the base, with which a structure is judged at its best:
/// the load may have taken what a law explains.
const LOADS: [f64; 7] = [20.0, 5.0, 2.0, 1.0, 0.5, 0.2, 0.05];
/// Which of them is the base's.
const OWN: usize = 3;
/// Rounds of a search for the randomness and one for the parameters: each moves the other.
const ROUNDS: usize = 5;

/// Size of the random load, over that of the base, beside which a law whose null is infinite is fitted first.
const LESS: f64 = 0.1;

/// Change of a parameter, ln, beyond which the plant is no longer as it was linearised.
const FAR: f64 = 0.1;

/// The base of a round, as evidence is counted from it.
pub(crate) struct Filtered {
    pub(crate) scene: Scene,
    pub(crate) randomness: Randomness,
    pub(crate) references: References,
    /// ln of the probability of the excerpt that laws are fitted to.
    probability: f64,
    /// Both without a load that oscillates, for structures whose own states stand in its place.
    broad: Option<(Randomness, f64)>,
    /// Evidence of the base at its best.
    pub(crate) base: Optimum,
}

impl Filtered {
    /// Begins at what is random beside a drive that lacked more, where that is known; nothing where
    /// the drive overflows.
    pub(crate) fn of(scene: Scene, known: Option<Randomness>) -> Option<Self> {
        let part = excerpt(&scene);
        let Some(randomness) = known else {
            let (randomness, references) = Randomness::begin(&part)?;
            return Self::at(scene, randomness, references, COARSE);
        };
        let references = part.references(&part.tracks(&randomness)?);
        Self::at(scene, randomness, references, FINE)
    }

    /// What is random but for what oscillates, where something does: that may have been what a law
    /// explains.
    pub(crate) fn broad(&self) -> Randomness {
        self.broad.map_or(self.randomness, |(randomness, _)| randomness)
    }

    /// What is random in the load.
    pub(crate) fn load(&self) -> RandomLoad {
        let (j, random) = (self.scene.drive.motor.j, &self.randomness);
        let oscillation = random.cycle.and_then(|it| {
            let tracks = self.scene.tracks(random)?;
            let ticks = tracks.iter().flat_map(|track| &track.ticks);
            let sd = j * rms(ticks.map(|tick| tick.filtered[CYCLE]));
            Some(Oscillation { sd, hz: it.hz, time: it.s })
        });
        RandomLoad { sd: j * random.load_sd, time: random.load_s, oscillation }
    }

    /// Randomnesses of the base: its own, and that without a load that oscillates.
    pub(crate) fn randomnesses(&self) -> Vec<Randomness> {
        let broad = self.broad.iter().map(|(randomness, _)| *randomness);
        std::iter::once(self.randomness).chain(broad).collect()
    }

    /// The same where every recording has a disturbance of its own of that law.
    pub(crate) fn beside(&self, law: &EffectData, coefficients: &[String]) -> Option<Self> {
        Self::at(self.scene.disturbed(law, coefficients), self.broad(), self.references, FINE)
    }

    fn at(
        scene: Scene,
        mut randomness: Randomness,
        mut references: References,
        mut first: f64,
    ) -> Option<Self> {
        let mut part = excerpt(&scene);
        let mut broad = None;
        for round in 0..ROUNDS {
            let mut searched = match round {
                0 => randomness.sought(&part, &references, first)?,
                _ => randomness.searched(&part, &references, first)?,
            };
            first = FINE;
            if round == 1 && searched.cycle.is_none() {
                let oscillating = searched.oscillating(&part, &references)?;
                if oscillating != searched {
                    let refined = refined(part.clone(), &searched, &references)?;
                    broad = Some((searched, refined.probability));
                }
                searched = oscillating;
            }
            let moved = refined(part.clone(), &searched, &references)?.scene;
            let stays = moved.drive == part.drive;
            (part, randomness) = (moved, searched);
            references = part.references(&part.tracks(&randomness)?);
            // What is random has just been searched for beside these very parameters.
            if stays && round > 0 {
                break;
            }
        }
        let scene = scene.with_values_of(&part);
        let probability = refined(part, &randomness, &references)?.probability;
        let base = in_all_at_its_best(&scene, None, &randomness, &references)?;
        Some(Self { scene, randomness, references, probability, broad, base })
    }

    /// The scene with one of those effects at its own best, and the evidence there: the effects are
    /// start values of the same law, of which the best is followed. `estimated` are the parameters of the
    /// effect that are free, `coefficients` those that are 0 where it vanishes. Nothing where a
    /// law whose null is infinite is less probable than the base.
    pub(crate) fn with(
        &self,
        effects: &[EffectData],
        estimated: &[String],
        coefficients: &[String],
    ) -> Option<(Scene, Optimum)> {
        let mut drive = self.scene.drive.clone();
        drive.effects.extend(effects.first().cloned());
        let oscillates = holds_a_cycle(&drive);
        let own = Some((self.randomness, self.probability))
            .filter(|(it, _)| oscillates || it.cycle.is_none() || self.broad.is_none());
        // What oscillates may be what the law explains.
        let all = own.into_iter().chain(self.broad);
        let ends = all.filter_map(|from| self.with_from(from, effects, estimated, coefficients));
        ends.max_by(|a, b| a.1.all.total_cmp(&b.1.all))
    }

    /// Evidence of a fitted scene where a curve explains what it can; nothing where the drive overflows.
    pub(crate) fn beside_curve(
        &self,
        scene: &Scene,
        law: Option<&Law<'_>>,
        curve: &CurveWeight,
    ) -> Option<Optimum> {
        at_its_best(scene, (law, Some(curve)), &self.randomness, &self.references)
    }

    /// The same where the search begins with that randomness, beside the probability of the base
    /// with it.
    fn with_from(
        &self,
        (randomness, probability): (Randomness, f64),
        effects: &[EffectData],
        estimated: &[String],
        coefficients: &[String],
    ) -> Option<(Scene, Optimum)> {
        let fit =
            |scene: Scene, load: f64| refined(scene, &randomness.scaled(load), &self.references);
        let begin = |effect: &EffectData| {
            let part = excerpt(&self.scene.with(effect, estimated.iter().cloned()));
            // Far from its null a law has to find what the random load has taken for itself: from where it
            // fits beside less of that, too.
            let with_less = || fit(fit(part.clone(), LESS)?.scene, 1.0);
            let far = if coefficients.is_empty() { with_less() } else { None };
            [fit(part, 1.0), far]
        };
        let ends = effects.iter().flat_map(begin).flatten();
        let best = ends.max_by(|a, b| a.probability.total_cmp(&b.probability))?;
        if coefficients.is_empty() && best.probability < probability {
            return None;
        }
        let randomness = randomness.searched(&best.scene, &self.references, FINE)?;
        let part = refined(best.scene, &randomness, &self.references)?.scene;
        let effect = part.drive.effects.last()?;
        let scene = self.scene.with(effect, estimated.iter().cloned()).with_values_of(&part);
        let law = Law { id: &effect.id, coefficients };
        let optimum = in_all_at_its_best(&scene, Some(&law), &randomness, &self.references)?;
        Some((scene, optimum))
    }
}

/// The evidence of a structure at its best, in the recordings of the fit and in all: where all of them
/// move a parameter far, the plant is linearised there too.
fn in_all_at_its_best(
    scene: &Scene,
    law: Option<&Law<'_>>,
    randomness: &Randomness,
    references: &References,
) -> Option<Optimum> {
    let of_fit = at_its_best(scene, (law, None), randomness, references)?;
    if of_fit.moves < FAR {
        return Some(of_fit);
    }
    let part = refined(scene.clone().shortened(ENOUGH), randomness, references);
    let there = part.map(|part| scene.clone().with_values_of(&part.scene));
    let all = there.and_then(|there| at_its_best(&there, (law, None), randomness, references));
    let more = all.filter(|it| it.all > of_fit.all);
    Some(more.map_or(of_fit, |it| of_fit.with_all_of(&it)))
}

/// The evidence of a structure with the random load with which it is most probable, in the recordings
/// of the fit and in all.
fn at_its_best(
    scene: &Scene,
    (law, curve): (Option<&Law<'_>>, Option<&CurveWeight>),
    randomness: &Randomness,
    references: &References,
) -> Option<Optimum> {
    let along = scene.tracks(randomness)?;
    let known = Known::of(scene, &along);
    let taken_out = law.map(|law| law.taken_out(scene, &along));
    let beside = curve.map(|it| beside(scene, &along, it));
    let ln_prior = if holds_a_cycle(&scene.drive) { randomness.ln_prior() } else { 0.0 };
    let with = |load: &f64| {
        let tracks = scene.retraced(&along, &randomness.scaled(*load))?;
        let law = law.zip(taken_out.as_deref());
        let found = optimum(scene, (law, beside.as_ref()), (&tracks, &known), references)?;
        Some(found.with_prior(ln_prior))
    };
    let mut tried: [Option<Option<Optimum>>; LOADS.len()] = [None; LOADS.len()];
    let mut at = |place: usize| *tried[place].get_or_insert_with(|| with(&LOADS[place]));
    let fitted = climbed(&mut at, |it| it.fitted)?;
    // What the recordings held out say is asked under one load, that of all.
    let all = climbed(&mut at, |it| it.all)?;
    Some(fitted.with_all_of(&all))
}

/// From the base's own load on to the side where a structure is more probable, to the best.
fn climbed(
    at: &mut impl FnMut(usize) -> Option<Optimum>,
    of: impl Fn(&Optimum) -> f64,
) -> Option<Optimum> {
    let own = at(OWN)?;
    let mut best = own;
    let smaller: &mut dyn Iterator<Item = usize> = &mut (OWN + 1..LOADS.len());
    let larger: &mut dyn Iterator<Item = usize> = &mut (0..OWN).rev();
    for side in [smaller, larger] {
        for place in side {
            let Some(now) = at(place).filter(|now| of(now) > of(&best)) else { break };
            best = now;
        }
        if of(&best) > of(&own) {
            break;
        }
    }
    Some(best)
}
