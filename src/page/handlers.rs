//! What handlers of requests share.

use std::sync::Arc;

use axum::http::StatusCode;

use super::answer::{Refusal, Reply};
use super::bench::Bench;
use super::site::Site;

/// The session of that name.
pub(super) fn bench(site: &Site, id: &str) -> Reply<Arc<Bench>> {
    let gone = "this session is over: open a new one at the root of this server";
    site.bench(id).ok_or_else(|| Refusal::new(StatusCode::NOT_FOUND, gone))
}

/// Work that would keep other requests waiting, on a thread of its own.
pub(super) async fn off_the_loop<T: Send + 'static>(
    work: impl FnOnce() -> T + Send + 'static,
) -> Reply<T> {
    let ended = tokio::task::spawn_blocking(work).await;
    ended.map_err(|_| Refusal::new(StatusCode::INTERNAL_SERVER_ERROR, "an internal error"))
}
