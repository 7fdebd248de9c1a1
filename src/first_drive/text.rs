//! The text of the first drive file: values, what is known of them, what to fill in.

use std::fmt::Write;

use drivescope_plant::drive::{Input, Motion};
use drivescope_plant::units::for_motion;

use super::{FirstDrive, Origin, Value};

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

/// The drive file.
pub(super) fn drive_file(drive: &FirstDrive) -> String {
    let force = drive.input == Input::Force;
    let (motion, input) = (
        if drive.motion == Motion::Rotary { "rotary" } else { "linear" },
        if force { "force" } else { "voltage" },
    );
    let unit = |rotary: &str| for_motion(drive.motion, rotary);
    let mut text = format!(
        "# A first drive file, made from a recording: values for a fit to start from.\n\
         # Marked with FILL IN: what the recording does not tell.\n\
         schema = 1\nname = {}\nmotion = \"{motion}\"\n\n[motor]\n",
        quoted(&short(&drive.recording))
    );
    let _ = writeln!(text, "input = \"{input}\"  # {}", drive.because);
    let torque_constant = match (force, drive.u_unit.as_str()) {
        (true, u) => format!("{}/{u}", unit("N m")),
        (false, _) => unit("N m/A"),
    };
    let mut line = |name: &str, value: &Value, unit: &str| {
        let todo = match value.origin {
            Origin::Guessed(todo) => format!("; FILL IN: {todo}"),
            Origin::Estimated(_) => String::new(),
        };
        let _ = writeln!(text, "{name} = {}  # {unit}{todo}", rounded(value.value));
    };
    if let (Some(r), Some(l)) = (&drive.r, &drive.l) {
        line("R", r, "ohm");
        line("L", l, "H");
        line("K_e", &drive.k, &unit("V s/rad"));
    }
    line("K_m", &drive.k, &torque_constant);
    line("J", &drive.j, &unit("kg m^2"));
    line("B_m", &drive.b_m, &unit("N m s/rad"));
    if !force {
        text.push_str("tie_K = true  # a fit keeps K_m = K_e, which are equal in SI units\n");
    }
    text.push_str("\n[[effect]]\nkind = \"coulomb\"\n");
    let todo = match drive.t_c.origin {
        Origin::Guessed(todo) => format!("; FILL IN: {todo}"),
        Origin::Estimated(_) => String::new(),
    };
    let _ = writeln!(text, "T_c = {}  # {}{todo}", rounded(drive.t_c.value), unit("N m"));
    if force {
        text.push_str("\n[fit]\nfixed = [\"K_m\"]  # only ratios to it can be measured\n");
    }
    text.push_str("\n[origin]\n");
    for (name, value) in drive.values() {
        let origin = match value.origin {
            Origin::Estimated(how) => format!("{how}; {}", short(&drive.recording)),
            Origin::Guessed(todo) => format!("guessed: {todo}"),
        };
        let _ = writeln!(text, "{} = {}", quoted(name), quoted(&origin));
    }
    text.push_str(&by_hand(drive));
    text
}

/// Tables that no recording tells, as comments to be completed.
fn by_hand(drive: &FirstDrive) -> String {
    let controller = if drive.controlled {
        "# A reference was recorded, so there is a controller. FILL IN to simulate the closed loop:\n"
    } else {
        "# To simulate a closed loop, FILL IN:\n"
    };
    let speed = for_motion(drive.motion, "rad/s");
    let angle = for_motion(drive.motion, "rad");
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
