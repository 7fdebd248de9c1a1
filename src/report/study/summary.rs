//! First and last words: what was found, where to look, how to read it.

use drivescope_scenarios::results::{DetectionRow, DetectorKind, Pictures, StudyResults};
use maud::{Markup, html};

use super::picture;
use crate::report::page::{math, minus, section};
use crate::report::words::{given, lead, percent, rows_of, verdict};

/// The verdict and the four figures that carry it.
pub(super) fn headline(study: &StudyResults) -> Markup {
    let rows = rows_of(&study.detection, DetectorKind::Mem);
    let found = rows.iter().filter(|row| row.detected()).count();
    let alarms = study.healthy.alarms.of(DetectorKind::Mem);
    let class = |good: bool| if good { "good" } else { "alert" };
    html! {
        p.verdict { (verdict(study, DetectorKind::Mem)) "." }
        p.second { "For comparison: " (verdict(study, DetectorKind::Constant)) "." }
        dl.tiles {
            div {
                dt { "Faults detected" }
                dd {
                    span class=(class(found == rows.len())) { (found) " of " (rows.len()) }
                    span.sub { "bands by model error modelling" }
                }
            }
            div {
                dt { "False alarms" }
                dd {
                    span class=(class(alarms == 0)) { (alarms) }
                    span.sub { "in " (study.healthy.samples) " healthy samples" }
                }
            }
            div { dt { "Delay to declaration" } dd { (delays(study, &rows)) } }
            div {
                dt { (math("Healthy samples outside, r_fd")) }
                dd {
                    (percent(study.r_fd.of(DetectorKind::Mem), 2)) " %"
                    span.sub {
                        "designed " (percent(study.beta, 0)) " %, paper "
                        (percent(study.paper.r_fd.mem, 1)) " %"
                    }
                }
            }
        }
    }
}

fn delays(study: &StudyResults, rows: &[&DetectionRow]) -> Markup {
    let mut delays: Vec<usize> = rows.iter().filter_map(|row| row.delay).collect();
    delays.sort_unstable();
    let (Some(least), Some(most)) = (delays.first(), delays.last()) else {
        return html! { "none declared" };
    };
    let middle = [delays[(delays.len() - 1) / 2], delays[delays.len() / 2]];
    let median = (middle[0] + middle[1]) as f64 / 2.0;
    html! {
        (given(1e3 * study.drive.period_s * median)) " ms"
        span.sub {
            "median, " (median) " samples; range " (least) " to " (most) " (the rule itself takes "
            (study.window) ")"
        }
    }
}

/// Links to the sections and to each run.
pub(super) fn contents(pictures: &[Pictures]) -> Markup {
    html! {
        nav aria-label="Contents" {
            ul {
                @for section in super::SECTIONS {
                    li { a href={ "#" (section.id) } { (section.name) } }
                }
            }
            @if !pictures.is_empty() {
                ul aria-label="Runs" {
                    @for (place, picture) in pictures.iter().enumerate() {
                        li { a href={ "#" (picture::id(place)) } { (picture::name(picture)) } }
                    }
                }
            }
        }
    }
}

/// What the figures do not say by themselves.
pub(super) fn reading(study: &StudyResults) -> Markup {
    let (ours, paper) = (study.r_fd.of(DetectorKind::Mem), study.paper.r_fd.mem);
    section(
        "reading",
        "How to read these figures",
        &html! {
            ul.reading {
                li {
                    "They depend on the assumed noise (see "
                    a href="#setting" { "Experiment" }
                    "), which the paper does not state. With more noise the smallest faults are "
                    "found late or not at all; with less, smaller ones than these are found."
                }
                li {
                    "Adaptive bands lead over constant thresholds by what the process model lacks: "
                    "the better the model, the smaller their lead. " (minus(&lead(study)))
                }
                li {
                    "The share of healthy samples outside the bands is designed: "
                    (percent(study.beta, 0)) " %. It is right when it is met (here "
                    (percent(ours, 2)) " %), not when it is small. The paper's "
                    (percent(paper, 1)) " % suggests bands wider than its confidence "
                    "level asks for."
                }
                li {
                    "A false alarm is " (study.window) " samples in a row outside, not one sample."
                }
                li {
                    "Each fault was run once, with noise drawn from one seed: another seed moves "
                    "delays by a few samples. The size of a fault, its begin and its end were not "
                    "known to the diagnoser, and the runs that judge were not used in its design."
                }
            }
        },
    )
}
