//! What is answered at which address.

use std::sync::atomic::Ordering;
use std::sync::{Arc, PoisonError};

use axum::body::Body;
use axum::extract::{Path, Query, State as Shared};
use axum::http::{StatusCode, header};
use axum::middleware;
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use axum::{Json, Router};
use serde::Deserialize;
use serde_json::json;

use super::answer::{Refusal, Reply, refused};
use super::command::Command;
use super::handlers::{bench, off_the_loop};
use super::law::TypedLaw;
use super::recordings::Taken;
use super::show::{View, pieces, within};
use super::signals::{MOST_POINTS, Wanted, signals};
use super::site::Site;
use super::{
    assets, diagnosis_routes, download, events, guard, shell, study_routes, upload, window,
};

/// Everything behind the guard.
pub(super) fn router(site: Arc<Site>) -> Router {
    Router::new()
        .route("/", get(open))
        .route("/assets/{name}", get(assets::asset))
        .route("/b/{id}/", get(page))
        .route("/b/{id}/events", get(events::events))
        .route("/b/{id}/pieces", get(show))
        .route("/b/{id}/signals", get(numbers))
        .route("/b/{id}/within", get(brushed))
        .route("/b/{id}/do", post(command))
        .route("/b/{id}/law", post(check))
        .route("/b/{id}/file", post(take))
        .route("/b/{id}/take/{what}", get(give))
        .route("/b/{id}/diagnosis", get(diagnosis_routes::view).post(diagnosis_routes::command))
        .route("/b/{id}/diagnosis/file", post(diagnosis_routes::file))
        .route("/b/{id}/diagnoser/{what}", get(diagnosis_routes::give))
        .route("/study", get(study_routes::view).post(study_routes::command))
        .route("/study/file", post(study_routes::file))
        .fallback(|| async { (StatusCode::NOT_FOUND, "there is nothing here\n") })
        .layer(middleware::from_fn_with_state(Arc::clone(&site.guard), guard::guard))
        .with_state(site)
}

/// A new session, or the one of the command line.
async fn open(Shared(site): Shared<Arc<Site>>) -> Response {
    let headers = [(header::LOCATION, format!("/b/{}/", site.opened()))];
    (StatusCode::SEE_OTHER, headers).into_response()
}

async fn page(Shared(site): Shared<Arc<Site>>, Path(id): Path<String>) -> Reply<Response> {
    let bench = bench(&site, &id)?;
    let html = [(header::CONTENT_TYPE, "text/html; charset=utf-8")];
    Ok((html, shell::page(&bench.id, site.most_bytes)).into_response())
}

#[derive(Debug, Deserialize)]
struct Looked {
    #[serde(default)]
    step: usize,
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
    Shared(site): Shared<Arc<Site>>,
    Path(id): Path<String>,
    Query(looked): Query<Looked>,
) -> Reply<Response> {
    let bench = bench(&site, &id)?;
    let version = *bench.changes.borrow();
    let state = bench.state();
    let view = View { step: looked.step, recording: looked.recording };
    let recordings = state.recordings.iter().map(|it| &it.name).collect::<Vec<_>>();
    let steps = state.steps.iter().map(|it| &it.label).collect::<Vec<_>>();
    let step = state.steps.get(looked.step);
    let spans =
        step.and_then(|it| it.compared.recordings.get(looked.recording)).map(|it| &it.spans);
    let answer = json!({
        "version": version,
        "beginning": state.beginnings,
        "pieces": pieces(&state, view),
        "recordings": recordings,
        "steps": steps,
        "spans": spans,
    });
    Ok(Json(answer).into_response())
}

async fn numbers(
    Shared(site): Shared<Arc<Site>>,
    Path(id): Path<String>,
    Query(looked): Query<Looked>,
) -> Reply<Response> {
    let bench = bench(&site, &id)?;
    let wanted = Wanted {
        recording: looked.recording,
        step: looked.step,
        ghost: looked.ghost,
        window: looked.window(),
        points: looked.points.unwrap_or(MOST_POINTS),
    };
    let bytes = signals(&bench.state(), &wanted)?;
    Ok(([(header::CONTENT_TYPE, "application/octet-stream")], bytes).into_response())
}

