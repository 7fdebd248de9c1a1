//! The text of the first drive file: values, what is known of them, what to fill in.

use std::fmt::Write;

use drivescope_plant::drive::{Input, Motion};
use drivescope_plant::units::for_motion;

use super::names::{FRICTION, OFFSET, split};
use super::{Choice, FirstDrive, Origin};

/// Significant digits of a rough value.
const DIGITS: i32 = 4;

/// The number with a few digits, as TOML writes a float.
fn rounded(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return "0.0".to_owned();
    }
    let scale = 10f64.powi(DIGITS - 1 - value.abs().log10().floor() as i32);
    format!("{:?}", (value * scale).round() / scale)
}

/// A text in quotes, whatever is in it.
fn quoted(text: &str) -> String {
    let plain: String = text.chars().filter(|c| !c.is_control()).collect();
    format!("\"{}\"", plain.replace('\\', "\\\\").replace('"', "\\\""))
}

/// The recording's file name without folder and extension.
fn short(recording: &str) -> String {
    let stem = std::path::Path::new(recording).file_stem();
    stem.map_or(recording.to_owned(), |stem| stem.to_string_lossy().into_owned())
}

/// The word of a drive file for the motion.
pub(super) fn motion(motion: Motion) -> &'static str {
    if motion == Motion::Rotary { "rotary" } else { "linear" }
}

/// The drive file.
pub(super) fn drive_file(first: &FirstDrive) -> String {
    let choice = &first.choice;
    let force = choice.input == Input::Force;
    let mut text = format!(
        "# A first drive file, made from a recording: values for a fit to start from.\n\
         # Marked with FILL IN: what the recording does not tell.\n\
         # {}.\n\
         schema = 1\nname = {}\nmotion = \"{}\"\n\n[motor]\ninput = \"{}\"\n",
        choice.sentence,
        quoted(&short(&first.recording)),
        motion(choice.motion),
        if force { "force" } else { "voltage" },
    );
    let mut line = |key: &str, name: &str| {
        let Some(value) = first.value(name) else { return };
        let unit = &value.unit;
        let remark = match value.origin {
            Origin::Guessed(todo) => format!("; FILL IN: {todo}"),
            Origin::Given(_) | Origin::Estimated(_) => String::new(),
        };
        let _ = writeln!(text, "{key} = {}  # {unit}{remark}", rounded(value.value));
    };
    ["R", "L", "K_e", "K_m", "J", "B_m"].into_iter().for_each(|name| line(name, name));
    if !force && first.value("K_e").map(|it| it.value) == first.value("K_m").map(|it| it.value) {
        text.push_str("tie_K = true  # a fit keeps K_m = K_e, which are equal in SI units\n");
    }
    for name in [FRICTION, OFFSET] {
        let (kind, key) = split(name);
        let Some(value) = first.value(name) else { continue };
        let remark = match value.origin {
            Origin::Guessed(todo) => format!("; FILL IN: {todo}"),
            Origin::Given(_) | Origin::Estimated(_) => String::new(),
        };
        let (unit, value) = (&value.unit, rounded(value.value));
        let _ =
            writeln!(text, "\n[[effect]]\nkind = \"{kind}\"\n{key} = {value}  # {unit}{remark}");
    }
    let per_recording = first.value(OFFSET).map(|it| quoted(it.name));
    let fixed: Vec<String> = first.fixed.iter().map(|name| quoted(name)).collect();
    if per_recording.is_some() || !fixed.is_empty() {
        text.push_str("\n[fit]\n");
    }
    if let Some(name) = per_recording {
        let _ = writeln!(text, "per_recording = [{name}]");
    }
    if !fixed.is_empty() {
        let _ =
            writeln!(text, "fixed = [{}]  # what the recording does not tell", fixed.join(", "));
    }
    text.push_str("\n[origin]\n");
    for value in &first.values {
        let origin = match (value.origin, value.std_error) {
            (Origin::Estimated(how), Some(error)) => {
                format!("{how}, standard error {error:.1e}; {}", short(&first.recording))
            }
            (Origin::Estimated(how), None) => format!("{how}; {}", short(&first.recording)),
            (Origin::Given(how), _) => how.to_owned(),
            (Origin::Guessed(todo), _) => format!("guessed: {todo}"),
        };
        let _ = writeln!(text, "{} = {}", quoted(value.name), quoted(&origin));
    }
    text.push_str(&by_hand(choice));
    text
}

/// Tables that no recording tells, as comments to be completed.
fn by_hand(choice: &Choice) -> String {
    let controller = if choice.controlled {
        "# A reference was recorded, so there is a controller. FILL IN to simulate the closed loop:\n"
    } else {
        "# To simulate a closed loop, FILL IN:\n"
    };
    let speed = for_motion(choice.motion, "rad/s");
    let angle = for_motion(choice.motion, "rad");
    format!(
        "\n{controller}\
         # [controller]\n# K_p =      # V s/{angle}\n# K_i =      # V/{angle}\n\
         # period =   # s\n# limit =    # V\n\
         # [amplifier]\n# gain =     # V/V, from the control signal to u\n# limit =    # V\n\n\
         # Known standard deviations of the sensors' noise; a fit estimates what is left out:\n\
         # [noise]\n# omega =    # {speed}\n# i =        # A\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_toml_floats_of_few_digits() {
        for (value, text) in [
            (3.129_87, "3.13"),
            (12.0, "12.0"),
            (6.0e-5, "6e-5"),
            (95_108.9, "95110.0"),
            (0.0, "0.0"),
            (1.0 / 3.0, "0.3333"),
        ] {
            assert_eq!(rounded(value), text);
            let parsed: f64 = text.parse().expect("a number");
            assert!((parsed - value).abs() <= 1e-3 * value.abs(), "{value}");
        }
    }

    #[test]
    fn a_name_cannot_break_the_file() {
        let text = format!("name = {}", quoted("a \"b\" \\ c\n\u{301}"));
        let table: toml::Table = text.parse().expect("it is TOML");
        assert_eq!(table["name"].as_str(), Some("a \"b\" \\ c\u{301}"));
    }
}
