//! The electric drive as a continuous-time model with a sampled layer around it.
//!
//! A drive file becomes a [`model::Model`]: the motor's balances (20)-(23) and the placed
//! [`effects`]. [`integrate`] advances its state over a sample: exactly where the drive is
//! affine, by exponential Runge-Kutta steps elsewhere, with stick-slip events located.
//! Everything is written once, over the scalar (`f64`, duals) and over lanes of drives.
//!
//! ```
//! use drivescope_plant::{drive::Drive, unit::Unit};
//!
//! let text = r#"
//! schema = 1
//! name = "bench motor"
//! motion = "rotary"
//! [motor]
//! input = "voltage"
//! R = 2.5     # ohm
//! L = 2.2e-3  # H
//! K_e = 0.04  # V s/rad
//! K_m = 0.04  # N m/A
//! tie_K = true
//! J = 3.6e-5  # kg m^2
//! B_m = 1e-5  # N m s/rad
//! "#;
//! let mut motor = Unit::new(Drive::parse(text, "motor.toml")?, true);
//! let of = |name: &str| motor.reference(name).expect("a drive has it");
//! let (u, omega) = (of("u"), of("omega"));
//! motor.set(u, 12.0)?;
//! motor.initialize(0.0);
//! motor.step(1.0)?;
//! // K u / (R B + K^2), rad/s, once it has settled.
//! let settled = 0.04 * 12.0 / (2.5 * 1e-5 + 0.04 * 0.04);
//! assert!((motor.get(omega).expect("it can be read") - settled).abs() < 1e-3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

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
