//! `campaign report`: what a campaign found, in the terminal and as a page.

use std::fmt::Write;
use std::io::Write as _;
use std::path::PathBuf;

use clap::Args;
use drivescope_scenarios::campaign::summary::{MethodSummary, Naming, Summary, Worst, summarise};
use drivescope_scenarios::campaign::{FolderError, Whole, parts_of};
use drivescope_scenarios::parity::Share;

use crate::commands::Run;
use crate::failure::{Ending, into_report};
use crate::next::Next;
use crate::output;
use crate::report::campaign::{campaign_html, rerun, sentence};
use crate::report::words::{count, number, percent};
use crate::session::Session;

/// Sum up a campaign: detection, delays, false alarms, what they depend on, the worst scenarios.
#[derive(Debug, Args)]
pub(super) struct Report {
    /// The folder.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Page to write; DIR/report.html by default.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// The plan file, to be named in the commands that rerun scenarios.
    #[arg(long, value_name = "PLAN", default_value = "PLAN.toml")]
    plan: PathBuf,
}

impl Run for Report {
    fn run(self, session: &Session) -> miette::Result<Ending> {
        let page = self.out.clone().unwrap_or_else(|| self.folder.join("report.html"));
        let Whole { parts, damaged } = parts_of(&self.folder, None).map_err(into_report)?;
        if let Some((path, source)) = damaged.into_iter().next() {
            return Err(into_report(FolderError::Damaged { path, source }));
        }
        if parts.is_empty() {
            return Err(into_report(FolderError::Nothing { path: self.folder.clone() }));
        }
        session.check_writable(&[&page])?;
        let summary = summarise(&parts).map_err(into_report)?;
        let plan = self.plan.display().to_string();
        let said = parts.first().map_or("", |part| part.plan());
        let html = campaign_html(&summary, &plan, said);
        output::write_file(&page, |out| out.write_all(html.as_bytes()))?;
        session.remark(format_args!("report: {}", page.display()));
        let next = first_worst(&summary).map_or_else(
            || Next::new("campaign merge").with(self.folder.display()),
            |worst| {
                Next::new("campaign").with(&plan).options(&format!(" --only {}", worst.scenario))
            },
        );
        session.say(&text(&summary, &plan), &summary, &next)?;
        Ok(Ending::Done)
    }
}

fn first_worst(summary: &Summary) -> Option<&Worst> {
    summary.methods.iter().find_map(|method| method.worst.first())
}

fn text(summary: &Summary, plan: &str) -> String {
    let mut text = format!(
        "{} of {} scenarios, {} of them healthy; intervals: 95 %, Wilson\n",
        summary.scenarios, summary.planned, summary.healthy
    );
    for (numbers, what) in [
        (&summary.not_finite, "grew without bound"),
        (&summary.aborted, "ended the process that ran them"),
    ] {
        if !numbers.is_empty() {
            let numbers: Vec<String> = numbers.iter().map(u64::to_string).collect();
            let _ = writeln!(text, "{what}: scenarios {}", numbers.join(", "));
        }
    }
    for method in &summary.methods {
        let _ = writeln!(text, "\n{}", sentence(method));
        detection(&mut text, method);
        if let Some(naming) = &method.naming {
            named(&mut text, naming);
        }
        if !method.sensitivity.is_empty() {
            let _ = writeln!(
                text,
                "  depends on (first-order Sobol index): {:<22} detected   delay",
                ""
            );
            let index = |it: Option<f64>| it.map_or("-".to_owned(), |it| format!("{it:.3}"));
            for row in method.sensitivity.iter().take(8) {
                let (detected, delay) = (index(row.detected), index(row.delay));
                let _ = writeln!(text, "    {:<57}  {detected:>8} {delay:>7}", row.input);
            }
        }
        for worst in &method.worst {
            let _ = writeln!(text, "  {}: {}", worst_in_words(worst), rerun(plan, worst.scenario));
        }
    }
    text
}

fn detection(text: &mut String, method: &MethodSummary) {
    let _ = writeln!(
        text,
        "  {:<24} {:>21} {:>24} {:>22}",
        "kind", "size", "detected", "delay s (5 to 95 %)"
    );
    for kind in &method.kinds {
        for size in &kind.sizes {
            let [low, high] = size.detected.interval;
            let range = match size.from == size.to {
                true => number(size.from),
                false => format!("{} to {}", number(size.from), number(size.to)),
            };
            let share = format!(
                "{}/{} ({}-{} %)",
                size.detected.hits,
                size.detected.of,
                percent(low, 0),
                percent(high, 0)
            );
            let delay = match size.delay_s.mean.is_finite() {
                false => "-".to_owned(),
                true => format!(
                    "{:.3} ({:.3} to {:.3})",
                    size.delay_s.mean, size.delay_s.range[0], size.delay_s.range[1]
                ),
            };
            let _ = writeln!(text, "  {:<24} {range:>21} {share:>24} {delay:>22}", kind.kind);
        }
    }
}

/// What was named of what failed: shares of the judged, and the names by their number.
fn named(text: &mut String, naming: &Naming) {
    let _ = writeln!(
        text,
        "  {:<24} {:>12} {:>12} {:>14} {:>12}  named",
        "kind", "named first", "in the set", "interval holds", "size, rms"
    );
    let share = |share: &Share| match share.of {
        0 => "-".to_owned(),
        of => format!("{}/{of}", share.hits),
    };
    for kind in &naming.kinds {
        let names = kind.named.iter().map(|it| format!("{} {}", it.what, it.scenarios));
        let _ = writeln!(
            text,
            "  {:<24} {:>12} {:>12} {:>14} {:>12}  {}",
            kind.kind,
            share(&kind.right),
            share(&kind.in_set),
            share(&kind.covered),
            kind.size_error.map_or_else(|| "-".to_owned(), number),
            names.collect::<Vec<_>>().join(", ")
        );
    }
}

fn worst_in_words(worst: &Worst) -> String {
    let fault = match (&worst.kind, worst.size) {
        (Some(kind), Some(size)) => format!("{kind} of {}", number(size)),
        (Some(kind), None) => kind.clone(),
        (None, _) => "health".to_owned(),
    };
    match (worst.what, worst.value) {
        ("late", Some(delay)) => format!("late, {delay:.3} s, {fault}"),
        ("false_alarms", Some(alarms)) => {
            format!("{}, {fault}", count(alarms as usize, "false alarm"))
        }
        _ => format!("missed, {fault}"),
    }
}
