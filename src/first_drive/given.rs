//! Values that a person types from a data sheet: `K_m=0.05,R=2.1`.

use drivescope_plant::drive::Input;
use drivescope_recording::Constant;

use super::FirstDriveError;
use super::names::{FRICTION, split};

/// What may be given: parameters of the motor, and dry friction, SI.
const NAMES: [&str; 7] = ["R", "L", "K_e", "K_m", "J", "B_m", FRICTION];

/// Values by parameter, SI.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Given(Vec<(&'static str, f64)>);

/// Names that benches give the same numbers, folded.
const ALSO: [(&str, &str); 17] = [
    ("ra", "R"),
    ("rm", "R"),
    ("la", "L"),
    ("lm", "L"),
    ("kb", "K_e"),
    ("ke", "K_e"),
    ("k", "K_m"),
    ("kt", "K_m"),
    ("km", "K_m"),
    ("jm", "J"),
    ("jtot", "J"),
    ("b", "B_m"),
    ("bm", "B_m"),
    ("fv", "B_m"),
    ("tc", FRICTION),
    ("fc", FRICTION),
    ("coulombtc", FRICTION),
];

/// What may be given of the numbers that stand beside the signals of a file: the name there, the
/// parameter, and its value.
fn offered(constants: &[Constant]) -> Vec<(&str, &'static str, f64)> {
    let parameter = |name: &str| {
        // Without the groups that it stands in.
        let own = name.rsplit(['.', '/']).next().unwrap_or(name);
        let folded = own.replace('_', "").to_lowercase();
        let also = ALSO.iter().find(|(it, _)| *it == folded).map(|(_, known)| *known);
        NAMES.into_iter().find(|known| known.to_lowercase() == folded).or(also)
    };
    let possible = constants.iter().filter(|it| it.value.is_finite() && it.value > 0.0);
    possible.filter_map(|it| Some((it.name.as_str(), parameter(&it.name)?, it.value))).collect()
}

fn named(offered: &[(&str, &'static str, f64)]) -> Option<String> {
    let each: Vec<String> =
        offered.iter().map(|(name, _, value)| format!("{name} = {value}")).collect();
    (!each.is_empty()).then(|| format!("the file holds {}", each.join(", ")))
}

/// The same for a person; nothing if there is nothing.
pub(crate) fn held(constants: &[Constant]) -> Option<String> {
    let said = named(&offered(constants))?;
    Some(format!("{said}: if that is this drive, in SI units, give it a drive file with them"))
}

/// The same without what was given already, and how to type it.
pub(crate) fn offer(constants: &[Constant], given: &Given) -> Option<String> {
    let mut all = offered(constants);
    all.retain(|(_, parameter, _)| given.0.iter().all(|(known, _)| known != parameter));
    let typed: Vec<String> =
        all.iter().map(|(_, known, value)| format!("{known}={value}")).collect();
    let said = named(&all)?;
    let typed = typed.join(",");
    Some(format!("{said}: if that is this drive, in SI units, take it with --given {typed}"))
}

impl Given {
    /// Of the command line.
    ///
    /// # Errors
    /// [`FirstDriveError::Given`] for what is no value above zero of a known parameter.
    pub(crate) fn parse(text: &str) -> Result<Self, FirstDriveError> {
        let mut given = Vec::new();
        for item in text.split(',').map(str::trim).filter(|item| !item.is_empty()) {
            let wrong =
                || FirstDriveError::Given { item: item.to_owned(), names: NAMES.join(", ") };
            let (name, value) = item.split_once('=').ok_or_else(wrong)?;
            let alias = if name.trim() == split(FRICTION).1 { FRICTION } else { name.trim() };
            let name = NAMES.iter().find(|known| **known == alias).ok_or_else(wrong)?;
            let value: f64 = value.trim().parse().map_err(|_| wrong())?;
            let friction = ["B_m", FRICTION].contains(name);
            if !value.is_finite() || value < 0.0 || (value == 0.0 && !friction) {
                return Err(wrong());
            }
            given.push((*name, value));
        }
        Ok(Self(given))
    }

    /// The value of a parameter; of a voltage-driven motor K_e and K_m stand in for each other.
    pub(crate) fn value(&self, name: &str, input: Input) -> Option<f64> {
        let of = |name: &str| self.0.iter().rev().find(|(it, _)| *it == name).map(|(_, it)| *it);
        let twin = match name {
            "K_e" => Some("K_m"),
            "K_m" => Some("K_e"),
            _ => None,
        };
        of(name).or_else(|| (input == Input::Voltage).then(|| of(twin?))?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_beside_the_signals_are_offered() {
        let constants = [("J", 0.02), ("bench.K_t", 0.05), ("b", 0.0), ("fs", 1000.0), ("Ra", 2.1)]
            .map(|(name, value)| Constant { name: name.to_owned(), value });
        let none = Given::default();
        let said = offer(&constants, &none).expect("there are some");
        assert!(said.contains("bench.K_t = 0.05"), "{said}");
        assert!(said.ends_with("--given J=0.02,K_m=0.05,R=2.1"), "{said}");
        let (_, typed) = said.rsplit_once(' ').expect("words");
        let given = Given::parse(typed).expect("what is offered can be typed");
        assert_eq!(given.value("J", Input::Force), Some(0.02));
        assert_eq!(offer(&constants, &given), None);
        assert!(held(&constants).is_some_and(|it| it.contains("J = 0.02") && !it.contains("--")));
        assert_eq!(offer(&constants[2..4], &none), None);
    }

    #[test]
    fn values_are_read_by_name() {
        let given = Given::parse("K_m=0.05, R = 2.1,T_c=0").expect("right");
        assert_eq!(given.value("R", Input::Voltage), Some(2.1));
        assert_eq!(given.value("K_e", Input::Voltage), Some(0.05));
        assert_eq!(given.value("K_e", Input::Force), None);
        assert_eq!(given.value("coulomb.T_c", Input::Force), Some(0.0));
        for wrong in ["R", "R=", "R=-1", "R=0", "x=1", "R=inf"] {
            let text = Given::parse(wrong).expect_err("wrong").to_string();
            assert!(text.contains(wrong), "{text}");
        }
    }
}
