//! What is answered of training and diagnosing in a session.

use std::sync::Arc;

use axum::Json;
use axum::body::Body;
use axum::extract::{Path, Query, State as Shared};
use axum::http::StatusCode;
use axum::response::Response;
use serde::Deserialize;
use serde_json::json;

use super::answer::{Refusal, Reply, refused};
use super::diagnosis::{self, DiagnosisCommand, FILE};
use super::handlers::{bench, off_the_loop};
use super::recordings::Taken;
use super::site::Site;
use super::{download, upload};
use crate::failure::{Failure, into_report};
use crate::fmu_file;

/// The view.
pub(super) async fn view(
    Shared(site): Shared<Arc<Site>>,
    Path(id): Path<String>,
) -> Reply<Json<serde_json::Value>> {
    let bench = bench(&site, &id)?;
    let state = bench.state();
    Ok(Json(json!({ "html": diagnosis::view(&state) })))
}

/// Does what the page asks.
pub(super) async fn command(
    Shared(site): Shared<Arc<Site>>,
    Path(id): Path<String>,
    Json(command): Json<DiagnosisCommand>,
) -> Reply<StatusCode> {
    let bench = bench(&site, &id)?;
    command.run(&bench).map_err(refused)?;
    Ok(StatusCode::NO_CONTENT)
}

#[derive(Debug, Deserialize)]
pub(super) struct Named {
    name: String,
    healthy: bool,
}

/// Takes a recording.
pub(super) async fn file(
    Shared(site): Shared<Arc<Site>>,
    Path(id): Path<String>,
    Query(Named { name, healthy }): Query<Named>,
    body: Body,
) -> Reply<StatusCode> {
    let bench = bench(&site, &id)?;
    let name = upload::shown(&name);
    let path = upload::recording(&site, &name, body).await?;
    let take = move || diagnosis::take(&bench, Taken::uploaded(name, path)?, healthy);
    off_the_loop(take).await?.map_err(refused)?;
    Ok(StatusCode::NO_CONTENT)
}

#[derive(Debug, Deserialize)]
pub(super) struct Asked {
    fmi: Option<u8>,
}

/// The diagnoser, to take along.
pub(super) async fn give(
    Shared(site): Shared<Arc<Site>>,
    Path((id, what)): Path<(String, String)>,
    Query(Asked { fmi }): Query<Asked>,
) -> Reply<Response> {
    let bench = bench(&site, &id)?;
    let ready = bench.state().diagnosis.ready.clone();
    let ready = ready.ok_or_else(|| refused("no diagnoser was trained here"))?;
    match (what.as_str(), fmi) {
        ("toml", _) => {
            let text = ready.trained.learned.diagnoser.to_toml();
            let text = text.map(String::into_bytes).map_err(into_report);
            Ok(download::file("application/toml", FILE, text))
        }
        ("fmu", Some(fmi @ (2 | 3))) => {
            let version = fmu_file::version(fmi);
            let made = move || -> miette::Result<Vec<u8>> {
                let folder = site.folder.path();
                let unwritable = |source| Failure::Write { path: folder.to_owned(), source };
                let own = tempfile::Builder::new().tempdir_in(folder).map_err(unwritable)?;
                let path = own.path().join("diagnoser.fmu");
                let diagnoser = &ready.trained.learned.diagnoser;
                fmu_file::write_diagnoser(diagnoser, None, version, &path)
                    .map_err(|error| error.into_report())?;
                Ok(std::fs::read(&path).map_err(|source| Failure::Read { path, source })?)
            };
            let fmu = off_the_loop(made).await?;
            let name = format!("diagnoser_fmi{fmi}.fmu");
            Ok(download::file("application/octet-stream", &name, fmu))
        }
        _ => Err(Refusal::new(StatusCode::NOT_FOUND, "there is nothing here")),
    }
}
