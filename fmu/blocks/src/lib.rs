//! The drive and the diagnoser as FMI models.
//!
//! The program describes an FMU by them when it exports one, and the shared library inside the
//! FMU runs it; so the two cannot disagree. It is a crate of its own because the shared libraries
//! are built alone and cannot be linked by the program.
//!
//! ```
//! use drivescope_fmu::export::Model;
//! use drivescope_fmu_blocks::DriveModel;
//! use drivescope_plant::drive::Drive;
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
//! let model = DriveModel::new(Drive::parse(text, "motor.toml")?, true);
//! let names: Vec<String> = model.description().variables.into_iter().map(|it| it.name).collect();
//! assert!(["u", "omega", "K_m"].iter().all(|name| names.iter().any(|it| it == name)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod description;
mod diagnoser;
mod drive;
mod reference;
mod structure;

pub use diagnoser::{BASELINE_FILE, DIAGNOSER_FILE, DiagnoserError, DiagnoserModel, baseline_text};
pub use drive::{DRIVE_FILE, DriveError, DriveModel, OPEN_LOOP_FILE};
