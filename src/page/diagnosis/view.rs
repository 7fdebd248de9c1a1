//! The view of training and diagnosing.

use maud::{Markup, html};

use super::super::bench::State;
use super::super::command_line::file_of;
use super::super::upload;
use super::FILE;
use super::material::{Judged, Material, Ready};
use crate::answer::block::{Block, Picture, Plot};
use crate::answer::html;
use crate::next::Next;
use crate::page::recordings::Taken;
use crate::report::page::table;

/// The whole view.
pub(in crate::page) fn view(state: &State) -> String {
    let diagnosis = &state.diagnosis;
    let healthy = diagnosis.material.iter().any(|it| it.healthy);
    html! {
        section #diagnosis aria-labelledby="diagnosis-h" {
            h2 #diagnosis-h { "Diagnose" span.about { " train on healthy runs, watch others" } }
            p.intro {
                "A diagnoser learns what a healthy machine does. It then says of other recordings \
                 what lies outside, since when, and, where it knows the drive, what failed and how \
                 large the fault is."
            }
            div.zones {
                (zone(true, "Healthy recordings", "they train the diagnoser: 20 s or more in all"))
                (zone(false, "Recordings to watch", "they begin healthily, for about 5 s"))
            }
            (of_session(state))
            (materials(&diagnosis.material))
            div.bar {
                @if !state.steps.is_empty() {
                    label { "It knows the drive of "
                        select #diagnosis-drive data-diagnose="drive" {
                            option value="" selected[diagnosis.step.is_none()] { "no step" }
                            @for (number, step) in state.steps.iter().enumerate() {
                                option value=(number) selected[diagnosis.step == Some(number)] { (step.label) }
                            }
                        }
                    }
                }
                button.add type="button" data-diagnose="train" disabled[!healthy] {
                    @if diagnosis.ready.is_some() { "Train again" } @else { "Train" }
                }
                @if state.steps.is_empty() {
                    span.note { "Fit a drive under \u{201c}Model and measurement\u{201d} and the \
                        diagnoser can name what failed." }
                }
            }
        }
        @if let Some(ready) = &diagnosis.ready {
            (trained(ready))
            @for (number, material) in diagnosis.material.iter().filter(|it| !it.healthy).enumerate() {
                (watched(number, material))
            }
            (command_lines(ready, &diagnosis.material))
        }
    }
    .into_string()
}

fn zone(healthy: bool, title: &str, note: &str) -> Markup {
    let id = if healthy { "healthy-file" } else { "watched-file" };
    html! {
        label.zone for=(id) data-healthy=(healthy) {
            span { strong { (title) } " " span.choose { "choose files" } " or drop them here" }
            span.note { (note) }
            input id=(id) type="file" multiple accept=(upload::accepted()) data-healthy=(healthy);
        }
    }
}

/// Recordings of the session that may serve here.
fn of_session(state: &State) -> Markup {
    let here = |name: &str| state.diagnosis.material.iter().any(|it| it.name == name);
    let whole = |(_, it): &(usize, &Taken)| it.recording.is_some() && !here(&it.name);
    let others: Vec<_> = state.recordings.iter().enumerate().filter(whole).collect();
    html! {
        @if !others.is_empty() {
            ul.session {
                @for (number, taken) in others {
                    li {
                        (taken.name) " of this session: "
                        button type="button" data-diagnose="take" data-recording=(number) data-healthy="true" { "Train on it" }
                        " "
                        button type="button" data-diagnose="take" data-recording=(number) data-healthy="false" { "Watch it" }
                    }
                }
            }
        }
    }
}

fn materials(material: &[Material]) -> Markup {
    let head = html! { tr {
        th.name scope="col" { "Recording" } th scope="col" { "Seconds" }
        th.name scope="col" { "Signals" } th.name scope="col" { "For" } th.name scope="col" { "" }
    } };
    let body = html! { @for it in material { tr {
        th scope="row" { (it.name) }
        td { (format!("{:.1}", it.recording.len() as f64 * it.recording.period_s)) }
        td.words { (it.recording.signals.iter().map(|it| it.name.as_str()).collect::<Vec<_>>().join(", ")) }
        td.name {
            select data-diagnose="mark" data-name=(it.name) aria-label={ "what " (it.name) " is for" } {
                option value="true" selected[it.healthy] { "training, it is healthy" }
                option value="false" selected[!it.healthy] { "watching" }
            }
        }
        td { button type="button" data-diagnose="remove" data-name=(it.name) aria-label={ "Remove " (it.name) } { "Remove" } }
    } } };
    html! { @if !material.is_empty() { (table("Recordings", &head, &body)) } }
}

fn trained(ready: &Ready) -> Markup {
    html! {
        section aria-labelledby="trained-h" {
            h2 #trained-h { "The diagnoser"
                span.about { " of " (ready.trained.learned.diagnoser.interface.output.name) }
            }
            details {
                summary { "What the training came to" }
                (html::page(&ready.trained.blocks(), &|_| None))
            }
            p.exports {
                a.button href="diagnoser/toml" download=(FILE) { "Diagnoser file" }
                a.button href="diagnoser/fmu?fmi=2" download="diagnoser_fmi2.fmu" { "FMU, FMI 2.0" }
                a.button href="diagnoser/fmu?fmi=3" download="diagnoser_fmi3.fmu" { "FMU, FMI 3.0" }
            }
        }
    }
}

/// The figure of a recording.
fn drawn(svg: &str, recording: &str) -> Block {
    let title = format!("Residual and declared faults of {recording}");
    let (svg, caption) = (svg.to_owned(), String::new());
    Block::Figure(Picture { plot: Plot::Drawn { title, svg }, caption })
}

fn watched(number: usize, material: &Material) -> Markup {
    let id = format!("watched-{number}-h");
    html! {
        section aria-labelledby=(id) {
            h2 id=(id) { (material.name) }
            @match material.judged.as_deref() {
                None => p { "Not watched yet. "
                    button type="button" data-diagnose="judge" { "Watch it now" } },
                Some(Judged { answer: Err(problem), .. }) => p.problem { (problem) },
                Some(Judged { answer: Ok(answer), figure }) => {
                    div data-verdict=(answer.verdict) {
                        (html::page(&answer.with_figure(figure.as_deref().map(|it| drawn(it, &material.name))), &|_| None))
                    }
                }
            }
        }
    }
}

/// What does the same on a command line.
fn command_lines(ready: &Ready, material: &[Material]) -> Markup {
    let named = ready.healthy.iter().fold(Next::new("train"), |next, name| next.with(name));
    let drive = ready.step.iter();
    let train = drive.fold(named, |next, step| next.options(" --drive").with(file_of(*step)));
    let train = train.options(" --without recurrent,gmdh -o").with(FILE);
    let mut lines = vec![train.command().to_owned()];
    let watched = material.iter().filter(|it| !it.healthy);
    lines.extend(
        watched.map(|it| Next::new("diagnose").with(FILE).with(&it.name).command().to_owned()),
    );
    html! {
        section aria-labelledby="same-h" {
            h3 #same-h { "The same on a command line" }
            pre tabindex="0" { (lines.join("\n")) }
        }
    }
}
