//! The report of a campaign: what was detected, how late, and at what price.

mod figures;
mod naming;
mod tables;

use drivescope_scenarios::campaign::summary::{Count, MethodSummary, Summary};
use maud::html;

use super::page::{page, section};
use super::words::{count, number, percent};
use crate::next::Next;

/// One self-contained HTML page: what a campaign found; `plan` is its file, for the commands that
/// rerun scenarios, `said` the text of it.
pub(crate) fn campaign_html(summary: &Summary, plan: &str, said: &str) -> String {
    let about = html! {
        (summary.scenarios) " of " (summary.planned) " scenarios, " (summary.healthy)
        " of them healthy. Shares with Wilson's 95 % intervals."
    };
    let sections = html! {
        (section("findings", "Findings", &html! {
            ul { @for method in &summary.methods { li { (sentence(method)) } } }
            (tables::set_aside(summary))
        }))
        @for method in &summary.methods { (tables::detection(method, figures::detection(method))) }
        @for method in &summary.methods { (naming::naming(method)) }
        (tables::false_alarms(summary))
        (tables::sensitivity(summary))
        (tables::worst(summary, plan))
        (section("plan", "The plan", &html! { pre { (said) } }))
    };
    let tells_what = summary.methods.iter().any(|method| method.naming.is_some());
    let made = html! {
        "drivescope campaign report, plan " code { (summary.plan_digest) } ", version "
        (summary.version) ". The same plan gives the same figures, however the work was split."
        @if !tells_what {
            " These detectors tell that something failed, not what: there is no table of confusion."
        }
    };
    page("Fault campaign", &about, &sections, &made)
}

/// What a method found, in one line.
pub(crate) fn sentence(method: &MethodSummary) -> String {
    let [low, high] = method.detected.interval;
    let found = match method.detected.of {
        0 => "no fault to detect".to_owned(),
        of => format!(
            "{} of {of} faults detected ({} to {} %)",
            method.detected.hits,
            percent(low, 1),
            percent(high, 1)
        ),
    };
    let alarms = match method.false_alarms {
        0 => format!("no false alarm in {} h of health", number(method.healthy_hours)),
        1 => format!("1 false alarm in {} h of health", number(method.healthy_hours)),
        count => format!(
            "{count} false alarms in {} h of health, one in {} h",
            number(method.healthy_hours),
            number(method.hours_between())
        ),
    };
    let not_learned = not_learned(method).map_or_else(String::new, |said| format!(", {said}"));
    format!("{}: {found}, {alarms}{not_learned}", method.method)
}

/// Scenarios that a method did not judge, for it learned no machine in them; nothing without any.
fn not_learned(method: &MethodSummary) -> Option<String> {
    let reasons = &method.naming.as_ref().filter(|it| !it.not_learned.is_empty())?.not_learned;
    let all: usize = reasons.iter().map(|reason| reason.scenarios).sum();
    let each = |reason: &Count| format!("{} {}", reason.what, reason.scenarios);
    let each: Vec<String> = reasons.iter().map(each).collect();
    Some(format!("{} not judged, no machine learned ({})", count(all, "scenario"), each.join(", ")))
}

/// The command that runs a scenario again.
pub(crate) fn rerun(plan: &str, scenario: u64) -> String {
    Next::new("campaign").with(plan).options(&format!(" --only {scenario}")).command().to_owned()
}

#[cfg(test)]
mod tests {
    use drivescope_scenarios::campaign::summary::{
        KindRow, NamedKind, Naming, Sensitivity, SizeRow, Worst,
    };
    use drivescope_scenarios::parity::{Share, Spread};
    use scraper::{Html, Selector};

    use super::*;

