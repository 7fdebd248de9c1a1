//! Parameters of effects that a first drive may have.

/// The offset's parameter.
pub(super) const OFFSET: &str = "constant_load.T_0";
/// Dry friction's, which every first drive has.
pub(super) const FRICTION: &str = "coulomb.T_c";

/// Kind of the effect and key of the parameter.
pub(super) fn split(name: &'static str) -> (&'static str, &'static str) {
    name.split_once('.').unwrap_or((name, ""))
}

#[cfg(test)]
mod tests {
    use drivescope_plant::effects::registry::Entry;

    use super::*;

    #[test]
    fn the_library_has_both_parameters() {
        for (kind, key) in [FRICTION, OFFSET].map(split) {
            let entry = Entry::find(kind).expect("an effect of the library");
            assert!(entry.parameters.iter().any(|it| it.name == key), "{kind}.{key}");
        }
    }
}
