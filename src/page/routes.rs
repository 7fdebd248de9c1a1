//! What is answered at which address.

use std::convert::Infallible;
use std::pin::pin;
use std::sync::atomic::Ordering;
use std::sync::{Arc, PoisonError};
use std::time::Duration;

use axum::body::Body;
use axum::extract::{Path, Query, State as From};
use axum::http::{StatusCode, header};
use axum::middleware;
use axum::response::sse::{Event, KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use axum::{Json, Router};
use futures_util::Stream;
use futures_util::future::select;
use futures_util::stream::unfold;
use serde::Deserialize;
use serde_json::json;
use tokio::sync::watch;
use tokio::time::Instant;

use super::bench::{Bench, words};
use super::command::Command;
use super::law::TypedLaw;
use super::recordings::Taken;
use super::show::{View, pieces, within};
use super::signals::{MOST_POINTS, Wanted, signals};
use super::site::Site;
use super::study::FaultStudy;
use super::{assets, download, faults, guard, shell, upload, window};

/// Least time between two events of a session.
const BETWEEN_EVENTS: Duration = Duration::from_millis(60);
/// Greatest size of a study.json, bytes.
const MOST_STUDY: usize = 20_000_000;

/// Everything behind the guard.
pub(super) fn router(site: Arc<Site>) -> Router {
    Router::new()
        .route("/", get(open))
        .route("/assets/{name}", get(assets::asset))
        .route("/b/{id}/", get(page))
        .route("/b/{id}/events", get(events))
        .route("/b/{id}/pieces", get(show))
        .route("/b/{id}/signals", get(numbers))
        .route("/b/{id}/within", get(brushed))
        .route("/b/{id}/do", post(command))
        .route("/b/{id}/law", post(check))
        .route("/b/{id}/file", post(take))
        .route("/b/{id}/take/{what}", get(give))
        .route("/study", get(study_view).post(study_command))
        .route("/study/file", post(study_file))
        .route("/study/trace", get(study_trace))
        .fallback(|| async { (StatusCode::NOT_FOUND, "there is nothing here\n") })
        .layer(middleware::from_fn_with_state(Arc::clone(&site), guard::guard))
        .with_state(site)
}

type Answer<T> = Result<T, Response>;

fn refused(words: impl Into<String>) -> Response {
    (StatusCode::UNPROCESSABLE_ENTITY, Json(json!({ "problem": words.into() }))).into_response()
}

fn bench(site: &Site, id: &str) -> Answer<Arc<Bench>> {
    let gone = "this session is over: open a new one at the root of this server\n";
    site.bench(id).ok_or_else(|| (StatusCode::NOT_FOUND, gone).into_response())
}

/// A new session, or the one of the command line.
async fn open(From(site): From<Arc<Site>>) -> Response {
    let headers = [(header::LOCATION, format!("/b/{}/", site.opened()))];
    (StatusCode::SEE_OTHER, headers).into_response()
}

async fn page(From(site): From<Arc<Site>>, Path(id): Path<String>) -> Answer<Response> {
    let bench = bench(&site, &id)?;
    let html = [(header::CONTENT_TYPE, "text/html; charset=utf-8")];
    Ok((html, shell::page(&bench.id, site.most_bytes)).into_response())
}

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
        "rungs": state.rungs.len(),
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

async fn events(
    From(site): From<Arc<Site>>,
    Path(id): Path<String>,
) -> Answer<Sse<impl Stream<Item = Result<Event, Infallible>>>> {
    let bench = bench(&site, &id)?;
    let (mut own, study) = (bench.changes.subscribe(), site.study.changes.subscribe());
    // Who comes anew is told how things stand.
    own.mark_changed();
    let listener = Listener { bench, site, own, study, next: Instant::now() };
    Ok(Sse::new(unfold(listener, Listener::next)).keep_alive(KeepAlive::default()))
}

#[derive(Debug, Deserialize)]
struct Looked {
    #[serde(default)]
    rung: usize,
    #[serde(default)]
    recording: usize,
    ghost: Option<usize>,
    from: Option<f64>,
    to: Option<f64>,
    points: Option<usize>,
    fmi: Option<u8>,
}

impl Looked {
    fn window(&self) -> Option<(f64, f64)> {
        self.from.zip(self.to).filter(|(from, to)| from.is_finite() && to.is_finite() && from < to)
    }
}

async fn show(
    From(site): From<Arc<Site>>,
    Path(id): Path<String>,
    Query(looked): Query<Looked>,
) -> Answer<Response> {
    let bench = bench(&site, &id)?;
    let version = *bench.changes.borrow();
    let state = bench.state();
    let view = View { rung: looked.rung, recording: looked.recording };
    let recordings = state.recordings.iter().map(|it| &it.name).collect::<Vec<_>>();
    let rungs = state.rungs.iter().map(|it| &it.label).collect::<Vec<_>>();
    let rung = state.rungs.get(looked.rung);
    let spans =
        rung.and_then(|it| it.compared.recordings.get(looked.recording)).map(|it| &it.spans);
    let answer = json!({
        "version": version,
        "beginning": state.beginnings,
        "pieces": pieces(&state, view),
        "recordings": recordings,
        "rungs": rungs,
        "spans": spans,
    });
    Ok(Json(answer).into_response())
}

async fn numbers(
    From(site): From<Arc<Site>>,
    Path(id): Path<String>,
    Query(looked): Query<Looked>,
) -> Answer<Response> {
    let bench = bench(&site, &id)?;
    let wanted = Wanted {
        recording: looked.recording,
        rung: looked.rung,
        ghost: looked.ghost,
        window: looked.window(),
        points: looked.points.unwrap_or(MOST_POINTS),
    };
    let bytes = signals(&bench.state(), &wanted).map_err(|error| refused(words(&error.into())))?;
    Ok(([(header::CONTENT_TYPE, "application/octet-stream")], bytes).into_response())
}

/// Where the model fails within a window; a window that was asked for later overtakes it.
async fn brushed(
    From(site): From<Arc<Site>>,
    Path(id): Path<String>,
    Query(looked): Query<Looked>,
) -> Answer<Response> {
    let bench = bench(&site, &id)?;
    let span = looked.window().ok_or_else(|| refused("a window has a beginning and an end"))?;
    let (rung, whole) = {
        let state = bench.state();
        let rung = state.rung(looked.rung).map_err(|error| refused(words(&error.into())))?;
        (rung, state.whole.clone().ok_or_else(|| refused("nothing was analysed"))?)
    };
    let seed = site.seed;
    let mine = bench.looks.fetch_add(1, Ordering::Relaxed) + 1;
    let compared = off_the_loop(move || {
        let _alone = bench.looking.lock().unwrap_or_else(PoisonError::into_inner);
        let is_last = bench.looks.load(Ordering::Relaxed) == mine;
        is_last.then(|| window::compared(&rung, &whole, looked.recording, span, seed))
    });
    let overtaken = || StatusCode::CONFLICT.into_response();
    let compared = compared.await?.ok_or_else(overtaken)?;
    let compared = compared.map_err(|error| refused(words(&error)))?;
    Ok(Json(json!({ "html": within(&compared, span) })).into_response())
}

async fn command(
    From(site): From<Arc<Site>>,
    Path(id): Path<String>,
    Json(command): Json<Command>,
) -> Answer<StatusCode> {
    let bench = bench(&site, &id)?;
    off_the_loop(move || command.run(&bench)).await?.map_err(refused)?;
    Ok(StatusCode::NO_CONTENT)
}

/// Whether a typed law is right, and what it looks like.
async fn check(
    From(site): From<Arc<Site>>,
    Path(id): Path<String>,
    Query(looked): Query<Looked>,
    Json(law): Json<TypedLaw>,
) -> Answer<Response> {
    let bench = bench(&site, &id)?;
    let rung = bench.state().rung(looked.rung).map_err(|error| refused(words(&error.into())))?;
    let curves = &rung.compared.curves;
    Ok(match law.understood(curves) {
        Ok(law) => Json(json!({ "html": law.preview(curves).into_string() })).into_response(),
        Err(wrong) => Json(json!({ "wrong": wrong })).into_response(),
    })
}

#[derive(Debug, Deserialize)]
struct Named {
    name: String,
    /// Whether another file follows, before which nothing is to be analysed.
    #[serde(default)]
    more: bool,
}

/// A recording or a drive file, whatever its name says.
async fn take(
    From(site): From<Arc<Site>>,
    Path(id): Path<String>,
    Query(Named { name, more }): Query<Named>,
    body: Body,
) -> Answer<StatusCode> {
    let bench = bench(&site, &id)?;
    let name = upload::shown(&name);
    let too_large = |error: upload::UploadError| match error {
        upload::UploadError::TooLarge { .. } => {
            (StatusCode::PAYLOAD_TOO_LARGE, Json(json!({ "problem": error.to_string() })))
                .into_response()
        }
        other => refused(other.to_string()),
    };
    if name.to_lowercase().ends_with(".toml") {
        let text = upload::text(body, None).await.map_err(too_large)?;
        bench.take_drive(&name, &text).map_err(|error| refused(words(&error)))?;
    } else {
        let path = upload::recording(&site, &name, body).await.map_err(too_large)?;
        let taken = off_the_loop(move || Taken::uploaded(name, path)).await?.map_err(refused)?;
        bench.change(|state| {
            // The same file again replaces what was there; an example makes room.
            state.recordings.retain(|it| it.name != taken.name && it.report.is_some());
            state.recordings.push(taken);
        });
    }
    if !more {
        bench.analyse();
    }
    Ok(StatusCode::NO_CONTENT)
}

/// What the user takes along.
async fn give(
    From(site): From<Arc<Site>>,
    Path((id, what)): Path<(String, String)>,
    Query(looked): Query<Looked>,
) -> Answer<Response> {
    let bench = bench(&site, &id)?;
    let number = looked.rung;
    let rung = bench.state().rung(number).map_err(|error| refused(words(&error.into())))?;
    match (what.as_str(), looked.fmi) {
        ("drive.toml", _) => {
            let text = Ok(rung.text.clone().into_bytes());
            Ok(download::file("application/toml", &super::work::file_of(number), text))
        }
        ("drive.fmu", Some(fmi @ (2 | 3))) => {
            let fmu = off_the_loop(move || download::fmu(&site, &rung, fmi)).await?;
            Ok(download::file("application/octet-stream", &format!("drive_fmi{fmi}.fmu"), fmu))
        }
        ("report.html", _) => {
            let report = download::report(&bench.state(), number);
            let report = report.map(String::into_bytes).map_err(Into::into);
            Ok(download::file("text/html; charset=utf-8", "report.html", report))
        }
        _ => Err((StatusCode::NOT_FOUND, "there is nothing here\n").into_response()),
    }
}

async fn study_view(From(site): From<Arc<Site>>) -> Json<serde_json::Value> {
    let version = *site.study.changes.borrow();
    Json(json!({ "version": version, "html": faults::view(&site.study.shown()) }))
}

#[derive(Debug, Deserialize)]
#[serde(tag = "do", rename_all = "snake_case")]
enum StudyCommand {
    Start,
    Cancel,
}

async fn study_command(
    From(site): From<Arc<Site>>,
    Json(command): Json<StudyCommand>,
) -> Answer<StatusCode> {
    match command {
        StudyCommand::Start => FaultStudy::start(&site).map_err(refused)?,
        StudyCommand::Cancel => site.study.cancel(),
    }
    Ok(StatusCode::NO_CONTENT)
}

async fn study_file(From(site): From<Arc<Site>>, body: Body) -> Answer<StatusCode> {
    let text = upload::text(body, Some(MOST_STUDY)).await;
    site.study.take(&text.map_err(|error| refused(error.to_string()))?).map_err(refused)?;
    Ok(StatusCode::NO_CONTENT)
}

#[derive(Debug, Deserialize)]
struct Run {
    run: usize,
}

async fn study_trace(
    From(site): From<Arc<Site>>,
    Query(Run { run }): Query<Run>,
) -> Answer<Response> {
    let traces = site.study.shown().traces.clone();
    let html = traces.and_then(|traces| faults::trace(&traces, run));
    let html = html.ok_or_else(|| refused("these results hold no traces of that run"))?;
    Ok(Json(json!({ "html": html })).into_response())
}

/// Work that would keep other requests waiting, on a thread of its own.
async fn off_the_loop<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> Answer<T> {
    tokio::task::spawn_blocking(work).await.map_err(|_| {
        (StatusCode::INTERNAL_SERVER_ERROR, Json(json!({ "problem": "an internal error" })))
            .into_response()
    })
}
