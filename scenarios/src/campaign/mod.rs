//! Campaigns: many scenarios of one plan, judged while they run, one row each.
//!
//! ```text
//! plan file -> Plan -> scenario k: parameters, faults, settings (a function of seed and k alone)
//!   healthy runs of other seeds -> Design: detectors
//!   Campaign::run(range): blocks of lanes (plant, noise, detectors), rayon over blocks -> Rows
//!   Rows -> part files -> merge -> one dataset
//! ```
//!
//! A row is a function of plan and number: the same bytes on any number of threads, any split into
//! ranges, and any instruction set.

mod bank;
mod block;
mod columns;
mod design;
mod foreign;
mod noise;
mod parts;
pub mod plan;
mod rows;
mod run;
pub mod summary;
#[cfg(test)]
mod tests;

pub use bank::DesignedBank;
pub use design::{Design, DesignError};
pub use foreign::ForeignPlant;
pub use parts::{
    DATASET, FolderError, Part, Whole, merge, missing, part_name, parts_of, write_part, write_rows,
};
pub use plan::{Plan, PlanError};
pub use rows::Rows;
pub use run::{Campaign, PART};

pub use drivescope_recording::dataset::Reader;
