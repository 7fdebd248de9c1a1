//! Values that a person types from a data sheet: `K_m=0.05,R=2.1`.

use drivescope_plant::drive::Input;

use super::FirstDriveError;

/// What may be given: parameters of the motor, and dry friction, SI.
const NAMES: [&str; 7] = ["R", "L", "K_e", "K_m", "J", "B_m", "coulomb.T_c"];

/// Values by parameter, SI.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Given(Vec<(&'static str, f64)>);

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
            let alias = if name.trim() == "T_c" { "coulomb.T_c" } else { name.trim() };
            let name = NAMES.iter().find(|known| **known == alias).ok_or_else(wrong)?;
            let value: f64 = value.trim().parse().map_err(|_| wrong())?;
            let friction = ["B_m", "coulomb.T_c"].contains(name);
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
