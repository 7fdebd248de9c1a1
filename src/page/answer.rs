//! What is answered in place of what was asked for.

use axum::Json;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use serde_json::json;

use super::bench::words;
use super::plain::plain;
use super::upload::UploadError;
use crate::failure::Failure;

/// An answer, or what stands in its place.
pub(super) type Reply<T> = Result<T, Refusal>;

/// Why something is not answered.
#[derive(Debug)]
pub(super) struct Refusal {
    status: StatusCode,
    words: String,
}

impl Refusal {
    pub(super) fn new(status: StatusCode, words: impl Into<String>) -> Self {
        Self { status, words: words.into() }
    }
}

/// What was asked for cannot be done.
pub(super) fn refused(words: impl Into<String>) -> Refusal {
    Refusal::new(StatusCode::UNPROCESSABLE_ENTITY, words)
}

impl From<Failure> for Refusal {
    fn from(failure: Failure) -> Self {
        refused(words(&failure.into()))
    }
}

impl From<miette::Report> for Refusal {
    fn from(error: miette::Report) -> Self {
        refused(words(&error))
    }
}

impl From<UploadError> for Refusal {
    fn from(error: UploadError) -> Self {
        let status = match error {
            UploadError::TooLarge { .. } => StatusCode::PAYLOAD_TOO_LARGE,
            UploadError::Broken(_) => StatusCode::UNPROCESSABLE_ENTITY,
        };
        Self::new(status, error.to_string())
    }
}

impl IntoResponse for Refusal {
    fn into_response(self) -> Response {
        (self.status, Json(json!({ "problem": plain(&self.words) }))).into_response()
    }
}
