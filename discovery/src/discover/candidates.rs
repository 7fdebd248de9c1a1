//! What might be missing: every registered effect that the drive can have and lacks.
//!
//! A candidate stands in the drive at its null, where it changes nothing, and is differentiated
//! by its coefficients there. What the derivative depends on besides (the number of periods of a
//! ripple, a Stribeck speed, a time constant) is a grid of variants, scaled to this drive and
//! these recordings. Effects that vanish at an infinite stiffness have no derivative at their
//! null: their variants are points from which a short refit begins.

use std::f64::consts::TAU;

use drivescope_plant::drive::{Drive, EffectData, Motion};
use drivescope_plant::effects::law::{Info, Place, Variable};
use drivescope_plant::effects::registry::{Entry, REGISTRY};

use super::scales::{SLOW_SPEED, Scales};
use super::typed;
use crate::estimate::Evidence;
use crate::measured::{Measured, Output};

/// Most periods of a ripple a revolution.
const MOST_PERIODS: usize = 48;
/// Shortest spatial period on an axis over its travel: finer ones than this are not searched.
const FINEST_WAVE: f64 = 240.0;
/// Steps of the search for a spatial period a wave over the travel: two neighbours then differ by
/// half a wave at its end.
const STEPS_A_WAVE: f64 = 2.0;
/// Share of the time below a tenth of the fastest speed from which on slow motion was recorded: a
/// shaft that is only ever accelerated spends a tenth there, one that is cruising and reversed
/// quickly less.
const SLOW_ENOUGH: f64 = 0.06;
/// Stribeck speeds over the fastest speed.
const STRIBECK: [f64; 4] = [0.005, 0.015, 0.04, 0.1];
/// Currents over which a voltage drop is rounded, over the greatest current.
const ROUNDED: [f64; 3] = [0.005, 0.02, 0.07];
/// Time constants of slow changes over the length of the recording.
const SLOW: [f64; 3] = [0.25, 0.8, 3.0];
/// Deflections at which bristles slip, rad; on an axis, over its travel.
const BRISTLES: [f64; 4] = [0.003, 0.03, 0.1, 0.3];
/// Natural frequencies of a coupling, Hz.
const COUPLINGS_HZ: [f64; 6] = [8.0, 13.0, 20.0, 30.0, 50.0, 90.0];
/// Damping ratio of a coupling, and of the contact in a gap.
const COUPLING_DAMPING: f64 = 0.05;
const CONTACT_DAMPING: f64 = 0.2;
/// Natural frequency of the contact in a gap, Hz.
const CONTACT_HZ: f64 = 60.0;
/// Shares of the inertia behind a coupling or a gap.
const BEHIND: [f64; 2] = [0.25, 0.5];
/// Gaps, rad; on an axis, over its travel.
const GAPS: [f64; 4] = [0.03, 0.1, 0.2, 0.35];
/// Travel of an axis that counts as one radian of a rotor, m a m.
const AXIS_RADIAN: f64 = 0.02;
/// Temperature of a winding that keeps all heat of a recording, K: it only scales alpha, which is
/// then near that of copper where the resistance rises by a third.
const WARM: f64 = 100.0;

/// An effect at its null with one choice of its shape.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Variant {
    /// Its parameters, the coefficients at their nulls.
    pub(crate) effect: EffectData,
}

/// An effect that may be missing.
#[derive(Debug, Clone)]
pub(crate) struct Candidate {
    /// What it is called in answers: its kind, or the name that the user gave a typed law.
    pub(crate) name: String,
    /// What is known of its kind.
    pub(crate) info: &'static Info,
    /// The variables over which a model without it fails.
    pub(crate) fails_over: Vec<Variable>,
    /// Its name in the drive.
    pub(crate) id: String,
    /// The coefficients that vanish at the null; none where the null is infinite.
    pub(crate) coefficients: Vec<String>,
    /// Least and greatest value of each coefficient.
    pub(crate) ranges: Vec<(f64, f64)>,
    /// Choices of its shape, at least one.
    pub(crate) variants: Vec<Variant>,
    /// Parameters that stay as the variant has them: whole numbers.
    pub(crate) frozen: Vec<&'static str>,
}

/// An effect that is not judged, and why.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct NotJudged {
    /// The effect.
    pub effect: String,
    /// Why, for a person.
    pub reason: String,
    /// Whether a person should hear of it unasked: other recordings could show it, or it is a law
    /// that the user typed.
    #[serde(skip)]
    pub worth_saying: bool,
}

