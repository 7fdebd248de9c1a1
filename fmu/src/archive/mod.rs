//! The FMU file: description, libraries and resources in one zip archive
//! (FMI 2.0.4 section 2.3, FMI 3.0.2 section 2.5).
//!
//! The same content gives the same bytes: names are sorted, and every entry has the one date that
//! the format begins with.

use std::io::{self, Write};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use crate::description::{DescriptionError, ModelDescription, Version};

/// Operating systems for which a library can be in an FMU, all on x86_64 or aarch64.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Platform {
    /// Linux on x86_64.
    LinuxX86_64,
    /// Linux on aarch64.
    LinuxAarch64,
    /// Windows on x86_64.
    WindowsX86_64,
    /// macOS on x86_64.
    MacX86_64,
    /// macOS on aarch64.
    MacAarch64,
}

impl Platform {
    /// The platform of this program; `None` where no FMU folder name is known.
    pub fn host() -> Option<Self> {
        match (std::env::consts::OS, std::env::consts::ARCH) {
            ("linux", "x86_64") => Some(Self::LinuxX86_64),
            ("linux", "aarch64") => Some(Self::LinuxAarch64),
            ("windows", "x86_64") => Some(Self::WindowsX86_64),
            ("macos", "x86_64") => Some(Self::MacX86_64),
            ("macos", "aarch64") => Some(Self::MacAarch64),
            _ => None,
        }
    }

    /// Folder under `binaries/`. FMI 2.0 names no aarch64; importers use the names of FMI 3.0.
    pub fn folder(self, version: Version) -> &'static str {
        match (version, self) {
            (Version::Two, Self::LinuxX86_64) => "linux64",
            (Version::Two, Self::WindowsX86_64) => "win64",
            (Version::Two, Self::MacX86_64) => "darwin64",
            (Version::Three, Self::LinuxX86_64) => "x86_64-linux",
            (Version::Three, Self::WindowsX86_64) => "x86_64-windows",
            (Version::Three, Self::MacX86_64) => "x86_64-darwin",
            (_, Self::LinuxAarch64) => "aarch64-linux",
            (_, Self::MacAarch64) => "aarch64-darwin",
        }
    }

    /// Extension of a shared library, without dot.
    pub fn extension(self) -> &'static str {
        match self {
            Self::LinuxX86_64 | Self::LinuxAarch64 => "so",
            Self::WindowsX86_64 => "dll",
            Self::MacX86_64 | Self::MacAarch64 => "dylib",
        }
    }
}

/// What goes into an FMU.
#[derive(Clone, Debug)]
pub struct Archive<'a> {
    /// The model description.
    pub description: &'a ModelDescription,
    /// Shared libraries by platform; at least one. The same bytes serve both versions.
    pub libraries: Vec<(Platform, &'a [u8])>,
    /// Files under `resources/` by relative name with `/`.
    pub resources: Vec<(String, &'a [u8])>,
    /// Files under `documentation/` by relative name; users expect an `index.html`.
    pub documentation: Vec<(String, &'a [u8])>,
}

/// An FMU that cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum ArchiveError {
    /// The standard does not allow the description.
    #[error("the model description is not allowed")]
    Description(#[from] DescriptionError),
    /// There is no library in it.
    #[error("an FMU needs a library for at least one platform")]
    NoLibrary,
    /// A name would leave its folder, or is there twice.
    #[error(
        "`{0}` cannot be a file name inside an FMU: relative, with `/`, without `..`, and once"
    )]
    Name(String),
}

