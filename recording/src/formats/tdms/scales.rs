//! The scales of raw values in a TDMS file.

use super::object::{Object, Property};

/// Turns raw values into those of the channel's scales, one after the other; time stamps into
/// seconds since the first. False where a scale is not known.
pub(super) fn scale(channel: &mut Object) -> bool {
    if channel.in_seconds()
        && let Some(first) = channel.values.first().copied()
    {
        channel.values.iter_mut().for_each(|it| *it -= first);
    }
    let count = match channel.property("NI_Number_Of_Scales") {
        Some(Property::Number(count)) => *count as usize,
        _ => return true,
    };
    let scaled =
        matches!(channel.property("NI_Scaling_Status"), Some(Property::Text(it)) if it == "scaled");
    for k in (0..count).take_while(|_| !scaled) {
        let number = |name: &str| match channel.property(&format!("NI_Scale[{k}]_Linear_{name}")) {
            Some(Property::Number(value)) => Some(*value),
            _ => None,
        };
        let (Some(slope), Some(offset)) = (number("Slope"), number("Y_Intercept")) else {
            return false;
        };
        channel.values.iter_mut().for_each(|it| *it = *it * slope + offset);
    }
    true
}
