//! The electric drive as a continuous-time model with a sampled layer around it.
//!
//! A drive file becomes a [`model::Model`]: the motor's balances (20)-(23) and the placed
//! [`effects`]. [`integrate`] advances its state over a sample: exactly where the drive is
//! affine, by exponential Runge-Kutta steps elsewhere, with stick-slip events located.
//! Everything is written once, over the scalar (`f64`, duals) and over lanes of drives.

pub mod drive;
pub mod effects;
pub mod fault;
pub mod file;
pub mod integrate;
mod lanes;
pub mod model;
pub mod noise;
pub mod parameters;
pub mod sampled;
#[cfg(test)]
mod testing;
pub mod unit;
pub mod units;
