//! Where every value of a first drive comes from, and what to do about those that the recording does
//! not tell.

use drivescope_discovery::{Begun, Estimate};
use drivescope_plant::drive::{Drive, Input};

use super::names::{FRICTION, OFFSET};
use super::{Choice, Constant, Given, Origin, Value};

const BY_BALANCES: &str = "estimated: least squares on the balances";
const BY_FIT: &str = "estimated: least squares on the balances, then a fit";
const MEASURE_R: &str = "measure the resistance between the terminals";
const MEASURE_L: &str =
    "take it from the data sheet; a fit finds it if the recording is fast enough";
const NEEDS_EXCITATION: &str = "take it from the data sheet, or record steps and reversals";
const NEEDS_ACCELERATION: &str =
    "the recording does not tell it and it is kept; record steps, or take it from the data sheet";
const NEEDS_CURRENT: &str =
    "without a current it cannot be told from K; a data sheet or a coasting run tells";
const NEEDS_KNOWN_K: &str =
    "take it from the data sheets of amplifier and motor: all other values are ratios to it";
const IS_TORQUE: &str = "1: the torque itself drives";
const DATA_SHEET: &str = "given: typed from a data sheet";

/// Every parameter of the drive with what is known of it.
pub(super) fn values(
    drive: &Drive,
    begun: &Begun,
    estimates: Option<&[Estimate]>,
    choice: &Choice,
    given: &Given,
) -> Vec<Value> {
    let names = ["R", "L", "K_e", "K_m", "J", "B_m", FRICTION, OFFSET];
    let all = drive.parameters();
    let by_voltage_alone =
        choice.input == Input::Voltage && !begun.identified.iter().any(|it| it.name == "R");
    let of = |name: &'static str| {
        let known = all.iter().find(|it| it.name == name)?;
        let tied = name == "K_m" && drive.motor.tie_k;
        let source = if tied { "K_e" } else { name };
        let begun = begun.identified.iter().find(|it| it.name == source);
        let fitted = estimates.and_then(|all| all.iter().find(|it| it.name == source));
        let fitted = fitted.filter(|_| begun.is_some());
        let (origin, std_error) = if given.value(name, choice.input).is_some() {
            (Origin::Given(DATA_SHEET), None)
        } else if name == "K_m" && choice.constant == Constant::Known {
            (Origin::Given(IS_TORQUE), None)
        } else if let Some(fitted) = fitted {
            (Origin::Estimated(BY_FIT), Some(fitted.std_error))
        } else if let Some(begun) = begun {
            (Origin::Estimated(BY_BALANCES), Some(begun.std_error))
        } else {
            let todo = match name {
                "R" => MEASURE_R,
                "L" => MEASURE_L,
                "K_m" if choice.constant == Constant::Ratio => NEEDS_KNOWN_K,
                "J" => NEEDS_ACCELERATION,
                "B_m" if by_voltage_alone => NEEDS_CURRENT,
                _ => NEEDS_EXCITATION,
            };
            (Origin::Guessed(todo), None)
        };
        let unit = match name {
            "K_m" if choice.input == Input::Force => choice.unit_of_constant(),
            _ => known.unit.clone(),
        };
        // At the bound of what is possible there is no error to tell.
        let std_error = std_error.filter(|error| *error > 0.0);
        Some(Value { name, value: known.value, unit, std_error, origin })
    };
    names.into_iter().filter_map(of).collect()
}