/// The candidates of a drive with these recordings, those of the laws that the user typed among
/// them, and what cannot be judged.
pub(crate) fn candidates(
    drive: &Drive,
    evidence: &Evidence,
    scales: &Scales,
    typed: &[EffectData],
) -> (Vec<Candidate>, Vec<NotJudged>) {
    let is_in = |one: &EffectData| drive.effects.iter().any(|effect| effect.id == one.id);
    let left = typed.iter().filter(|one| !is_in(one));
    let (mut found, mut not) = (left.map(typed::candidate).collect::<Vec<_>>(), Vec::new());
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
        } else if let Some(reason) = unseen(entry, drive, evidence, scales) {
            not.push(own(reason, true));
        } else {
            found.push(candidate(entry, drive, scales));
        }
    }
    (found, not)
}

/// One candidate by its effect.
pub(crate) fn candidate(entry: &'static Entry, drive: &Drive, scales: &Scales) -> Candidate {
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
    let variants =
        shapes(entry, drive, scales).into_iter().map(|shape| variant(entry, &id, &shape)).collect();
    let periodic = entry.parameters.iter().any(|parameter| parameter.name == "N");
    let frozen = if periodic && drive.motion == Motion::Rotary { vec!["N"] } else { Vec::new() };
    let (name, fails_over) = (info.id.to_owned(), info.fails_over.to_vec());
    Candidate { name, info, fails_over, id, coefficients, ranges, variants, frozen }
}

/// Why the effect is no candidate for this drive, whatever is recorded.
fn needless(entry: &Entry, drive: &Drive) -> Option<&'static str> {
    let info = entry.info;
    let has_kind = |kind: &str| drive.effects.iter().any(|effect| effect.kind == kind);
    if info.id == "quantisation" {
        return Some(
            "the steps of a sensor are read off its values, not fitted: they are part of the noise",
        );
    }
    if entry.parameters.is_empty() || info.nulls.is_empty() {
        return Some("it has no null from which it could be weighed");
    }
    if info.id == "presliding" && !drive.effects.iter().any(dry) {
        return Some("bends the dry friction, and the drive has none: add coulomb first");
    }
    (info.id == "coulomb" && has_kind("coulomb")).then_some("the drive has it")
}

/// Why these recordings cannot show the effect.
fn unseen(entry: &Entry, drive: &Drive, evidence: &Evidence, scales: &Scales) -> Option<String> {
    let has = |one: &Measured, output| one.output(output).is_some();
    let any = |wanted: &[Output]| {
        evidence.recordings.iter().all(|one| wanted.iter().any(|output| has(one, *output)))
    };
    let info = entry.info;
    if info.fails_over.contains(&Variable::Theta) && !any(&[Output::Speed, Output::Position]) {
        return Some("needs the position or the speed, and neither was recorded".to_owned());
    }
    if info.acts_on == [Place::Sensor] {
        let shows_current = info.id == "current_offset";
        let wanted = if shows_current { Output::Current } else { Output::Speed };
        if !any(&[wanted]) {
            let signal = if shows_current { "i" } else { "omega" };
            return Some(format!("distorts the signal {signal}, which was not recorded"));
        }
    }
    if info.id == "stribeck" && scales.slow < SLOW_ENOUGH {
        let (share, limit) = (100.0 * scales.slow, SLOW_SPEED * scales.speed);
        let unit = if drive.motion == Motion::Linear { "m/s" } else { "rad/s" };
        return Some(format!(
            "shows in slow motion only, and nothing slow enough was recorded: {share:.0} % of the \
             time is below {limit:.3} {unit}, a tenth of the fastest speed, and that in passing; \
             record slow reversals"
        ));
    }
    None
}

fn dry(effect: &EffectData) -> bool {
    Entry::find(&effect.kind).is_some_and(|entry| entry.info.dry)
}