/// Where the model fails within a window; a window that was asked for later overtakes it.
async fn brushed(
    Shared(site): Shared<Arc<Site>>,
    Path(id): Path<String>,
    Query(looked): Query<Looked>,
) -> Reply<Response> {
    let bench = bench(&site, &id)?;
    let span = looked.window().ok_or_else(|| refused("a window has a beginning and an end"))?;
    let (step, whole, gathered) = {
        let state = bench.state();
        let missing = || refused("nothing was analysed");
        let whole = state.whole.clone().ok_or_else(missing)?;
        (state.step(looked.step)?, whole, state.gathered.clone().ok_or_else(missing)?)
    };
    let seed = site.seed;
    let mine = bench.looks.fetch_add(1, Ordering::Relaxed) + 1;
    let compared = off_the_loop(move || {
        let _alone = bench.looking.lock().unwrap_or_else(PoisonError::into_inner);
        let is_last = bench.looks.load(Ordering::Relaxed) == mine;
        let of = (&*whole, &*gathered);
        is_last.then(|| window::compared(&step, of, looked.recording, span, seed))
    });
    let overtaken = || Refusal::new(StatusCode::CONFLICT, "another window was asked for");
    let window = compared.await?.ok_or_else(overtaken)??;
    Ok(Json(json!({ "html": within(&window, span) })).into_response())
}

async fn command(
    Shared(site): Shared<Arc<Site>>,
    Path(id): Path<String>,
    Json(command): Json<Command>,
) -> Reply<StatusCode> {
    let bench = bench(&site, &id)?;
    off_the_loop(move || command.run(&bench)).await?.map_err(refused)?;
    Ok(StatusCode::NO_CONTENT)
}

/// Whether a typed law is right, and what it looks like.
async fn check(
    Shared(site): Shared<Arc<Site>>,
    Path(id): Path<String>,
    Query(looked): Query<Looked>,
    Json(law): Json<TypedLaw>,
) -> Reply<Response> {
    let bench = bench(&site, &id)?;
    let step = bench.state().step(looked.step)?;
    let curves = &step.compared.curves;
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
    Shared(site): Shared<Arc<Site>>,
    Path(id): Path<String>,
    Query(Named { name, more }): Query<Named>,
    body: Body,
) -> Reply<StatusCode> {
    let bench = bench(&site, &id)?;
    let name = upload::shown(&name);
    if name.to_lowercase().ends_with(".toml") {
        let text = upload::text(body, None).await?;
        bench.take_drive(&name, &text)?;
    } else {
        let path = upload::recording(&site, &name, body).await?;
        let taken = off_the_loop(move || Taken::uploaded(name, path)).await?.map_err(refused)?;
        bench.change(|state| {
            // The same file again replaces what was there; an example makes room.
            state.recordings.retain(|it| it.name != taken.name && !it.is_made());
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
    Shared(site): Shared<Arc<Site>>,
    Path((id, what)): Path<(String, String)>,
    Query(looked): Query<Looked>,
) -> Reply<Response> {
    let bench = bench(&site, &id)?;
    let number = looked.step;
    let step = bench.state().step(number)?;
    match (what.as_str(), looked.fmi) {
        ("drive.toml", _) => {
            let text = Ok(step.text.clone().into_bytes());
            Ok(download::file("application/toml", &super::command_line::file_of(number), text))
        }
        ("drive.fmu", Some(fmi @ (2 | 3))) => {
            let fmu = off_the_loop(move || download::fmu(&site, &step, fmi)).await?;
            Ok(download::file("application/octet-stream", &format!("drive_fmi{fmi}.fmu"), fmu))
        }
        ("report.html", _) => {
            let report = download::report(&bench.state(), number);
            let report = report.map(String::into_bytes).map_err(Into::into);
            Ok(download::file("text/html; charset=utf-8", "report.html", report))
        }
        _ => Err(Refusal::new(StatusCode::NOT_FOUND, "there is nothing here")),
    }
}
