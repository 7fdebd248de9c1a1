//! The library of physical effects: one file an effect, and its line in the registry.
//!
//! [`law`] says what an effect is, [`info`] what is known of it and [`grid`] at which shapes it is weighed;
//! [`registry`] lists them and dispatches to them;
//! [`custom`] and [`learned`] are the kinds whose law stands in the drive file.

pub mod armature_reaction;
pub mod asymmetric_friction;
pub mod backlash;
pub mod brush_drop;
pub mod cogging;
pub mod constant_load;
pub mod coulomb;
pub mod current_offset;
pub mod custom;
pub mod dead_time;
pub mod delay;
pub mod flexible_coupling;
pub mod friction_drift;
pub mod grid;
pub mod info;
pub mod iron_loss;
pub mod law;
pub mod learned;
pub mod load_friction;
mod of_drive;
pub mod presliding;
pub mod quadratic_drag;
pub mod quantisation;
pub mod refusal;
pub mod registry;
pub mod saturation;
pub mod speed_sensor_lag;
pub mod stribeck;
pub mod supply_sag;
pub mod tacho_eccentricity;
pub mod tacho_gain;
pub mod torque_ripple;
mod two_masses;
pub mod unbalance;
pub mod viscous;
pub mod winding_heating;
