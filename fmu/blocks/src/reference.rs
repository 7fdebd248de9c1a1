//! Value references: k + 1 is the unit's variable k.

/// The unit's place of a value reference.
pub(crate) fn place(reference: u32) -> usize {
    (reference as usize).wrapping_sub(1)
}

/// The value reference of a unit's place.
pub(crate) fn reference(place: usize) -> u32 {
    place as u32 + 1
}
