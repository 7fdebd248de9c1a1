//! The truth values of FMI 2.0.

/// `fmi2Boolean`: an integer in C.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[repr(transparent)]
pub(super) struct Boolean2(pub(super) i32);
