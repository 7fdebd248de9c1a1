//! The values that the voltage balance (20) gives.

use super::super::laws::Linear;
use super::super::{Balances, Begun, voltage};
use super::{is_fitted, take};

/// Takes over what the voltage balance tells.
pub(super) fn begin(begun: &mut Begun, balances: &Balances, linear: &Linear) {
    let fixed = voltage::OWN.map(|name| !is_fitted(&begun.drive, name));
    let found = voltage::solve(&balances.voltage, &linear.zero, &linear.of[1], fixed);
    let names = linear.of[1].iter().map(|it| it.name.as_str());
    let names: Vec<&str> = voltage::OWN.into_iter().chain(names).collect();
    for (name, value) in names.iter().zip(&found.values) {
        let possible = value.filter(|value| *value > 0.0 || !voltage::OWN.contains(name));
        take(begun, name, possible, Some(0.0));
    }
    let factor =
        balances.voltage.iter().map(|it| voltage::factor(it, &begun.drive)).fold(1.0, f64::max);
    for (name, error) in names.iter().zip(&found.errors) {
        let identified = begun.identified.iter_mut().find(|it| it.name == *name);
        if let Some(identified) = identified {
            identified.std_error = error * factor;
        }
    }
}
