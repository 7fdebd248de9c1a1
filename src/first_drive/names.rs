//! Effects, and parameters of effects, that a first drive may have.

pub(super) use drivescope_plant::effects::constant_load::OFFSET;
/// Dry friction's, which every first drive has.
pub(super) use drivescope_plant::effects::coulomb::LEVEL as FRICTION;
pub(super) use drivescope_plant::effects::unbalance::WEIGHT;

/// What the current sensor shows without a current.
pub(super) const CURRENT_OFFSET: &str = "current_offset.i_0";

/// Kind of the effect and key of the parameter.
pub(super) fn split(name: &'static str) -> (&'static str, &'static str) {
    name.split_once('.').unwrap_or((name, ""))
}

#[cfg(test)]
mod tests {
    use drivescope_plant::effects::registry::Entry;

    use super::*;

    #[test]
    fn the_library_has_the_parameters() {
        for (kind, key) in [FRICTION, OFFSET, CURRENT_OFFSET].map(split) {
            let entry = Entry::find(kind).expect("an effect of the library");
            assert!(entry.parameters.iter().any(|it| it.name == key), "{kind}.{key}");
        }
    }
}
