//! The drive that least squares begin with: the chosen structure with what is given, and what small
//! motors usually have.

use drivescope_plant::drive::{Drive, Input};

use super::names::{FRICTION, split};
use super::{Choice, FirstDriveError, Given};

/// What a small motor has where the recording does not tell: R ohm, L / R s, K V s/rad, J / K.
const USUAL: [f64; 4] = [1.0, 1e-3, 0.05, 2e-3];
/// Friction torque over the torque constant where the recording does not tell, A.
const USUAL_FRICTION: f64 = 0.1;

/// A drive of the chosen structure with what is given, and usual values.
pub(super) fn template(choice: &Choice, given: &Given) -> Result<Drive, FirstDriveError> {
    let [r, time, k, j] = USUAL;
    let of = |name: &str, usual: f64| given.value(name, choice.input).unwrap_or(usual);
    let force = choice.input == Input::Force;
    let r = of("R", r);
    let k_m = of("K_m", if force { 1.0 } else { k });
    let motor = match force {
        true => format!("input = \"force\"\nK_m = {k_m:?}\n"),
        false => format!(
            "input = \"voltage\"\nR = {r:?}\nL = {:?}\nK_e = {:?}\nK_m = {k_m:?}\ntie_K = {}\n",
            of("L", r * time),
            of("K_e", k),
            of("K_e", k) == k_m,
        ),
    };
    let fixed = ["R", "L", "K_e", "K_m", "J", "B_m", FRICTION].into_iter();
    let fixed = fixed.filter(|name| {
        let of_voltage = ["R", "L", "K_e"].contains(name);
        (given.value(name, choice.input).is_some() && !(force && of_voltage))
            || (*name == "K_m" && force)
    });
    let fixed: Vec<String> = fixed.map(|name| format!("{name:?}")).collect();
    let (kind, key) = split(FRICTION);
    let text = format!(
        "schema = 1\nname = \"first\"\nmotion = \"{}\"\n[motor]\n{motor}J = {:?}\nB_m = {:?}\n\
         [[effect]]\nkind = {kind:?}\n{key} = {:?}\n[fit]\nfixed = [{}]\n",
        super::text::motion(choice.motion),
        of("J", j * k_m),
        of("B_m", 0.0),
        of(FRICTION, USUAL_FRICTION * k_m),
        fixed.join(", "),
    );
    Drive::parse(&text, "first.toml")
        .map_err(|error| FirstDriveError::NoDrive { reason: error.to_string() })
}
