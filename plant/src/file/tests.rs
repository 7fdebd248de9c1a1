//! The file as a whole: shipped drives, round trip, and what each mistake is told.

use super::*;

const DR300: &str = include_str!("../../../scenarios/drives/dr300.toml");
const EMPS: &str = include_str!("../../../scenarios/drives/emps.toml");

#[test]
fn shipped_drives_survive_writing_and_reading() {
    for text in [DR300, EMPS] {
        let drive = Drive::parse(text, "shipped.toml").unwrap_or_else(|error| panic!("{error}"));
        let again = Drive::parse(&drive.to_toml(), "written.toml");
        assert_eq!(again.unwrap_or_else(|error| panic!("{error}")), drive);
    }
}
