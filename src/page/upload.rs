//! Files that the browser sends: streamed to a file of this server's own, bounded in size. Their
//! names are shown, and never opened.

use std::io::Write;

use axum::body::Body;
use drivescope_recording::formats;
use futures_util::StreamExt;
use tempfile::{NamedTempFile, TempPath};

use super::site::Site;

/// Greatest size of a text, such as a drive file, bytes.
const MOST_TEXT: usize = 1_000_000;
/// Longest name that is kept, characters.
const LONGEST_NAME: usize = 120;

/// Why a file is not taken.
#[derive(Debug, thiserror::Error)]
pub(super) enum UploadError {
    /// It is too large.
    #[error(
        "the file is larger than {most} MB, the most that this server takes; keep fewer rows or columns"
    )]
    TooLarge {
        /// What is taken, MB.
        most: u64,
    },
    /// It did not arrive.
    #[error("the file did not arrive: {0}")]
    Broken(String),
}

/// A name to show: the last part of what was given, without what no name has.
pub(super) fn shown(name: &str) -> String {
    let last = name.rsplit(['/', '\\']).next().unwrap_or(name);
    let kept: String = last.chars().filter(|c| !c.is_control()).take(LONGEST_NAME).collect();
    if kept.trim().is_empty() { "recording".to_owned() } else { kept }
}

/// The extensions of recordings and of drive files, as a file picker wants them.
pub(super) fn accepted() -> String {
    let extensions = formats().iter().flat_map(|format| format.extensions);
    extensions.chain(&["toml"]).map(|it| format!(".{it}")).collect::<Vec<_>>().join(",")
}

/// The formats by name, for a sentence: `CSV, Parquet or MAT`.
pub(super) fn named() -> String {
    let names: Vec<&str> = formats().iter().map(|format| format.name).collect();
    match names.split_last() {
        Some((last, others)) => format!("{} or {last}", others.join(", ")),
        None => String::new(),
    }
}

/// What the file here ends in; other files are known by their first bytes, or refused when they
/// are read.
fn suffix(name: &str) -> String {
    let given = name.rsplit_once('.').map(|(_, given)| given).unwrap_or_default();
    let mut extensions = formats().iter().flat_map(|format| format.extensions);
    let known = extensions.find(|it| it.eq_ignore_ascii_case(given));
    known.map_or(String::new(), |it| format!(".{it}"))
}

/// Takes a recording into a file whose name the client does not choose.
///
/// # Errors
/// [`UploadError`].
pub(super) async fn recording(
    site: &Site,
    name: &str,
    body: Body,
) -> Result<TempPath, UploadError> {
    let suffix = suffix(name);
    let broken = |error: std::io::Error| UploadError::Broken(error.to_string());
    let mut file =
        tempfile::Builder::new().suffix(&suffix).tempfile_in(site.folder.path()).map_err(broken)?;
    let mut remainder = site.most_bytes;
    let mut chunks = body.into_data_stream();
    while let Some(chunk) = chunks.next().await {
        let chunk = chunk.map_err(|error| UploadError::Broken(error.to_string()))?;
        let too_large = || UploadError::TooLarge { most: site.most_bytes / 1_000_000 };
        remainder = remainder.checked_sub(chunk.len() as u64).ok_or_else(too_large)?;
        NamedTempFile::write_all(&mut file, &chunk).map_err(broken)?;
    }
    Ok(file.into_temp_path())
}

/// Takes a text.
///
/// # Errors
/// [`UploadError`].
pub(super) async fn text(body: Body, most: Option<usize>) -> Result<String, UploadError> {
    let most = most.unwrap_or(MOST_TEXT);
    let mut bytes = Vec::new();
    let mut chunks = body.into_data_stream();
    while let Some(chunk) = chunks.next().await {
        let chunk = chunk.map_err(|error| UploadError::Broken(error.to_string()))?;
        if bytes.len() + chunk.len() > most {
            return Err(UploadError::TooLarge { most: most as u64 / 1_000_000 });
        }
        bytes.extend_from_slice(&chunk);
    }
    String::from_utf8(bytes).map_err(|_| UploadError::Broken("it is no UTF-8 text".to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_format_can_be_picked() {
        for format in formats() {
            for extension in format.extensions {
                assert!(accepted().split(',').any(|it| it == format!(".{extension}")));
                let name = format!("A.{}", extension.to_uppercase());
                assert_eq!(suffix(&name), format!(".{extension}"));
            }
            assert!(named().contains(format.name));
        }
        assert_eq!((suffix("bench3"), suffix("a.xls")), (String::new(), String::new()));
    }

    #[test]
    fn a_name_is_only_a_name() {
        assert_eq!(shown("../../etc/passwd.csv"), "passwd.csv");
        assert_eq!(shown(r"C:\logs\a.csv"), "a.csv");
        assert_eq!(shown("a\u{0}\nb.csv"), "ab.csv");
        assert_eq!(shown("x/"), "recording");
        assert_eq!(shown(&"a".repeat(500)).len(), LONGEST_NAME);
    }
}
