//! Files that the page loads, embedded in the program.

use axum::extract::Path;
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};

/// Name, kind and content of each. uPlot 1.6.32 is as its maker released it, with its licence.
const FILES: [(&str, &str, &str); 9] = [
    ("page.js", "text/javascript", include_str!("assets/page.js")),
    ("plots.js", "text/javascript", include_str!("assets/plots.js")),
    ("diagnosis.js", "text/javascript", include_str!("assets/diagnosis.js")),
    ("faults.js", "text/javascript", include_str!("assets/faults.js")),
    ("page.css", "text/css", include_str!("assets/page.css")),
    ("uplot.min.js", "text/javascript", include_str!("assets/uplot.min.js")),
    ("uplot.min.css", "text/css", include_str!("assets/uplot.min.css")),
    ("uplot.LICENSE", "text/plain", include_str!("assets/uplot.LICENSE")),
    ("icon.svg", "image/svg+xml", include_str!("assets/icon.svg")),
];
/// The style of reports, which the page shares.
const STYLE: &str = "report.css";

/// One of the files.
pub(super) async fn asset(Path(name): Path<String>) -> Response {
    if name == STYLE {
        let kind = [(header::CONTENT_TYPE, "text/css; charset=utf-8")];
        return (kind, crate::report::page::style()).into_response();
    }
    match FILES.iter().find(|file| file.0 == name) {
        Some((_, kind, content)) => {
            let kind = [(header::CONTENT_TYPE, format!("{kind}; charset=utf-8"))];
            (kind, *content).into_response()
        }
        None => (StatusCode::NOT_FOUND, "there is no such file\n").into_response(),
    }
}
