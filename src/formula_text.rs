//! A formula on the command line: `formula:torque = c * omega * exp(-abs(omega) / a); a = 12.5`.
//!
//! What has a value behind the semicolon is a constant of the shape; the other names are coefficients
//! that begin at 0. All of them are fitted.

use drivescope_discovery::Formula;
use drivescope_plant::drive::{Drive, EffectData, LawData};
use drivescope_plant::effects::custom::{Law, LawError, Target};
use drivescope_plant::file::CUSTOM;

use crate::failure::Failure;
use crate::report::words::significant;

/// What stands before a formula where an effect is asked for.
pub(crate) const PREFIX: &str = "formula:";
/// What the effect is called in the drive.
const ID: &str = "formula";
/// Digits of the constants of a shape.
const DIGITS: i32 = 4;

/// What a formula gives, as in a drive file.
pub(crate) fn target(formula: &Formula) -> &'static str {
    let (target, _) = formula.law.parts();
    Target::ALL.iter().find(|(_, other)| *other == target).map_or("", |(key, _)| key)
}

/// What a formula gives and its text, as in a drive file.
pub(crate) fn law(formula: &Formula) -> String {
    format!("{} = {}", target(formula), formula.law.parts().1)
}

/// A formula as the command line takes it, behind [`PREFIX`].
pub(crate) fn text(formula: &Formula) -> String {
    let constant = |(name, value): (&str, f64)| format!("{name} = {}", significant(value, DIGITS));
    let shape: Vec<String> = formula.shape().map(constant).collect();
    let shape = if shape.is_empty() { String::new() } else { format!("; {}", shape.join(", ")) };
    law(formula) + &shape
}

/// The effect of a formula, of which what stands behind [`PREFIX`] is given, at its null.
///
/// # Errors
/// [`Failure::Usage`] for a text that is no formula, or one that has no null.
pub(crate) fn effect(given: &str, drive: &Drive) -> Result<EffectData, Failure> {
    let wrong = |what: String| Failure::Usage {
        what: format!("`{PREFIX}{given}`: {what}"),
        instead: format!(
            "give it as `{PREFIX}torque = c * omega * exp(-abs(omega) / a); a = 12.5`, constants of \
             the shape with their values and coefficients without; `drivescope effects {CUSTOM}` says \
             what a law may hold"
        ),
    };
    let (law, shape) = given.split_once(';').unwrap_or((given, ""));
    let (key, law) =
        law.split_once('=').ok_or_else(|| wrong("it does not say what it gives".to_owned()))?;
    let known = Target::ALL.iter().find(|(other, _)| *other == key.trim());
    let (_, target) = known.ok_or_else(|| wrong(format!("a law cannot give `{}`", key.trim())))?;
    let mut shapes = Vec::new();
    for item in shape.split(',').map(str::trim).filter(|it| !it.is_empty()) {
        let parsed = item.split_once('=').and_then(|(name, value)| {
            let value = value.trim().parse::<f64>().ok().filter(|it| it.is_finite())?;
            Some((name.trim().to_owned(), value))
        });
        shapes.push(parsed.ok_or_else(|| wrong(format!("`{item}` is no `name = value`")))?);
    }
    let text = law.trim();
    let mut parameters: Vec<(String, f64)> = Vec::new();
    let law = loop {
        let names: Vec<String> =
            parameters.iter().chain(&shapes).map(|(name, _)| name.clone()).collect();
        match Law::parse(*target, text, &names) {
            Ok(law) => break law,
            Err(LawError::Name { name, .. }) => parameters.push((name, 0.0)),
            Err(error) => return Err(wrong(error.to_string())),
        }
    };
    if parameters.is_empty() {
        return Err(wrong("it has no coefficient".to_owned()));
    }
    let coefficients: Vec<String> =
        parameters.iter().map(|(name, _)| format!("`{name}`")).collect();
    parameters.append(&mut shapes);
    let values: Vec<f64> = parameters.iter().map(|(_, value)| *value).collect();
    if !law.vanishes(&values) {
        return Err(wrong("it does not vanish where its coefficients are 0".to_owned()));
    }
    // A mistyped variable, or a shape without its value, is a coefficient that multiplies another.
    let does_nothing = |k: &usize| {
        let mut alone = values.clone();
        alone[*k] = 1.0;
        law.vanishes(&alone)
    };
    if let Some(k) = (0..coefficients.len()).find(does_nothing) {
        let all = coefficients.join(", ");
        return Err(wrong(format!(
            "{} does nothing alone: {all} are no variables of a drive and have no value",
            coefficients[k]
        )));
    }
    let id = drive.free_id(ID);
    let law = Some(LawData::Typed { target: *target, text: text.to_owned() });
    Ok(EffectData { kind: CUSTOM.to_owned(), id, parameters, law })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drive() -> Drive {
        let text = include_str!("../scenarios/drives/dr300.toml");
        Drive::parse(text, "dr300.toml").expect("a right drive file")
    }

    #[test]
    fn a_mistyped_variable_is_no_coefficient() {
        for (given, said) in
            [("torque = c * omeg^3", "`c`, `omeg`"), ("torque = c * abs(i)^n", "`n`")]
        {
            let failure = effect(given, &drive()).expect_err("it is wrong").to_string();
            assert!(failure.contains(said), "{failure}");
        }
    }

    #[test]
    fn names_without_a_value_are_coefficients() {
        let given = "torque = (c + d * i) * omega * exp(-abs(omega) / a); a = 12.5";
        let effect = effect(given, &drive()).expect("it is right");
        let named = |name: &str, value| (name.to_owned(), value);
        assert_eq!(effect.parameters, [named("c", 0.0), named("d", 0.0), named("a", 12.5)]);
        assert_eq!((effect.kind.as_str(), effect.id.as_str()), (CUSTOM, "formula"));
        let mut with = drive();
        with.effects.push(effect);
        let other = super::effect("voltage = c * i^3", &with).expect("it is right");
        assert_eq!(other.id, "formula_2");
    }

    #[test]
    fn what_is_no_formula_is_said() {
        for (given, word) in [
            ("c * omega", "does not say"),
            ("power = c * omega", "cannot give"),
            ("torque = c * omega; a", "name = value"),
            ("torque = c * omega +", "expected"),
            ("torque = 2 * omega", "no coefficient"),
            ("torque = c * omega + a; a = 3", "vanish"),
        ] {
            let error = effect(given, &drive()).expect_err("it is wrong").to_string();
            assert!(error.contains(word), "{given}: {error}");
        }
    }
}
