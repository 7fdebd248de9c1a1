//! `benchmark speed`: what runs cost, beside other people's programs and the machine's bounds.

use std::io::Write;
use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::bar::Bar;
use crate::benchmark::speed::{PARTS, Speed};
use crate::commands::Run;
use crate::failure::Ending;
use crate::next::Next;
use crate::output;
use crate::report::speed::{Line, speed_html, text};
use crate::session::Session;

/// What runs cost: alone, in lanes, in threads; beside `ode_solvers`, scipy and fmpy, and what the
/// machine could do.
///
/// All of it takes turns on this machine, now: give it an idle one. scipy and fmpy are those of the
/// Python of DRIVESCOPE_PYTHON, or of python3 on the path; what is not there is left out and said.
#[derive(Debug, Args)]
pub(super) struct OfSpeed {
    /// A quick look: small campaigns and few samples in Python.
    #[arg(long)]
    short: bool,
    /// Page to write (.html): the figures, and how costs grow.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

#[derive(Debug, Serialize)]
struct SpeedBenchmark<'a> {
    #[serde(flatten)]
    speed: &'a Speed,
    bars: &'a [Bar],
}

impl Run for OfSpeed {
    fn run(self, session: &Session) -> miette::Result<Ending> {
        session.check_writable(&self.out.iter().collect::<Vec<_>>())?;
        let progress = session.progress(PARTS, "timing");
        let speed = Speed::measure(self.short, &|| progress.inc(1))?;
        progress.finish_and_clear();
        let bars = bars(&speed);
        if let Some(path) = &self.out {
            let lines: Vec<Line> = bars.iter().map(Bar::parts).collect();
            let html = speed_html(&speed, &lines);
            output::write_file(path, |out| out.write_all(html.as_bytes()))?;
        }
        let stated: String = bars.iter().map(Bar::line).collect();
        let answer = SpeedBenchmark { speed: &speed, bars: &bars };
        session.say(&(text(&speed) + &stated), &answer, &Next::new("benchmark discovery"))?;
        Ok(Ending::Done)
    }
}

/// Scenarios that the bars of campaigns speak of, in seconds on two cores.
const MANY: f64 = 1e5;

fn bars(speed: &Speed) -> Vec<Bar> {
    let [alone, lanes] = speed.gains();
    let (own, other) = (speed.errors[0], speed.errors[1]);
    let on_two = |scenario_s: f64| MANY * scenario_s / 2.0;
    let mut bars = vec![
        Bar::at_least("times as fast as Dopri5 at 1e-6, one drive", alone, 200.0),
        Bar::at_most("its error as a share of Dopri5's", own / other, 1.0),
        Bar::at_least("times as fast as Dopri5 at 1e-6, lanes on one core", lanes, 600.0),
        Bar::at_most(
            "lanes over the bound of the machine's arithmetic",
            speed.lane_s / speed.lane_bound_s,
            2.0,
        ),
        Bar::at_most("exact step, one drive [ns a sample]", 1e9 * speed.step_s, 10.0),
        Bar::at_most("exact step, lanes [ns a sample and lane]", 1e9 * speed.lane_s, 1.5),
        Bar::at_most("closed loop of 5000 samples [us]", 1e6 * speed.closed_loop_s, 60.0),
        Bar::at_most(
            "twelve scenarios with their noise, lanes [us]",
            1e6 * speed.twelve_s[1],
            150.0,
        ),
        Bar::at_most("stick-slip [ns a sample]", 1e9 * speed.stick_slip_s, 200.0),
        Bar::at_most(
            "100,000 scenarios with noise, two cores [s]",
            on_two(speed.scenario_s[0]),
            4.0,
        ),
        Bar::at_most("the same with bands and CUSUM [s]", on_two(speed.scenario_s[1]), 10.0),
    ];
    if speed.threads > 1 {
        // What two threads must gain over one, and more of them in proportion.
        let bar = 0.9 * speed.threads as f64;
        let what = format!("times as fast on {} threads as on one", speed.threads);
        bars.push(Bar::at_least(what, speed.threads_gain, bar));
    }
    let peers = &speed.peers;
    if let Some(scipy) = peers.scipy_s {
        bars.push(Bar::at_least("times as fast as scipy's solve_ivp", scipy / speed.step_s, 1e4));
    }
    let loop_s = speed.closed_loop_s / crate::benchmark::speed::SAMPLES as f64;
    if let Some(fmpy) = peers.fmpy_loop_s {
        bars.push(Bar::at_least(
            "times as fast as a loop over fmpy's doStep",
            fmpy / loop_s,
            200.0,
        ));
    }
    bars
}
