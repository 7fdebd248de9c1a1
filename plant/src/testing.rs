//! The shipped drives, which the tests share.

use crate::drive::Drive;

pub(crate) const DR300: &str = include_str!("../../scenarios/drives/dr300.toml");
pub(crate) const EMPS: &str = include_str!("../../scenarios/drives/emps.toml");

/// The drive of a file that is right.
pub(crate) fn drive(text: &str) -> Drive {
    Drive::parse(text, "test.toml").expect("a right drive file")
}