    fn summary() -> Summary {
        let size = |from: f64, hits| SizeRow {
            from,
            to: from,
            detected: Share::new(hits, 20),
            delay_s: Spread::of([0.3, 0.4]),
        };
        let kind = KindRow {
            kind: "<tacho>".to_owned(),
            detected: Share::new(25, 40),
            delay_s: Spread::of([0.3]),
            outside_fault: Spread::of([0.9]),
            sizes: vec![size(0.01, 5), size(0.1, 20)],
        };
        let index = |input: &str, detected| Sensitivity {
            input: input.to_owned(),
            detected: Some(detected),
            delay: None,
        };
        let worst = Worst {
            scenario: 17,
            what: "missed",
            kind: Some("<tacho>".to_owned()),
            size: Some(0.01),
            value: None,
        };
        let method = MethodSummary {
            method: "bands".to_owned(),
            detected: Share::new(25, 40),
            kinds: vec![kind],
            false_alarms: 2,
            healthy_hours: 4.0,
            silent: Share::new(38, 40),
            outside_healthy: Spread::of([0.05, 0.06]),
            naming: None,
            sensitivity: vec![index("fault_size", 0.6), index("R", 0.1)],
            worst: vec![worst],
        };
        Summary {
            plan_digest: "12ab".to_owned(),
            version: "0.1.0".to_owned(),
            scenarios: 40,
            planned: 48,
            healthy: 0,
            not_finite: vec![3],
            aborted: Vec::new(),
            every: 1,
            methods: vec![method],
        }
    }

    #[test]
    fn a_browser_has_nothing_to_mend_and_every_scenario_its_command() {
        let text = campaign_html(&summary(), "my plan.toml", "draws = 1 # <b>");
        let page = Html::parse_document(&text);
        assert!(page.errors.is_empty(), "{:?}", page.errors);
        let count = |selector: &str| page.select(&Selector::parse(selector).unwrap()).count();
        assert_eq!(count("script, img, link, iframe, b"), 0);
        assert_eq!(count("#detection-bands tbody tr"), 2);
        assert_eq!(count("#detection-bands svg.plot"), 1);
        assert_eq!(count("#worst tbody tr"), 1);
        assert!(text.contains("drivescope campaign 'my plan.toml' --only 17"));
        assert!(text.contains("grew without bound") && !text.contains("ended the process"));
        assert!(!text.contains("NaN"));
    }

    #[test]
    fn what_was_named_is_told_with_what_was_not_judged() {
        let count = |what: &str, scenarios| Count { what: what.to_owned(), scenarios };
        let mut summary = summary();
        assert!(campaign_html(&summary, "p.toml", "").contains("there is no table of confusion"));
        summary.methods[0].naming = Some(Naming {
            not_learned: vec![count("at_rest", 3), count("changes", 1)],
            kinds: vec![NamedKind {
                kind: "tacho".to_owned(),
                named: vec![count("tacho", 30), count("flux", 2)],
                right: Share::new(30, 32),
                in_set: Share::new(31, 32),
                covered: Share::new(28, 30),
                size_error: Some(0.0012),
            }],
        });
        let text = campaign_html(&summary, "p.toml", "");
        assert!(!text.contains("there is no table of confusion"));
        let page = Html::parse_document(&text);
        assert!(page.errors.is_empty(), "{:?}", page.errors);
        let cells = |selector: &str| -> Vec<String> {
            let cells = Selector::parse(&format!("#naming-bands {selector}")).unwrap();
            page.select(&cells).map(|cell| cell.text().collect()).collect()
        };
        assert_eq!(cells("table:first-of-type thead th")[..3], ["what fails", "flux", "tacho"]);
        assert_eq!(cells("tbody td")[..2], ["2", "30"]);
        assert!(cells("tbody td").iter().any(|cell| cell.starts_with("31/32, ")));
        let said = "4 scenarios not judged, no machine learned (at_rest 3, changes 1)";
        assert!(sentence(&summary.methods[0]).ends_with(said));
    }

    #[test]
    fn a_sentence_says_all() {
        let mut method = summary().methods.remove(0);
        assert_eq!(
            sentence(&method),
            "bands: 25 of 40 faults detected (47.0 to 75.8 %), 2 false alarms in 4.00 h of health, \
             one in 2.00 h"
        );
        method.detected = Share::new(0, 0);
        method.false_alarms = 0;
        let said = sentence(&method);
        assert_eq!(said, "bands: no fault to detect, no false alarm in 4.00 h of health");
    }
}
