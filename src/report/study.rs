//! The report of a study: the verdict, then what it rests on.

use drivescope_scenarios::results::StudyResults;
use maud::html;

use super::page::page;
use crate::answer::block::Block;
use crate::answer::html::report;

/// What the figures are set beside.
const PAPER: &str = "K. Patan, M. Witczak, J. Korbicz, Towards robustness in neural network based \
                     fault diagnosis, Int. J. Appl. Math. Comput. Sci. 18 (2008), 443\u{2013}454";

/// One self-contained HTML page of what a study says: its findings beside the paper's.
pub(crate) fn study_html(study: &StudyResults, blocks: &[Block]) -> String {
    let title = format!("Fault study: {}", study.drive.name);
    let about = html! { "Detection of faults from signals, beside the figures of " (PAPER) "." };
    let made = html! {
        "drivescope study, seed " (study.seed) ", drive file " code { (study.drive.digest) }
        ". The same seed and drive file give the same figures. All numbers are in study.json."
    };
    page(&title, &about, &report(blocks), &made)
}

#[cfg(test)]
mod tests {
    use drivescope_scenarios::results::Pictures;
    use scraper::{Html, Selector};

    use super::*;
    use crate::answer::study::blocks;
    use crate::report::testing::{HOSTILE, pictures, study};

    /// What a report may weigh, bytes.
    const SIZE_LIMIT: usize = 1_000_000;

    fn written(study: &StudyResults, pictures: &[Pictures]) -> String {
        study_html(study, &blocks(study, pictures))
    }

    fn count(page: &Html, selector: &str) -> usize {
        page.select(&Selector::parse(selector).unwrap()).count()
    }

    #[test]
    fn a_browser_has_nothing_to_mend_and_nothing_to_load() {
        let text = written(&study(), &pictures());
        let page = Html::parse_document(&text);
        assert!(page.errors.is_empty(), "{:?}", page.errors);
        assert_eq!(count(&page, "script, img, link, iframe, object, form, base"), 0);
        assert_eq!(count(&page, "[src], [onclick], [onload]"), 0);
        for link in page.select(&Selector::parse("[href]").unwrap()) {
            let target = link.attr("href").unwrap();
            assert!(target.starts_with('#'), "{target}");
            let to = Selector::parse(&format!("[id='{}']", &target[1..])).unwrap();
            assert_eq!(page.select(&to).count(), 1, "one target for {target}");
        }
        assert!(!text.contains("url(") && !text.contains("@import"));
        // The only address is the one in the drive's name, which is text.
        let mut plain = study();
        plain.drive.name.clear();
        assert!(!written(&plain, &pictures()).contains("://"));
    }

    #[test]
    fn names_are_text() {
        let page = Html::parse_document(&written(&study(), &pictures()));
        let heading = page.select(&Selector::parse("h1").unwrap()).next().unwrap();
        assert_eq!(heading.text().collect::<String>(), format!("Fault study: {HOSTILE}"));
    }

    #[test]
    fn every_fault_has_its_row_its_picture_and_its_data() {
        let (study, pictures) = (study(), pictures());
        let page = Html::parse_document(&written(&study, &pictures));
        assert_eq!(count(&page, "#detection > div.scroll:first-of-type tbody tr"), 12);
        assert_eq!(count(&page, "#runs figure"), 13);
        assert_eq!(count(&page, "#figures figure"), 2);
        assert_eq!(count(&page, "#isolation figure"), 1);
        // Choices of classes; then Table 2 with ours, the paper's, our test's classes, and every fault
        // alone.
        assert_eq!(count(&page, "#isolation tbody tr"), 3 + 4 * 12);
        assert_eq!(count(&page, "#levels tbody tr"), 2 * 4);
        assert_eq!(count(&page, "#identification tbody tr"), 12);
        assert_eq!(count(&page, "#runs details table"), 13);
        // Every picture says what it is, and every id is one of a kind.
        let plots = count(&page, "svg.plot");
        assert_eq!(count(&page, "svg.plot > title"), plots);
        assert_eq!(count(&page, "svg.plot > desc"), plots);
        let all = Selector::parse("[id]").unwrap();
        let mut ids: Vec<_> = page.select(&all).map(|e| e.attr("id").unwrap()).collect();
        ids.sort_unstable();
        let before = ids.len();
        ids.dedup();
        assert_eq!(ids.len(), before);
    }

    #[test]
    fn the_report_is_small() {
        let size = written(&study(), &pictures()).len();
        assert!(size < SIZE_LIMIT, "{size} bytes");
    }

    /// `tools/compare_fmpy` puts its rows in the place of what stands between the comments.
    #[test]
    fn runs_in_fmpy_have_their_place() {
        let text = written(&study(), &[]);
        let (_, rest) = text.split_once("<!-- fmpy -->").expect("a begin");
        let (note, _) = rest.split_once("<!-- /fmpy -->").expect("an end");
        assert!(note.contains("Not run in fmpy"), "{note}");
    }

    #[test]
    fn a_study_that_found_nothing_is_still_a_report() {
        let mut study = study();
        study.detection.clear();
        study.readings.clear();
        study.identification.clear();
        study.paper.detection.clear();
        study.model.residual_sd = 0.0;
        let text = written(&study, &[]);
        let page = Html::parse_document(&text);
        assert!(page.errors.is_empty(), "{:?}", page.errors);
        assert!(text.contains("0 of 0 faults detected") && !text.contains("NaN"));
    }

    #[test]
    fn numbers_that_are_none_do_not_reach_the_plots() {
        let mut pictures = pictures();
        pictures[0].lower.fill(f64::NAN);
        pictures[0].upper.fill(f64::INFINITY);
        pictures[1].residual.truncate(10);
        for picture in &mut pictures[2..4] {
            picture.t.clear();
        }
        let text = written(&study(), &pictures);
        assert!(text.contains("The run ends before the fault begins"));
        for plot in text.split("<svg").skip(1).filter_map(|rest| rest.split("</svg>").next()) {
            assert!(!plot.contains("NaN") && !plot.contains("inf"), "{plot}");
        }
    }
}
