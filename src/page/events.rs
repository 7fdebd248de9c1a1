//! News of a session for the tabs that show it, as server-sent events.

use std::convert::Infallible;
use std::pin::pin;
use std::sync::Arc;
use std::time::Duration;

use axum::extract::{Path, State as Shared};
use axum::response::sse::{Event, KeepAlive, Sse};
use futures_util::Stream;
use futures_util::future::select;
use futures_util::stream::unfold;
use serde_json::json;
use tokio::sync::watch;
use tokio::time::Instant;

use super::answer::Reply;
use super::bench::Bench;
use super::handlers::bench;
use super::site::Site;

/// Least time between two events of a session.
const BETWEEN_EVENTS: Duration = Duration::from_millis(60);
/// What a tab has to know at once: what is being done, and that something changed.
fn news(bench: &Bench, site: &Site) -> Event {
    let version = *bench.changes.borrow();
    let state = bench.state();
    let study = site.study.shown();
    let data = json!({
        "version": version,
        "job": state.job,
        "problem": state.problem,
        "recordings": state.recordings.len(),
        "steps": state.steps.len(),
        "beginning": state.beginnings,
        "diagnosis": state.diagnosis.changes,
        "asked": state.missing.keys().collect::<Vec<_>>(),
        "study": *site.study.changes.borrow(),
        "running": study.running,
    });
    Event::default().data(data.to_string())
}

/// A tab that listens.
struct Listener {
    bench: Arc<Bench>,
    site: Arc<Site>,
    own: watch::Receiver<u64>,
    study: watch::Receiver<u64>,
    /// When it may be told again.
    next: Instant,
}

impl Listener {
    /// Waits until something has changed, and for its turn.
    async fn next(mut self) -> Option<(Result<Event, Infallible>, Self)> {
        {
            let (own, study) = (pin!(self.own.changed()), pin!(self.study.changed()));
            select(own, study).await;
        }
        tokio::time::sleep_until(self.next).await;
        self.next = Instant::now() + BETWEEN_EVENTS;
        self.own.mark_unchanged();
        self.study.mark_unchanged();
        Some((Ok(news(&self.bench, &self.site)), self))
    }
}

/// Tells whenever something has changed.
pub(super) async fn events(
    Shared(site): Shared<Arc<Site>>,
    Path(id): Path<String>,
) -> Reply<Sse<impl Stream<Item = Result<Event, Infallible>>>> {
    let bench = bench(&site, &id)?;
    let (mut own, study) = (bench.changes.subscribe(), site.study.changes.subscribe());
    // Who comes anew is told how things stand.
    own.mark_changed();
    let listener = Listener { bench, site, own, study, next: Instant::now() };
    Ok(Sse::new(unfold(listener, Listener::next)).keep_alive(KeepAlive::default()))
}
