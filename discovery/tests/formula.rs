//! What nobody knows, as a formula: laws that no library has, hidden in recordings.

#[path = "../src/testing.rs"]
mod testing;

use drivescope_discovery::{
    Discovery, Evidence, Formula, FormulaLaw, Measured, Unwatched, Verdict, discover,
};
use drivescope_plant::drive::{Drive, EffectData, LawData};
use drivescope_plant::effects::custom::Target;
use testing::{dr300, loaded, noisy, random_load};

const SDS: [f64; 2] = [0.01, 0.3];
const H: f64 = 1e-3;

fn base() -> Drive {
    let mut drive = dr300();
    drive.motor.k_m = drive.motor.k_e.expect("it has one");
    drive
}

/// What is found of a drive with that law in it, or without any.
fn found(law: Option<(Target, &str)>) -> Discovery {
    found_under(0.0, law)
}

/// The same under a random load of that standard deviation, N m.
fn found_under(load: f64, law: Option<(Target, &str)>) -> Discovery {
    let [estimation, validation] = recorded(law, load);
    discover(&base(), &estimation, &validation, &Unwatched).expect("the base can be fitted")
}

/// A drive with that law in it, recorded twice from rest.
fn recorded(law: Option<(Target, &str)>, load: f64) -> [Evidence; 2] {
    let mut truth = base();
    truth.effects.extend(law.map(|(target, text)| EffectData {
        kind: "custom".into(),
        id: "hidden".into(),
        parameters: Vec::new(),
        law: Some(LawData::Typed { target, text: text.to_owned() }),
    }));
    [(2.0, 5), (1.7, 105)].map(|(rate, seed)| {
        let u = |k: usize| {
            let t = k as f64 * H;
            10.0 * (rate * t).sin() + 6.0 * (3.5 * rate * t).sin() + 5.0 * (11.0 * t).sin().signum()
        };
        let u: Vec<f64> = (0..5000).map(u).collect();
        let random = random_load(u.len(), H, (load, 0.1), seed);
        let recording = noisy(loaded(&truth, u, &random, H), SDS, seed);
        let measured = Measured::new(&base(), &recording).expect("it can be used");
        Evidence { recordings: vec![measured], noise: vec![SDS.to_vec()] }
    })
}

/// The formula of that law among the first three.
fn among_the_first<'a>(answer: &'a Discovery, law: &FormulaLaw) -> &'a Formula {
    assert_eq!(answer.remaining, Verdict::Unknown, "{:?}", answer.ranking);
    let sum: f64 = answer.formulas.iter().map(|it| it.probability).sum();
    assert!((sum - 1.0).abs() < 1e-9, "{sum}");
    let place = answer.formulas.iter().take(3).find(|it| it.law == *law);
    place.unwrap_or_else(|| panic!("{law:?} in {:#?}", answer.formulas))
}

#[test]
fn a_law_of_one_variable_is_found_with_its_coefficient_on_any_number_of_threads() {
    let contact = || found(Some((Target::Voltage, "-0.2 * i * abs(i)")));
    let answer = contact();
    let law = FormulaLaw::Voltage("c * i * abs(i)".to_owned());
    let formula = among_the_first(&answer, &law);
    assert!((formula.parameters["c"] + 0.2).abs() < 0.01, "{formula:?}");
    assert!(formula.evidence > 100.0 && formula.complexity == 4, "{formula:?}");
    let learned = answer.learned.expect("there is a curve");
    assert!(learned.formula.is_some_and(|it| it.contains("abs(i)")));
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool");
    assert_eq!(one.install(contact).formulas, answer.formulas);
}

#[test]
fn a_law_of_two_variables_is_found_that_no_curve_holds() {
    let answer = found(Some((Target::Torque, "8e-5 * i * omega")));
    let law = FormulaLaw::Torque("c * omega * i".to_owned());
    let formula = among_the_first(&answer, &law);
    assert!((formula.parameters["c"] / 8e-5 - 1.0).abs() < 0.05, "{formula:?}");
    assert!(formula.with_values().contains("e-5 * omega * i"), "{}", formula.with_values());
}

#[test]
fn where_nothing_is_hidden_no_formula_is_offered() {
    let answer = found(None);
    assert_eq!((answer.verdict, answer.formulas.len()), (Verdict::None, 0), "{:?}", answer.ranking);
}

/// The library has a drag by the load and one by the square of the speed; neither is what is hidden.
#[test]
fn a_law_that_resembles_one_of_the_library_is_not_taken_for_it() {
    let answer = found(Some((Target::Torque, "-2e-4 * abs(i) * omega")));
    let formula = among_the_first(&answer, &FormulaLaw::Torque("c * omega * abs(i)".to_owned()));
    assert!((formula.parameters["c"] / -2e-4 - 1.0).abs() < 0.05, "{formula:?}");
    assert_eq!((answer.verdict, answer.closer_than), (Verdict::Unknown, None));
    assert!(answer.named.is_empty(), "{:?}", answer.named);
    assert_eq!(answer.ladder.len(), 1, "{:?}", answer.ladder);
}

/// A random load takes what a curve of many values would show, and leaves enough for a form of two.
#[test]
fn what_no_curve_shows_under_a_random_load_is_shown_by_its_form() {
    let answer = found_under(2e-3, Some((Target::Torque, "-2e-4 * omega * exp(-abs(omega) / 80)")));
    assert_eq!((answer.verdict, answer.learned.is_some()), (Verdict::Unknown, false));
    let best = answer.formulas.first().expect("there is one");
    assert!(best.law.parts().0 == Target::Torque && best.evidence > 20.0, "{best:?}");
    let answer = found_under(2e-3, None);
    assert_eq!((answer.verdict, answer.formulas.len()), (Verdict::None, 0), "{:?}", answer.ranking);
}

/// It is 1 % of what the balance holds, and the error on the validation data nearly three times its
/// floor.
#[test]
fn what_is_small_and_explains_all_there_is_is_shown_by_its_form() {
    let answer = found(Some((Target::Torque, "-1e-9 * omega^3")));
    among_the_first(&answer, &FormulaLaw::Torque("c * omega^3".to_owned()));
    assert!(answer.named.is_empty() && answer.learned.is_none(), "{:?}", answer.named);
}
