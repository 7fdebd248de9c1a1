//! The local page: drop a recording, see where the model fails, learn what is missing, add it.
//!
//! ```text
//!  browser ── guard (host, origin, token) ── routes ──> Site ──> Bench: one session of work
//!    ^                                                    │  recordings, steps of the ladder
//!    └── events: something changed <──────────────────────┘  job: reads, fits, compares, learns
//! ```
//!
//! The state lives here, under the name of the session in the address, so that a page reloaded
//! finds it again and several tabs see the same. HTML comes from the same functions as reports;
//! signals go as numbers and are drawn in the browser.

mod answer;
mod assets;
mod basis;
mod bench;
mod command;
mod command_line;
mod diagnosis;
mod diagnosis_routes;
mod download;
mod events;
mod example;
mod faults;
mod fresh;
mod guard;
mod handlers;
mod incomplete;
mod job;
mod law;
mod memory;
mod plain;
mod progress;
mod recordings;
mod routes;
mod session_step;
mod shell;
mod show;
mod signals;
mod site;
mod study;
mod study_routes;
mod unit_fix;
mod upload;
mod window;
mod work;

use std::future::IntoFuture;
use std::net::{Ipv4Addr, SocketAddr};
use std::path::PathBuf;
use std::pin::pin;
use std::sync::Arc;
use std::time::Duration;

use futures_util::future::{Either, select};
use tokio::net::TcpListener;

use crate::failure::Failure;
use crate::session::Session;
use guard::Guard;
use site::Site;

/// Time between two looks at whether the user wants the server to end.
const LOOK: Duration = Duration::from_millis(100);

/// What is served.
#[derive(Debug)]
pub(crate) struct Served {
    /// Port on the loopback address; 0 takes any that is free.
    pub(crate) port: u16,
    /// Drive file or built-in drive to begin with.
    pub(crate) drive: Option<String>,
    /// Recordings to begin with.
    pub(crate) recordings: Vec<PathBuf>,
    /// Greatest size of an uploaded file, bytes.
    pub(crate) most_bytes: u64,
}

/// Serves the page until the program is ended.
///
/// # Errors
/// A file to begin with that cannot be used, or a port that is taken.
pub(crate) fn serve(served: &Served, session: &Session) -> miette::Result<()> {
    memory::return_large_blocks();
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .worker_threads(2)
        .enable_io()
        .enable_time()
        .build()
        .map_err(|source| Failure::Serve { port: served.port, source })?;
    runtime.block_on(listen(served, session))
}

async fn listen(served: &Served, session: &Session) -> miette::Result<()> {
    let taken = |source| Failure::Serve { port: served.port, source };
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, served.port)).await.map_err(taken)?;
    let SocketAddr::V4(address) = listener.local_addr().map_err(taken)? else {
        unreachable!("an IPv4 address was bound")
    };
    let guard = Guard::new(address.port());
    let site = Site::new(guard, session.seed, served.most_bytes)?;
    site.begin_with(served)?;
    let url = format!("http://{address}/?token={}", site.guard.first_token());
    session.answer(
        &format!("{url}\nOpen this address in a browser; it works once. Ctrl-C ends the server.\n"),
        &serde_json::json!({ "url": url }),
    )?;
    let server = axum::serve(listener, routes::router(Arc::clone(&site)));
    let ended = async {
        while crate::interrupt::check().is_ok() {
            tokio::time::sleep(LOOK).await;
        }
    };
    let (server, ended) = (pin!(server.into_future()), pin!(ended));
    let ended = select(server, ended).await;
    // Work under way may hold the site; its files go with the server all the same.
    let _ = std::fs::remove_dir_all(site.folder.path());
    match ended {
        Either::Left((served, _)) => served.map_err(taken)?,
        // Whoever ends the server has got what was wanted.
        Either::Right(_) => {}
    }
    Ok(())
}
