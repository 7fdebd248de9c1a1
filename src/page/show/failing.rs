//! Where and when the model fails: spans, panels over variables, correlations; all of it, or within
//! a brushed window.

use drivescope_discovery::compare::{Comparison, Curve};
use maud::{Markup, PreEscaped, html};

use crate::page::window::Window;
use crate::report::compare::{pictures, verdict};
use crate::report::page::minus;
use crate::report::words::{given, number};

/// Width and height of the panels, pixels.
const WIDTH: f64 = 400.0;
const HEIGHT: f64 = 130.0;
/// The spans of a recording, each with its sentence.
pub(super) fn spans(compared: &Comparison, recording: usize) -> Markup {
    let spans = compared.recordings.get(recording).map_or(&[][..], |it| &it.spans);
    html! {
        h3 { "When it fails" }
        @if spans.is_empty() {
            p.note { "No span of time stands out." }
        } @else {
            ol.spans {
                @for span in spans {
                    li {
                        button.link type="button" data-from=(span.from) data-to=(span.to) { (span.sentence) }
                        " " span.note { "error " (number(span.error)) }
                    }
                }
            }
        }
    }
}

/// What is missing over each variable: the variables that were found first, then those whose
/// curve leaves zero out most.
pub(super) fn panels(compared: &Comparison, place: &str) -> Markup {
    let rank = |curve: &Curve| {
        let found = compared.findings.iter().position(|it| {
            it.variable == curve.variable
                || (it.variable == "omega_sign" && curve.variable == "omega")
        });
        let ends = curve.lower.iter().zip(&curve.upper);
        let outside = ends.filter(|(low, high)| **low > 0.0 || **high < 0.0).count();
        (found.unwrap_or(usize::MAX), -(outside as f64 / curve.x.len().max(1) as f64))
    };
    let mut order: Vec<usize> = (0..compared.curves.len()).collect();
    order.sort_by(|a, b| {
        let (a, b) = (rank(&compared.curves[*a]), rank(&compared.curves[*b]));
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
    html! {
        div.panels {
            @for number in order {
                @let curve = &compared.curves[number];
                figure {
                    (PreEscaped(pictures::curve_at(curve, &format!("{place}-{number}"), HEIGHT).svg_of(WIDTH)))
                    figcaption { (pictures::caption(curve)) }
                    (curve_data(curve))
                }
            }
        }
    }
}

fn curve_data(curve: &Curve) -> Markup {
    html! {
        details {
            summary { "Data" }
            div.scroll role="region" tabindex="0" aria-label={ "Data: " (curve.words) } {
                table {
                    thead { tr {
                        th scope="col" { (curve.variable) " [" (curve.x_unit) "]" }
                        th scope="col" { "missing [" (curve.unit) "]" }
                        th scope="col" { "95 % from" } th scope="col" { "to" }
                    } }
                    tbody {
                        @for (k, x) in curve.x.iter().enumerate() {
                            tr {
                                @for value in [*x, curve.value[k], curve.lower[k], curve.upper[k]] {
                                    td { (minus(&number(value))) }
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// The residual's correlations.
pub(super) fn white(compared: &Comparison, recording: usize) -> Markup {
    html! {
        @if let Some(it) = compared.recordings.get(recording) {
            details {
                summary {
                    "Is the residual white? "
                    @for output in &it.outputs {
                        span.note {
                            (output.name) ": "
                            (if output.autocorrelation.correlated { "no" } else { "yes" })
                            (if output.input_correlation.correlated { ", it knows the input. " } else { ". " })
                        }
                    }
                }
                figure { (PreEscaped(pictures::correlations(it, recording).svg())) }
            }
        }
    }
}

/// Where the model fails within a brushed window.
pub(in crate::page) fn within(window: &Window, (from, to): (f64, f64)) -> String {
    let Window { compared, errors } = window;
    let each = errors.iter().map(|(of, error)| format!("{} on {of}", number(*error)));
    let errors = each.collect::<Vec<_>>().join(" and ");
    html! {
        section.within aria-labelledby="within-h" {
            h3 #within-h { "Within " (given(from)) " to " (given(to)) " s" }
            p {
                (verdict(compared))
                @if !errors.is_empty() { " Its error is " (errors) ", in units of the noise." }
            }
            (panels(compared, "within"))
            @if let Some(it) = compared.recordings.first() {
                figure { (PreEscaped(pictures::correlations(it, 1000).svg())) }
            }
        }
    }
    .into_string()
}
