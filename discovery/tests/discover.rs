//! The loop from recordings that the plant simulates to a name, or to none.

#[path = "../src/testing.rs"]
mod testing;

use drivescope_discovery::{
    Balance, Discovery, Error, Evidence, Measured, Step, Unwatched, Verdict, Watch, add, bic_of,
    discover,
};
use drivescope_plant::drive::{Drive, EffectData, LawData};
use drivescope_plant::effects::custom::Target;
use drivescope_plant::effects::registry::Entry;
use drivescope_recording::Recording;
use testing::{dr300, driven, loaded, noisy, random_load};

const SDS: [f64; 2] = [0.01, 0.3];
const H: f64 = 1e-3;
/// Error of a right model: 1, within five of its standard deviations.
const FLOOR: f64 = 1.04;

fn base() -> Drive {
    let mut drive = dr300();
    drive.motor.k_m = drive.motor.k_e.expect("it has one");
    drive
}

fn with(kind: &str, values: &[f64]) -> Drive {
    let entry = Entry::find(kind).expect("the library has it");
    let names = entry.parameters.iter().map(|it| it.name.to_owned());
    let mut drive = base();
    let parameters = names.zip(values.iter().copied()).collect();
    drive.effects.push(EffectData { kind: kind.into(), id: kind.into(), parameters, law: None });
    drive
}

fn input(samples: usize, rate: f64) -> Vec<f64> {
    let u = |k: usize| {
        let t = k as f64 * H;
        10.0 * (rate * t).sin() + 6.0 * (3.5 * rate * t).sin() + 5.0 * (11.0 * t).sin().signum()
    };
    (0..samples).map(u).collect()
}

fn evidence(drive: &Drive, recording: &Recording) -> Evidence {
    let measured = Measured::new(drive, recording).expect("it can be used");
    Evidence { recordings: vec![measured], noise: vec![SDS.to_vec()] }
}

/// Estimation and validation data of a machine, as its base sees them.
fn recorded(truth: &Drive, load: bool, seed: u64) -> [Evidence; 2] {
    [(2.0, 0), (1.7, 100)].map(|(rate, more)| {
        let u = input(5000, rate);
        let recording = if load {
            let load = random_load(u.len(), H, (2e-3, 0.1), seed + more);
            loaded(truth, u, &load, H)
        } else {
            driven(truth, u, H)
        };
        evidence(&base(), &noisy(recording, SDS, seed + more))
    })
}

fn found(truth: &Drive, load: bool, seed: u64) -> Discovery {
    let [estimation, validation] = recorded(truth, load, seed);
    discover(&base(), &estimation, &validation, &Unwatched).expect("the base can be fitted")
}

#[test]
fn a_hidden_effect_is_named_and_its_absence_too() {
    let answer = found(&with("unbalance", &[0.003, 0.002]), false, 1);
    assert_eq!((answer.verdict, answer.named), (Verdict::Named, vec!["unbalance".to_owned()]));
    let last = answer.ladder.last().expect("it has a base");
    assert!(last.error < FLOOR && last.validation_error < FLOOR, "{:?}", answer.ladder);
    assert!(answer.ladder[0].validation_error > 1.1 * last.validation_error);
    // The same without what was hidden: nothing is named.
    let answer = found(&base(), false, 1);
    assert_eq!((answer.verdict, answer.named.len()), (Verdict::None, 0), "{:?}", answer.ranking);
}

#[test]
fn what_is_named_has_a_probability_and_a_size_under_a_random_load_too() {
    for load in [false, true] {
        let answer = found(&with("unbalance", &[0.003, 0.002]), load, 3);
        assert_eq!(answer.named, ["unbalance"], "{:?}", answer.ranking);
        let named = &answer.ranking[0];
        assert!(named.probability > 0.96 && named.probability < 0.98, "{named:?}");
        // 3.6 mN m over a resistance to motion of some 20 mN m.
        assert!((0.05..0.5).contains(&named.size), "{named:?}");
        let answer = found(&base(), load, 3);
        let said = (answer.verdict, answer.named.len());
        assert_eq!(said, (Verdict::None, 0), "{:?}", answer.ranking);
    }
}