impl Archive<'_> {
    /// The bytes of the `.fmu` file.
    ///
    /// # Errors
    ///
    /// A description that is not allowed, no library, or a file name that is not one.
    pub fn to_bytes(&self, version: Version) -> Result<Vec<u8>, ArchiveError> {
        let xml = self.description.to_xml(version)?;
        if self.libraries.is_empty() {
            return Err(ArchiveError::NoLibrary);
        }
        let identifier = &self.description.identifier;
        let mut entries = vec![("modelDescription.xml".to_owned(), xml.as_bytes())];
        for (platform, bytes) in &self.libraries {
            let (folder, extension) = (platform.folder(version), platform.extension());
            entries.push((format!("binaries/{folder}/{identifier}.{extension}"), bytes));
        }
        for (folder, files) in
            [("resources", &self.resources), ("documentation", &self.documentation)]
        {
            for (name, bytes) in files {
                if name.split(['/', '\\']).any(|part| matches!(part, "" | "." | ".."))
                    || name.contains(['\\', ':'])
                {
                    return Err(ArchiveError::Name(name.clone()));
                }
                entries.push((format!("{folder}/{name}"), bytes));
            }
        }
        entries.sort_by(|a, b| a.0.cmp(&b.0));
        if let Some(twice) = entries.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            return Err(ArchiveError::Name(twice[0].0.clone()));
        }
        Ok(zipped(&entries).expect("a Vec takes all that is written, and names are unique"))
    }
}

fn zipped(entries: &[(String, &[u8])]) -> zip::result::ZipResult<Vec<u8>> {
    let mut writer = ZipWriter::new(io::Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(DateTime::DEFAULT);
    for (name, bytes) in entries {
        // Libraries must be executable where an importer keeps the mode.
        let mode = if name.starts_with("binaries/") { 0o755 } else { 0o644 };
        writer.start_file(name.as_str(), options.unix_permissions(mode))?;
        writer.write_all(bytes)?;
    }
    Ok(writer.finish()?.into_inner())
}

#[cfg(test)]
mod tests {
    use std::io::Read;

    use super::*;
    use crate::description::tests::description;

    fn archive(description: &ModelDescription) -> Archive<'_> {
        Archive {
            description,
            libraries: vec![(Platform::LinuxX86_64, b"library"), (Platform::WindowsX86_64, b"dll")],
            resources: vec![("z/drive.toml".into(), b"R = 1"), ("a.txt".into(), b"")],
            documentation: vec![("index.html".into(), b"<p>")],
        }
    }

    #[test]
    fn the_same_content_gives_the_same_bytes() {
        let description = description();
        let bytes = archive(&description).to_bytes(Version::Two).unwrap();
        let mut other = archive(&description);
        other.resources.reverse();
        other.libraries.reverse();
        assert_eq!(bytes, other.to_bytes(Version::Two).unwrap());
        assert_ne!(bytes, other.to_bytes(Version::Three).unwrap());
    }

    #[test]
    fn files_are_where_each_version_wants_them() {
        let description = description();
        for (version, library) in [
            (Version::Two, "binaries/linux64/tiny.so"),
            (Version::Three, "binaries/x86_64-linux/tiny.so"),
        ] {
            let bytes = archive(&description).to_bytes(version).unwrap();
            let mut zip = zip::ZipArchive::new(io::Cursor::new(bytes)).unwrap();
            let mut read = |name: &str| {
                let mut text = String::new();
                zip.by_name(name).unwrap().read_to_string(&mut text).unwrap();
                text
            };
            assert_eq!(read(library), "library");
            assert_eq!(read("resources/z/drive.toml"), "R = 1");
            assert_eq!(read("modelDescription.xml"), description.to_xml(version).unwrap());
            assert_eq!(read("documentation/index.html"), "<p>");
        }
    }

    #[test]
    fn names_stay_inside_and_are_unique() {
        let description = description();
        for name in ["../x", "/x", "a//b", "a\\b", "C:x", "", "a/./b", "a.txt"] {
            let mut archive = archive(&description);
            archive.resources.push((name.into(), b""));
            let refused = archive.to_bytes(Version::Two);
            assert!(matches!(refused, Err(ArchiveError::Name(_))), "{name}");
        }
        let mut empty = archive(&description);
        empty.libraries.clear();
        assert!(matches!(empty.to_bytes(Version::Two), Err(ArchiveError::NoLibrary)));
    }
}
