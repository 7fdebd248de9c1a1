//! Whether a file's columns tell of a turning machine or of a straight one.

use drivescope_units::{Quantity, Unit};

use crate::canonical;
use crate::given::Given;
use crate::words::words;

/// Whether the units tell of a turning machine (or of a straight one).
pub(super) fn rotary(given: &[Given]) -> Option<bool> {
    let has = |quantities: [Quantity; 2]| {
        given.iter().any(|column| {
            let unit = column.unit.as_deref().and_then(Unit::parse);
            let exact = canonical::exact(&column.name).filter(|_| column.unit.is_none());
            unit.is_some_and(|unit| quantities.contains(&unit.quantity))
                || exact.is_some_and(|known| quantities.contains(&known.quantities[0]))
                    && !matches!(column.name.as_str(), "reference" | "T")
        })
    };
    let turning = has([Quantity::Angle, Quantity::AngularSpeed]);
    let straight = has([Quantity::Length, Quantity::Speed]);
    // A torque turns, a force pushes.
    let says = |wanted: [&str; 6]| {
        let word = |word: &String| wanted.contains(&word.as_str());
        given.iter().any(|column| words(&column.name).iter().any(word))
    };
    match (turning, straight) {
        (true, true) => None,
        (true, false) | (false, true) => Some(turning),
        (false, false) => {
            let torque = says(["torque", "trq", "moment", "drehmoment", "couple", "coppia"]);
            let force = says(["force", "kraft", "fuerza", "forza", "thrust", "newton"]);
            (torque != force).then_some(torque)
        }
    }
}