#[test]
fn an_offset_of_the_current_sensor_is_no_load() {
    // The balance of torques sees the same of both, but behind the sensor.
    let answer = found(&with("current_offset", &[0.3]), false, 5);
    assert!(answer.observer.hz > 0.0, "the error of the motion would tell it");
    assert_eq!(answer.named, ["current_offset"], "{:?}", answer.ranking);
    let last = answer.ladder.last().expect("it has a base");
    assert!(last.validation_error < 1.1, "{:?}", answer.ladder);
    let answer = found(&with("constant_load", &[0.3 * base().motor.k_m]), false, 5);
    assert_eq!(answer.named, ["constant_load"], "{:?}", answer.ranking);
}

#[test]
fn both_of_two_effects_are_named_where_the_second_shows_over_other_variables() {
    let mut truth = with("asymmetric_friction", &[0.003, 1e-5]);
    let lag = with("speed_sensor_lag", &[0.015]).effects.pop().expect("it was added");
    truth.effects.push(lag);
    let answer = found(&truth, false, 7);
    assert_eq!(answer.named, ["speed_sensor_lag", "asymmetric_friction"], "{:?}", answer.ranking);
    let last = answer.ladder.last().expect("it has a base");
    assert!(last.error < FLOOR && last.validation_error < FLOOR, "{:?}", answer.ladder);
}

/// Stiffness and damping between the rotor and what hangs on it, of that natural frequency.
fn joint(hz: f64, damping: f64, ratio: f64) -> [f64; 2] {
    let reduced = base().motor.j * ratio * (1.0 - ratio);
    let rate = std::f64::consts::TAU * hz;
    [reduced * rate * rate, 2.0 * damping * reduced * rate]
}

#[test]
fn play_is_told_from_a_soft_coupling_and_fitted_to_the_floor() {
    let ([k, d], gap, ratio) = (joint(55.0, 0.2, 0.5), 0.3, 0.5);
    let answer = found(&with("backlash", &[k, d, gap, ratio]), false, 8);
    assert_eq!(answer.named, ["backlash"], "{:?}", answer.ranking);
    let last = answer.ladder.last().expect("it has a base");
    assert!(last.error < FLOOR && last.validation_error < 1.1 * FLOOR, "{:?}", answer.ladder);
    let play = answer.parameters.iter().find(|it| it.name == "backlash.gap").expect("it is there");
    assert!((play.value / gap - 1.0).abs() < 0.02, "{play:?}");
    // The coupling stands for it and is refused; that which excludes it is always fitted.
    let other = answer.ranking.iter().find(|it| it.effect == "flexible_coupling");
    assert!(other.is_some_and(|it| it.refused.is_some()), "{:?}", answer.ranking);
}

#[test]
fn a_soft_coupling_is_told_from_play_under_a_random_load() {
    let ([k, d], ratio) = (joint(17.0, 0.05, 0.35), 0.35);
    let answer = found(&with("flexible_coupling", &[k, d, ratio]), true, 9);
    assert_eq!(answer.named, ["flexible_coupling"], "{:?}", answer.ranking);
    let stiffness =
        answer.parameters.iter().find(|it| it.name == "flexible_coupling.k").expect("it is there");
    assert!((stiffness.value / k - 1.0).abs() < 0.05, "{stiffness:?}");
}

#[test]
fn a_drive_with_nothing_free_is_still_told_what_it_lacks() {
    let [estimation, validation] = recorded(&with("unbalance", &[0.003, 0.002]), false, 1);
    let mut known = base();
    known.fixed = known.parameters().into_iter().map(|it| it.name).collect();
    let answer = discover(&known, &estimation, &validation, &Unwatched).expect("it can be run");
    assert_eq!(answer.named, ["unbalance"], "{:?}", answer.ranking);
    let [estimation, validation] = recorded(&base(), false, 1);
    let answer = discover(&known, &estimation, &validation, &Unwatched).expect("it can be run");
    assert_eq!(answer.verdict, Verdict::None, "{:?}", answer.ranking);
}

/// A typed law.
fn typed(id: &str, target: Target, text: &str, parameters: &[(&str, f64)]) -> EffectData {
    let parameters = parameters.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
    let law = Some(LawData::Typed { target, text: text.to_owned() });
    EffectData { kind: "custom".into(), id: id.into(), parameters, law }
}

/// A contact whose resistance grows with the current.
fn contact(c: f64) -> EffectData {
    typed("contact", Target::Voltage, "-c * i * abs(i)", &[("c", c)])
}

