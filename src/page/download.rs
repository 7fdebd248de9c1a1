//! What the user takes along: drive file, FMU, report.

use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};

use super::bench::{State, words};
use super::session_step::SessionStep;
use super::site::Site;
use crate::answer::discover::Step;
use crate::failure::Failure;
use crate::fmu_file;
use crate::report::discover::{Found, discover_html};

/// A file to be saved, or why there is none.
pub(super) fn file(kind: &str, name: &str, content: miette::Result<Vec<u8>>) -> Response {
    match content {
        Ok(content) => {
            let disposition = format!("attachment; filename=\"{name}\"");
            let headers = [
                (header::CONTENT_TYPE, kind.to_owned()),
                (header::CONTENT_DISPOSITION, disposition),
            ];
            (headers, content).into_response()
        }
        Err(error) => (StatusCode::UNPROCESSABLE_ENTITY, words(&error) + "\n").into_response(),
    }
}

/// The FMU of a step's drive.
///
/// # Errors
/// It cannot be written.
pub(super) fn fmu(site: &Site, step: &SessionStep, fmi: u8) -> miette::Result<Vec<u8>> {
    let version = fmu_file::version(fmi);
    let folder = site.folder.path();
    let unwritable = |source| Failure::Write { path: folder.to_owned(), source };
    let own = tempfile::Builder::new().tempdir_in(folder).map_err(unwritable)?;
    let path = own.path().join("drive.fmu");
    let open_loop = step.drive.controller.is_none();
    fmu_file::write(&step.drive, open_loop, version, &path)?;
    Ok(std::fs::read(&path).map_err(|source| Failure::Read { path, source })?)
}

/// The report of a step: the way to it, and what it explains.
///
/// # Errors
/// There is no such step.
pub(super) fn report(state: &State, number: usize) -> Result<String, Failure> {
    let last = state.step(number)?;
    let mut way = vec![number];
    while let Some(parent) = state.steps[way[0]].parent {
        way.insert(0, parent);
    }
    let steps: Vec<Step> = way.iter().map(|number| state.steps[*number].shown(0)).collect();
    // The first step that asked is the one whose cards tell the way.
    let asked = way.iter().find(|number| state.missing.contains_key(number));
    let before = asked.map_or(&last, |number| &state.steps[*number]);
    Ok(discover_html(&Found {
        compared: &last.compared,
        setting: &last.about,
        before: &before.compared,
        missing: asked.map(|number| &*state.missing[number]),
        motion: last.drive.motion,
        steps: &steps,
        parameters: &last.parameters,
    }))
}
