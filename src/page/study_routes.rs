//! What is answered of the faults view.

use std::sync::Arc;

use axum::Json;
use axum::body::Body;
use axum::extract::State as Shared;
use axum::http::StatusCode;
use serde::Deserialize;
use serde_json::json;

use super::answer::{Reply, refused};
use super::site::Site;
use super::{faults, upload};

/// Greatest size of a study.json, bytes.
const MOST_STUDY: usize = 20_000_000;

/// The faults view.
pub(super) async fn view(Shared(site): Shared<Arc<Site>>) -> Json<serde_json::Value> {
    let version = *site.study.changes.borrow();
    Json(json!({ "version": version, "html": faults::view(&site.study.shown()) }))
}

/// What the page asks.
#[derive(Debug, Deserialize)]
#[serde(tag = "do", rename_all = "snake_case")]
pub(super) enum StudyCommand {
    /// Begin.
    Start,
    /// End what is running.
    Cancel,
}

/// Begins or ends a study.
pub(super) async fn command(
    Shared(site): Shared<Arc<Site>>,
    Json(command): Json<StudyCommand>,
) -> Reply<StatusCode> {
    match command {
        StudyCommand::Start => {
            site.study.start(site.folder.path().to_owned(), site.seed).map_err(refused)?
        }
        StudyCommand::Cancel => site.study.cancel(),
    }
    Ok(StatusCode::NO_CONTENT)
}

/// Takes the results of a file.
pub(super) async fn file(Shared(site): Shared<Arc<Site>>, body: Body) -> Reply<StatusCode> {
    let text = upload::text(body, Some(MOST_STUDY)).await;
    site.study.take(&text?).map_err(refused)?;
    Ok(StatusCode::NO_CONTENT)
}
