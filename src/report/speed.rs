//! What runs cost, as text and as a page.

use maud::{Markup, html};

use super::page::{figure, page, section, table};
use super::plot::{Axis, Dash, Figure, Ink, Layer, Panel};
use super::words::significant;
use crate::benchmark::speed::{Growth, Speed};

/// What is measured, its value, its bar, and whether it is met.
pub(crate) type Line<'a> = (&'a str, f64, f64, bool);

const HEIGHT: f64 = 160.0;
const DIGITS: i32 = 3;

/// Figures that are held against no bar, a line each.
fn plain(speed: &Speed) -> Vec<(&'static str, String)> {
    let ns = |seconds: f64| format!("{} ns", significant(1e9 * seconds, DIGITS));
    let us = |seconds: f64| format!("{} us", significant(1e6 * seconds, DIGITS));
    let peers = &speed.peers;
    let or_why = |seconds: Option<f64>, version: &Option<String>, why: &Option<String>| {
        seconds.map_or_else(
            || format!("not there: {}", why.as_deref().unwrap_or("no reason given")),
            |it| {
                format!("{} a sample (version {})", us(it), version.as_deref().unwrap_or("unknown"))
            },
        )
    };
    vec![
        (
            "the machine at its best, one core",
            format!(
                "{} additions and multiplications a ns",
                significant(1e-9 * speed.machine.flops, DIGITS)
            ),
        ),
        ("a multiplication and an addition that wait for each other", ns(speed.machine.latency_s)),
        ("a lane's step at the machine's best", ns(speed.lane_bound_s)),
        ("Dopri5 of ode_solvers at 1e-6", format!("{} a sample", us(speed.dopri5_s))),
        (
            "greatest error of the speed, this program and Dopri5",
            format!("{:.1e} and {:.1e} rad/s", speed.errors[0], speed.errors[1]),
        ),
        ("twelve scenarios in lanes, noise drawn before", us(speed.twelve_s[0])),
        ("scipy, solve_ivp at 1e-6", or_why(peers.scipy_s, &peers.scipy, &peers.scipy_why)),
        ("fmpy, a loop over doStep", or_why(peers.fmpy_loop_s, &peers.fmpy, &peers.fmpy_why)),
        ("fmpy, simulate_fmu", or_why(peers.fmpy_simulate_s, &peers.fmpy, &peers.fmpy_why)),
    ]
}

/// The figures without bars, and how costs grow.
pub(crate) fn text(speed: &Speed) -> String {
    let mut text = String::new();
    for (what, value) in plain(speed) {
        text += &format!("{what}: {value}\n");
    }
    for Growth { over, what, unit, points } in &speed.growth {
        let points: Vec<String> = points
            .iter()
            .map(|(x, y)| format!("{x}: {} {unit}", significant(*y, DIGITS)))
            .collect();
        text += &format!("{what} over {over}: {}\n", points.join(", "));
    }
    text
}

/// One self-contained page.
pub(crate) fn speed_html(speed: &Speed, lines: &[Line]) -> String {
    let about = html! {
        "Every ratio is of work that took turns in one process on this machine. Times are of one core \
         unless threads are named."
    };
    let met = lines.iter().filter(|line| line.3).count();
    let bars = html! {
        p { (met) " of " (lines.len()) " bars are met." }
        (table(
            "Figures and bars",
            &html! { tr { th.name { "Figure" } th { "Measured" } th { "Bar" } th { "" } } },
            &html! {
                @for (what, value, bar, met) in lines {
                    tr {
                        th scope="row" { (what) }
                        td { (significant(*value, DIGITS)) }
                        td { (bar) }
                        td { @if *met { "met" } @else { strong { "missed" } } }
                    }
                }
            },
        ))
    };
    let others = table(
        "Figures without a bar",
        &html! { tr { th.name { "Figure" } th { "Measured" } } },
        &html! { @for (what, value) in plain(speed) { tr { th scope="row" { (what) } td { (value) } } } },
    );
    let sections = html! {
        (section("figures", "Figures", &html! { (bars) (others) }))
        (section("growth", "How costs grow", &html! {
            @for growth in &speed.growth { (grown(growth)) }
        }))
    };
    page("Speed", &about, &sections, &html! { "drivescope benchmark speed" })
}

/// A curve.
fn grown(growth: &Growth) -> Markup {
    let Growth { over, what, unit, points } = growth;
    let id = format!("growth-{}", over.replace(' ', "-"));
    let drawn = Figure {
        id: format!("{id}-plot"),
        title: format!("{what} over {over}"),
        description: format!("Cost of {what} in {unit} against the number of {over}"),
        x: Axis::new(*over, ""),
        spans: Vec::new(),
        markers: Vec::new(),
        panels: vec![Panel {
            height: HEIGHT,
            y: Axis::new(*what, *unit)
                .from_to(0.0, points.iter().map(|it| it.1).fold(0.0, f64::max)),
            layers: vec![Layer::Line {
                label: String::new(),
                points: points.clone(),
                ink: Ink::Blue,
                dash: Dash::Solid,
            }],
            strip: None,
        }],
    };
    let caption = html! {
        (what) ": "
        @for (k, (x, y)) in points.iter().enumerate() {
            @if k > 0 { ", " } (x) ": " (significant(*y, DIGITS)) " " (unit)
        }
    };
    figure(&id, drawn.svg(), &format!("{what} over {over}"), &caption)
}
