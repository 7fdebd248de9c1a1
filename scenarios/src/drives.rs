//! The drives that ship with the program.

use drivescope_plant::drive::Drive;
use drivescope_plant::file::DriveFileError;

/// Name and file of every built-in drive.
pub const BUILT_IN: [(&str, &str); 2] = [
    ("dr300", include_str!("../drives/dr300.toml")),
    ("emps", include_str!("../drives/emps.toml")),
];

/// The built-in drive of that name, if there is one.
///
/// # Errors
/// Never for the files that ship: a test reads them all.
pub fn built_in(name: &str) -> Option<Result<Drive, DriveFileError>> {
    let (_, text) = BUILT_IN.iter().find(|(known, _)| *known == name)?;
    Some(Drive::parse(text, &format!("{name}.toml")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_built_in_drive_is_right() {
        for (name, _) in BUILT_IN {
            let drive = built_in(name).expect("it is built in");
            assert!(drive.is_ok(), "{name}: {:?}", drive.err());
        }
        assert!(built_in("nothing").is_none());
    }
}