#[test]
fn a_typed_law_at_its_null_is_ranked_among_the_library() {
    let mut truth = base();
    truth.effects.push(contact(0.2));
    let [estimation, validation] = recorded(&truth, false, 5);
    // Two ideas of the user: one is right, one is not.
    let mut drive = base();
    drive.effects.insert(
        0,
        typed("swell", Target::Torque, "-w * sin(omega / s)", &[("w", 0.0), ("s", 30.0)]),
    );
    drive.effects.push(contact(0.0));
    let answer = discover(&drive, &estimation, &validation, &Unwatched).expect("it can be fitted");
    assert_eq!(answer.named, ["contact"], "{:?}", answer.ranking);
    let last = answer.ladder.last().expect("it has a base");
    assert!(last.error < FLOOR && last.validation_error < FLOOR, "{:?}", answer.ladder);
    let ids: Vec<&str> = answer.drive.effects.iter().map(|effect| effect.id.as_str()).collect();
    let given: Vec<&str> = drive.effects.iter().map(|effect| effect.id.as_str()).collect();
    assert_eq!(ids, given, "in the order of the file");
    assert_eq!(answer.drive.effects[0], drive.effects[0], "as it was");
    let all = answer.drive.parameters();
    let c = all.iter().find(|it| it.name == "contact.c").expect("it is there");
    assert!((c.value - 0.2).abs() < 0.01, "{c:?}");
    let estimated = answer.parameters.iter().find(|it| it.name == c.name).expect("it was fitted");
    assert_eq!(estimated.before, 0.0, "as in the file");
    // The user's choice, too; and without anything hidden neither is named.
    let added = add(&drive, "contact", &estimation, &validation, &Unwatched).expect("it is there");
    assert_eq!((added.named.len(), added.ladder.len()), (1, 2));
    let found = add(&answer.drive, "contact", &estimation, &validation, &Unwatched);
    assert!(matches!(found, Err(Error::CannotAdd { .. })), "it has a value");
    let [estimation, validation] = recorded(&base(), false, 5);
    let answer = discover(&drive, &estimation, &validation, &Unwatched).expect("it can be fitted");
    assert_eq!((answer.verdict, answer.named.len()), (Verdict::None, 0), "{:?}", answer.ranking);
    assert_eq!(answer.drive.effects.last(), drive.effects.last());
}

#[test]
fn what_nobody_knows_stays_beside_what_is_named() {
    // A brush drop beside a contact whose resistance grows with the current, which no law of the
    // library has.
    let mut truth = with("brush_drop", &[0.6, 0.1]);
    truth.effects.push(contact(0.2));
    let [estimation, validation] = recorded(&truth, false, 5);
    let answer = discover(&base(), &estimation, &validation, &Unwatched).expect("it can be fitted");
    assert_eq!(answer.named, ["brush_drop"], "{:?}", answer.ranking);
    assert_eq!(answer.remaining, Verdict::Unknown, "{:?}", answer.ranking);
    // Without the brush drop nothing is named, and the curve tells what is missing.
    let mut truth = base();
    truth.effects.push(contact(0.2));
    let [estimation, validation] = recorded(&truth, false, 5);
    let answer = discover(&base(), &estimation, &validation, &Unwatched).expect("it can be fitted");
    assert_eq!((answer.verdict, answer.named.len()), (Verdict::Unknown, 0), "{:?}", answer.ranking);
    assert_eq!(answer.ladder.len(), 1, "{:?}", answer.ladder);
    let learned = answer.learned.expect("there is a curve");
    assert_eq!((learned.balance, learned.over), (Balance::Voltage, "i"));
    assert!(learned.excess_removed > 0.9, "{learned:?}");
}

#[test]
fn a_random_load_is_no_effect_and_hides_none() {
    for seed in [1, 2] {
        let answer = found(&base(), true, seed);
        assert!(answer.named.is_empty(), "{:?}", answer.ranking);
    }
    let answer = found(&with("brush_drop", &[0.6, 0.1]), true, 3);
    let sets: Vec<&String> = answer
        .ranking
        .iter()
        .filter(|it| it.refused.is_none())
        .flat_map(|it| it.confusion_set.iter().chain([&it.effect]))
        .collect();
    assert!(sets.iter().any(|id| *id == "brush_drop"), "{sets:?}: {:?}", answer.ranking);
}

