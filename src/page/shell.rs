//! The frame of the page: what stands there before anything is known.

use maud::{DOCTYPE, Markup, html};

use super::example::EXAMPLES;
use super::upload;
use crate::report::words::number;

/// The page of a session.
pub(super) fn page(bench: &str, most_bytes: u64) -> String {
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { "drivescope" }
                link rel="icon" href="/assets/icon.svg" type="image/svg+xml";
                link rel="stylesheet" href="/assets/report.css";
                link rel="stylesheet" href="/assets/uplot.min.css";
                link rel="stylesheet" href="/assets/page.css";
                script src="/assets/uplot.min.js" defer {}
                script type="module" src="/assets/page.js" {}
            }
            body data-bench=(bench) data-most-bytes=(most_bytes) {
                a.skip href="#loop" { "Skip to the content" }
                header.top {
                    h1 { "drivescope" }
                    nav.views aria-label="Views" {
                        button type="button" data-view="loop" aria-pressed="true" { "Model and measurement" }
                        button type="button" data-view="diagnose" aria-pressed="false" { "Diagnose" }
                        button type="button" data-view="faults" aria-pressed="false" { "Faults" }
                        a href="/" { "New session" }
                    }
                }
                noscript { p.problem { "This page draws with JavaScript, which is switched off. Reports, which the command line writes, need none." } }
                div #status role="status" aria-live="polite" {}
                div #problem role="alert" {}
                main #loop tabindex="-1" {
                    (drop_zone(most_bytes))
                    (see())
                    (learn())
                    (add())
                }
                main #diagnose hidden {
                    div #diagnose-content { p.note { "Loading." } }
                }
                main #faults hidden {
                    div #faults-content { p.note { "Loading." } }
                }
            }
        }
    }
    .into_string()
}

fn drop_zone(most_bytes: u64) -> Markup {
    html! {
        section #drop aria-labelledby="drop-h" {
            h2 #drop-h { "Drop" span.about { " a recording of the drive" } }
            p.intro {
                "See where its model fails, learn which physical effect is missing, add it, and \
                 watch the error fall to the noise of the sensors."
            }
            label.zone for="file" {
                span { strong { "Drop recordings here" } " or " span.choose { "choose files" } }
                span.note {
                    (upload::named()) " with the input u and a current, speed or position; a drive \
                     file (.toml) is the model to begin with. Up to "
                    (number(most_bytes as f64 / 1e6)) " MB. Nothing leaves this machine."
                }
                input #file type="file" multiple accept=(upload::accepted());
            }
            p.examples {
                "Or begin with an example: "
                @for example in &EXAMPLES {
                    button type="button" data-do="example" data-id=(example.id) { (example.title) }
                }
            }
            div #data {}
        }
    }
}

fn see() -> Markup {
    html! {
        section #see aria-labelledby="see-h" hidden {
            h2 #see-h { "See" span.about { " where the model fails" } }
            div #verdict {}
            div.bar role="toolbar" aria-label="View of the signals" {
                label { "Recording " select #recording {} }
                label { "Compare with " select #ghost {} }
                button type="button" #zoom-out { "Whole recording" }
                button type="button" #earlier aria-label="earlier" { "\u{2190}" }
                button type="button" #later aria-label="later" { "\u{2192}" }
                label { "from " input #from type="text" inputmode="decimal" size="7"; " s" }
                label { "to " input #to type="text" inputmode="decimal" size="7"; " s" }
                span.keys.note { "Drag to brush a window; double-click for all. The cursor is shared." }
            }
            div #plots role="group" aria-label="Measured and modelled signals" {}
            details #signal-data {
                summary { "These signals as numbers" }
                div.scroll role="region" tabindex="0" aria-label="Signals as numbers" {}
            }
            div #spans {}
            div #within {}
            div #where {}
            div #white {}
        }
    }
}

fn learn() -> Markup {
    html! {
        section #learn aria-labelledby="learn-h" hidden {
            h2 #learn-h { "Learn" span.about { " what is missing" } }
            div #cards {}
            details.law {
                summary { "A law of your own" }
                form #law {
                    label { "It is a " select name="target" {
                        option value="torque" { "torque, N m" }
                        option value="voltage" { "voltage, V" }
                        option value="heat" { "heat in the winding, W" }
                        option value="omega" { "shown speed, rad/s" }
                        option value="i" { "shown current, A" }
                    } }
                    label.wide { "Law " input name="text" value="-c * omega * abs(omega)" autocomplete="off" spellcheck="false" aria-describedby="law-said"; }
                    label { "Coefficients " input name="coefficients" value="c" autocomplete="off" spellcheck="false" aria-describedby="law-said"; }
                    button type="submit" { "Add this law" }
                    p.note { "Variables omega, i, theta, u, t; functions such as abs, sign, sin, exp, tanh. A coefficient without a value starts at what fits the curve of what is missing." }
                    div #law-said role="status" aria-live="polite" {}
                }
            }
        }
    }
}

fn add() -> Markup {
    html! {
        section #add aria-labelledby="add-h" hidden {
            h2 #add-h { "Add" span.about { " it, and the error falls" } }
            div #ladder {}
            div #parameters {}
            div #take {}
        }
    }
}
