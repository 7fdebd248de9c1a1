//! Units of signals, labels and FMUs: how they are written, what they measure, their way to SI.
//!
//! A column of a recording has a [`Unit`] of one [`Quantity`] in one of many spellings
//! ([`Unit::parse`]). What drive files and FMUs state may be any product of symbols, such as
//! `N m s/rad`: a [`BaseUnit`] ([`BaseUnit::parse`]). The factors stand in one table, `table.rs`.
//!
//! ```
//! use drivescope_units::{BaseUnit, Unit};
//!
//! let rpm = Unit::parse("U/min").expect("a spelling of rpm");
//! assert_eq!(rpm, Unit::RPM);
//! assert!((rpm.to_si(3000.0) - 314.159_265).abs() < 1e-6);
//! let power = BaseUnit::parse("N m/s")?;
//! assert_eq!(power.to(BaseUnit::parse("W")?).map(|it| it.factor), Some(1.0));
//! # Ok::<(), drivescope_units::UnitError>(())
//! ```

mod base;
mod composed;
mod counts;
mod powers;
mod quantity;
mod spellings;
mod table;
mod unit;

pub use base::{BaseUnit, Conversion};
pub use composed::UnitError;
pub use counts::is_counts;
pub use quantity::Quantity;
pub use unit::Unit;