#[test]
fn one_effect_is_added_measured_and_refused() {
    let truth = with("current_offset", &[0.1]);
    let [estimation, validation] = recorded(&truth, false, 5);
    let add = |kind| add(&base(), kind, &estimation, &validation, &Unwatched);
    let added = add("current_offset").expect("it can be added");
    assert_eq!(added.ladder.len(), 2);
    let offset = added.drive.parameters();
    let offset = offset.iter().find(|it| it.name == "current_offset.i_0").expect("added");
    assert!((offset.value - 0.1).abs() < 0.005, "{offset:?}");
    let before =
        |name: &str| added.parameters.iter().find(|it| it.name == name).map(|it| it.before);
    assert_eq!(before("R"), base().motor.r, "as in the file");
    assert!(before("current_offset.i_0").is_some_and(f64::is_nan), "the file had none");
    assert!(matches!(add("viscous"), Err(Error::CannotAdd { .. })), "it is B_m");
    let gain = bic_of(&base(), "current_offset", &estimation, &validation).expect("it is known");
    assert!(gain > 100.0, "{gain}");
    let other = bic_of(&base(), "unbalance", &estimation, &validation).expect("it is known");
    assert!(other < 20.0, "{other}");
}

/// What nobody programmed, in a form that only a curve with a factor, over a magnitude or in the flux
/// holds: it is shown, it can be added, and the error falls.
#[test]
fn every_curve_of_the_state_is_added_as_it_was_shown() {
    let weak_field = typed("w", Target::Flux, "-c * abs(omega)", &[("c", 1.2e-3)]);
    let sticky = typed(
        "w",
        Target::Torque,
        "-c * tanh(omega / 0.5) * (1 - cos(abs(i) / a))",
        &[("c", 6e-3), ("a", 0.4)],
    );
    for (law, balance, over, times) in [
        (weak_field, Balance::Flux, "abs(omega)", None),
        (sticky, Balance::Torque, "abs(i)", Some("sign(omega)")),
    ] {
        let mut truth = base();
        truth.effects.push(law);
        let [estimation, validation] = recorded(&truth, false, 5);
        let answer = discover(&base(), &estimation, &validation, &Unwatched).expect("it is fitted");
        assert_eq!(answer.verdict, Verdict::Unknown, "{:?}", answer.ranking);
        let learned = answer.learned.expect("there is a curve");
        let found = (learned.balance, learned.over, learned.times);
        assert_eq!(found, (balance, over, times), "{learned:?}");
        assert!(learned.excess_removed > 0.9, "{learned:?}");
        let added = add(&base(), "learned", &estimation, &validation, &Unwatched).expect("added");
        let excess = |step: usize| added.ladder[step].validation_error.powi(2) - 1.0;
        assert!(excess(1) < 0.2 * excess(0), "{} and {}", excess(1), excess(0));
        let effect = added.drive.effects.last().expect("it was added");
        let values: Vec<f64> = effect.parameters.iter().map(|(_, value)| *value).collect();
        // What is drawn and what is added have one sign: here the fast end or the great current loses.
        let fast = |values: &[f64]| values[values.len() - 2] - values[0];
        assert!(fast(&values) < 0.0 && fast(&learned.values) < 0.0, "{values:?} {learned:?}");
    }
}

/// Ends the loop at its first word.
struct Impatient;

impl Watch for Impatient {
    fn step(&self, _: &Step<'_>) {}

    fn stopped(&self) -> bool {
        true
    }
}

#[test]
fn a_loop_that_is_stopped_names_nothing() {
    let [estimation, validation] = recorded(&with("unbalance", &[0.003, 0.002]), false, 6);
    let answer = discover(&base(), &estimation, &validation, &Impatient).expect("the base fits");
    assert_eq!((answer.named.len(), answer.ladder.len()), (0, 1));
}

/// Beside a ripple that was named, a random load took what a constant load explains: the filter sought
/// it from parameters fitted beside that load, and "none" was said at eight times the floor.
#[test]
fn what_a_random_load_would_take_is_found_by_the_free_run() {
    let mut truth = with("torque_ripple", &[3.0, 0.03, -0.04]);
    truth.effects.extend(with("constant_load", &[4e-3]).effects.pop());
    let answer = found(&truth, false, 6);
    assert_eq!(answer.named, ["torque_ripple", "constant_load"], "{:?}", answer.ranking);
    let last = answer.ladder.last().expect("it has a base");
    assert!(last.error < FLOOR && last.validation_error < FLOOR, "{:?}", answer.ladder);
}
