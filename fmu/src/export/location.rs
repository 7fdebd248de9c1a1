//! Where the resources are: FMI 2.0 hands over a URI (2.0.4 section 2.1.5), FMI 3.0 a native path.

use std::path::PathBuf;

use percent_encoding::percent_decode_str;

use crate::description::Version;

/// The resources folder, `None` where the importer names none or it does not exist.
pub(super) fn resources(version: Version, location: Option<&str>) -> Option<PathBuf> {
    let location = location.filter(|text| !text.is_empty())?;
    let path = match version {
        Version::Two => from_uri(location)?,
        Version::Three => PathBuf::from(location),
    };
    path.is_dir().then_some(path)
}

/// `file:///a%20b`, `file:/a`, `file://localhost/a`; what is no URI is taken as a path, as some
/// importers pass one.
fn from_uri(uri: &str) -> Option<PathBuf> {
    let Some(rest) = uri.strip_prefix("file:") else { return Some(PathBuf::from(uri)) };
    let encoded = match rest.strip_prefix("//") {
        Some(after) => &after[after.find('/')?..],
        None => rest,
    };
    let path = percent_decode_str(encoded).decode_utf8().ok()?;
    // `/C:/folder` is a drive letter with a slash that only the URI needs.
    let drive = path.as_bytes().get(2) == Some(&b':');
    Some(PathBuf::from(if drive { &path[1..] } else { &path[..] }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uris_become_paths() {
        for (uri, path) in [
            ("file:///a/b%20c/resources", "/a/b c/resources"),
            ("file:/a/resources", "/a/resources"),
            ("file://localhost/a/%C3%A4", "/a/ä"),
            ("file:///C:/fmu/resources", "C:/fmu/resources"),
            ("/a/resources", "/a/resources"),
        ] {
            assert_eq!(from_uri(uri), Some(PathBuf::from(path)), "{uri}");
        }
        assert_eq!(from_uri("file://host-without-path"), None);
        assert_eq!(from_uri("file:///%FF"), None);
    }

    #[test]
    fn a_folder_that_does_not_exist_is_none() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().to_str().unwrap();
        let uri = format!("file://{path}");
        assert_eq!(resources(Version::Two, Some(&uri)).as_deref(), Some(folder.path()));
        assert_eq!(resources(Version::Three, Some(path)).as_deref(), Some(folder.path()));
        for location in [None, Some(""), Some("file:///no/such/folder"), Some("/no/such/folder")] {
            assert_eq!(resources(Version::Two, location), None);
            assert_eq!(resources(Version::Three, location), None);
        }
    }
}
