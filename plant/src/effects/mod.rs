//! The library of physical effects: one file an effect, and its line in the registry.
//!
//! [`law`] says what an effect is; [`registry`] lists them and dispatches to them;
//! [`custom`] is the one kind whose law the user types.

pub mod cogging;
pub mod coulomb;
pub mod custom;
pub mod flexible_coupling;
pub mod law;
pub mod presliding;
pub mod quadratic_drag;
pub mod registry;
pub mod saturation;
pub mod stribeck;
pub mod tacho_eccentricity;
pub mod viscous;
pub mod winding_heating;
