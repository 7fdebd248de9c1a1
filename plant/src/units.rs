//! Units of labels: written once for a rotary drive, translated for a linear one.

use crate::drive::Motion;

/// The unit for that motion of a unit written for a rotary drive: `N m` becomes `N`, `rad`
/// becomes `m`, `kg m^2` becomes `kg`.
pub fn for_motion(motion: Motion, rotary: &str) -> String {
    match motion {
        Motion::Rotary => rotary.to_owned(),
        Motion::Linear => rotary.replace("kg m^2", "kg").replace("N m", "N").replace("rad", "m"),
    }
}

/// The variable's name for that motion: `omega` becomes `v`, `theta` becomes `x`.
pub fn name_for_motion(motion: Motion, rotary: &'static str) -> &'static str {
    match (motion, rotary) {
        (Motion::Linear, "omega") => "v",
        (Motion::Linear, "theta") => "x",
        (Motion::Linear, "omega_load") => "v_load",
        (Motion::Linear, "theta_load") => "x_load",
        _ => rotary,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn linear_labels_follow_from_rotary_ones() {
        for (rotary, linear) in [
            ("N m", "N"),
            ("N m s^2/rad^2", "N s^2/m^2"),
            ("V s/rad", "V s/m"),
            ("kg m^2", "kg"),
            ("1/A^2", "1/A^2"),
        ] {
            assert_eq!(for_motion(Motion::Linear, rotary), linear);
            assert_eq!(for_motion(Motion::Rotary, rotary), rotary);
        }
        assert_eq!(name_for_motion(Motion::Linear, "omega"), "v");
        assert_eq!(name_for_motion(Motion::Linear, "theta_load"), "x_load");
    }
}
