//! The faults view: the answer of a study, as its report tells it.

use maud::html;

use super::study::Shown;
use crate::answer;
use crate::answer::html::page;

/// The whole view.
pub(super) fn view(shown: &Shown) -> String {
    html! {
        section #study aria-labelledby="study-h" {
            h2 #study-h { "Faults" span.about { " twelve faults, every detector" } }
            @if let Some(problem) = &shown.problem { p.problem role="alert" { (problem) } }
            @match &shown.running {
                Some(running) => p {
                    "A study is running: " (running.doing)
                    @if running.of > 0 { ", " (running.done) " of " (running.of) " runs" } ". "
                    @if running.of > 0 {
                        progress max=(running.of) value=(running.done) aria-label="runs judged" {}
                    }
                    button type="button" data-study="cancel" { "Cancel" }
                },
                None => p {
                    button type="button" data-study="start" { "Run the study" }
                    label.file for="study-file" { " or open a " code { "study.json" } " "
                        input #study-file type="file" accept=".json"; }
                },
            }
            @if shown.results.is_none() && shown.running.is_none() {
                p.note { "The study puts twelve faults into the drive, watches them with every \
                    detector, isolates and sizes them: the experiment of the reference paper." }
            }
        }
        // Not while a new one runs: its progress draws this view again and again.
        @if let (Some(study), None) = (&shown.results, &shown.running) {
            (page(&answer::study::blocks(&study.0, &study.1), &|_| None))
        }
    }
    .into_string()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use scraper::{Html, Selector};

    use super::*;
    use crate::page::study::Running;
    use crate::report::testing::{pictures, study};

    fn count(page: &Html, selector: &str) -> usize {
        page.select(&Selector::parse(selector).expect("a selector")).count()
    }

    fn shown(shown: &Shown) -> Html {
        let page = Html::parse_fragment(&view(shown));
        assert!(page.errors.is_empty(), "{:?}", page.errors);
        page
    }

    #[test]
    fn a_study_is_told_as_its_report_tells_it() {
        let results = Some(Arc::new((study(), pictures())));
        let page = shown(&Shown { results, ..Shown::default() });
        assert_eq!(count(&page, "#detection > div.scroll:first-of-type tbody tr"), 12);
        assert_eq!(count(&page, "#runs figure"), 13);
        assert_eq!(count(&page, "#isolation figure"), 1);
        // From a fault to its run.
        for link in page.select(&Selector::parse("#detection tbody a").expect("a selector")) {
            let target = link.attr("href").expect("a link leads somewhere");
            assert_eq!(count(&page, &format!("[id='{}']", &target[1..])), 1, "{target}");
        }
        assert!(count(&page, "#detection tbody a") >= 12);
    }

    #[test]
    fn nothing_is_shown_where_nothing_is_and_while_another_runs() {
        let page = shown(&Shown::default());
        assert_eq!((count(&page, "table"), count(&page, "[data-study=start]")), (0, 1));
        let results = Some(Arc::new((study(), Vec::new())));
        let running = Some(Running::begin());
        let page = shown(&Shown { results, running, ..Shown::default() });
        assert_eq!((count(&page, "table"), count(&page, "[data-study=cancel]")), (0, 1));
    }
}