/// The effect with those values of its shape, nominal ones for the rest and nulls for its
/// coefficients.
fn variant(entry: &Entry, id: &str, shape: &[(&str, f64)]) -> Variant {
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

/// The grid of shapes of an effect.
fn shapes(entry: &Entry, drive: &Drive, scales: &Scales) -> Vec<Vec<(&'static str, f64)>> {
    let single = |name: &'static str, values: Vec<f64>| {
        values.into_iter().map(|value| vec![(name, value)]).collect::<Vec<_>>()
    };
    let of_current = |name| single(name, ROUNDED.map(|share| share * scales.current).to_vec());
    // One radian of a rotor, or the way of an axis that compares with it.
    let radian = match drive.motion {
        Motion::Rotary => 1.0,
        Motion::Linear => AXIS_RADIAN * scales.travel,
    };
    let inertia = drive.motor.j;
    match entry.info.id {
        // Once a revolution it is an unbalance.
        "cogging" => single("N", periods(drive.motion, 2, scales)),
        "torque_ripple" => single("N", periods(drive.motion, 1, scales)),
        "stribeck" => single("omega_s", STRIBECK.map(|share| share * scales.speed).to_vec()),
        "brush_drop" => of_current("i_b"),
        "dead_time" => of_current("i_d"),
        "friction_drift" => single("tau", SLOW.map(|share| share * scales.duration_s).to_vec()),
        "winding_heating" => {
            let capacity = drive.motor.r.unwrap_or(1.0) * scales.heat / WARM;
            let of = |share: f64| {
                vec![("C_th", capacity), ("R_th", share * scales.duration_s / capacity)]
            };
            SLOW.map(of).to_vec()
        }
        "presliding" => {
            let level: f64 = drive
                .effects
                .iter()
                .flat_map(|effect| &effect.parameters)
                .filter(|(name, _)| name == "T_c")
                .map(|(_, level)| *level)
                .sum();
            single("sigma_0", BRISTLES.map(|share| level / (share * radian)).to_vec())
        }
        "flexible_coupling" => {
            let mut all = Vec::new();
            for ratio in BEHIND {
                for hz in COUPLINGS_HZ {
                    let (k, d) = contact(inertia, ratio, hz, COUPLING_DAMPING);
                    all.push(vec![("k", k), ("d", d), ("ratio", ratio)]);
                }
            }
            all
        }
        "backlash" => {
            let mut all = Vec::new();
            for ratio in BEHIND {
                let (k, d) = contact(inertia, ratio, CONTACT_HZ, CONTACT_DAMPING);
                for gap in GAPS {
                    all.push(vec![("k", k), ("d", d), ("gap", gap * radian), ("ratio", ratio)]);
                }
            }
            all
        }
        _ => vec![Vec::new()],
    }
}

/// Stiffness and damping between two masses of that natural frequency.
fn contact(inertia: f64, ratio: f64, hz: f64, damping: f64) -> (f64, f64) {
    let reduced = inertia * ratio * (1.0 - ratio);
    let rate = TAU * hz;
    (reduced * rate * rate, 2.0 * damping * reduced * rate)
}

/// Periods a revolution, or wave numbers of an axis, rad/m.
fn periods(motion: Motion, least: usize, scales: &Scales) -> Vec<f64> {
    match motion {
        Motion::Rotary => (least..=MOST_PERIODS).map(|n| n as f64).collect(),
        Motion::Linear => {
            let waves = (FINEST_WAVE * STEPS_A_WAVE) as usize;
            let one = TAU / scales.travel.max(f64::MIN_POSITIVE);
            (4..=waves).map(|k| k as f64 / STEPS_A_WAVE * one).collect()
        }
    }
}

impl Candidate {
    /// Whether the user typed it.
    pub(crate) fn is_typed(&self) -> bool {
        self.variants[0].effect.law.is_some()
    }

    /// Its parameters.
    pub(crate) fn parameters(&self) -> impl ExactSizeIterator<Item = &str> {
        self.variants[0].effect.parameters.iter().map(|(name, _)| name.as_str())
    }

    /// Names in the drive of its parameters that are estimated.
    pub(crate) fn estimated(&self) -> Vec<String> {
        let free = self.parameters().filter(|name| !self.frozen.contains(name));
        free.map(|name| format!("{}.{name}", self.id)).collect()
    }

    /// An effect of its kind with coefficients times a factor.
    pub(crate) fn scaled(&self, effect: &EffectData, factor: f64) -> EffectData {
        let mut scaled = effect.clone();
        let own = scaled.parameters.iter_mut().filter(|(it, _)| self.coefficients.contains(it));
        own.for_each(|(_, value)| *value *= factor);
        scaled
    }

    /// Whether it has a derivative at its null.
    pub(crate) fn is_linear(&self) -> bool {
        !self.coefficients.is_empty()
    }

    /// The drive with this variant in it.
    pub(crate) fn added(&self, drive: &Drive, variant: &Variant) -> Drive {
        let mut with = drive.clone();
        with.effects.push(variant.effect.clone());
        for name in &self.frozen {
            with.fixed.push(format!("{}.{name}", self.id));
        }
        with
    }
}
