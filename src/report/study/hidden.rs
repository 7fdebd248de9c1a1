//! What an effect that the model lacked cost: the smallest faults that are detected without it and with
//! it.

use drivescope_scenarios::results::StudyResults;
use drivescope_scenarios::trials::{Detectable, HiddenEffect, ModelRows};
use maud::{Markup, html};

use crate::report::page::{self, figure, table};
use crate::report::plot::{Axis, Ink, Mark, Rows, Series, Value};
use crate::report::words::{number, percent};

/// The section; nothing where no effect was hidden.
pub(super) fn section(study: &StudyResults) -> Markup {
    let Some(hidden) = &study.hidden_effect else { return html! {} };
    let heading = "What a hidden effect costs";
    let about = html! {
        "Size from which on nine machines in ten are detected within 2 s, in steps between speeds, by a "
        "bank whose model lacks " (mechanism(&hidden.effect)) " and after it was added. Both at the "
        "same designed mean time between false alarms on this machine: "
        (number(hidden.arl_0)) " samples. Where it says so, at no size that was tried."
    };
    page::section(
        "hidden-effect",
        heading,
        &html! {
            (figure("hidden-sizes", chart(hidden).svg(), heading, &about))
            (data(hidden))
            p.note {
                "False alarms counted on other healthy machines: " (alarms(&hidden.before)) " before, "
                (alarms(&hidden.after)) " after. Random load that the bank had to assume: "
                (number(hidden.before.torque_noise)) " and " (number(hidden.after.torque_noise))
                " N\u{a0}m. " (hidden.machines) " machines a point."
            }
        },
    )
}

fn alarms(rows: &ModelRows) -> String {
    let at_least = number(rows.arl_0_at_least);
    format!("{} in {} samples (95 %: at least {at_least} between them)", rows.alarms, rows.samples)
}

/// An identifier as words.
fn mechanism(id: &str) -> String {
    id.replace('_', " ")
}

/// Both models of each mechanism.
fn pairs(hidden: &HiddenEffect) -> impl Iterator<Item = (&Detectable, &Detectable)> {
    hidden.before.mechanisms.iter().zip(&hidden.after.mechanisms)
}

fn chart(hidden: &HiddenEffect) -> Rows {
    let series =
        |label: &str, mark, lane| Series { label: label.into(), ink: Ink::Blue, mark, lane };
    let value = |of: &Detectable| match of.size {
        Some(size) => Value::Number(100.0 * size),
        None => Value::Missing("not detected".to_owned()),
    };
    let rows = pairs(hidden)
        .map(|(before, after)| (mechanism(&before.mechanism), vec![value(before), value(after)]));
    Rows {
        id: "hidden-sizes-plot".into(),
        title: "Smallest detectable faults before and after the effect was added".into(),
        description:
            "One row a mechanism: without the effect in the model and with it, as bars. The \
                      numbers are in the table below."
                .into(),
        axis: Axis::new("smallest detectable size", "%"),
        reference: None,
        series: vec![series("before", Mark::HollowBar, 0), series("after", Mark::Bar, 1)],
        rows: rows.collect(),
    }
}

fn data(hidden: &HiddenEffect) -> Markup {
    let size = |of: &Detectable| match of.size {
        Some(size) => percent(size, 2),
        None => {
            let most = of.curve.last().map_or(f64::NAN, |(size, _)| *size);
            format!("not up to {}", percent(most, 0))
        }
    };
    let head = html! {
        tr {
            th.name scope="col" { "Mechanism" }
            th scope="col" { "before [%]" }
            th scope="col" { "after [%]" }
        }
    };
    let body = html! {
        @for (before, after) in pairs(hidden) {
            tr {
                th scope="row" { (mechanism(&before.mechanism)) }
                td { (size(before)) }
                td { (size(after)) }
            }
        }
    };
    table("Smallest detectable faults before and after the effect was added", &head, &body)
}

#[cfg(test)]
mod tests {
    use scraper::Html;

    use super::*;
    use crate::report::study::study_html;
    use crate::report::testing::study;

    #[test]
    fn sizes_before_and_after_stand_side_by_side() {
        let detectable = |size| Detectable {
            mechanism: "load".to_owned(),
            size,
            curve: vec![(0.1, 0.2), (0.6, 0.8)],
        };
        let rows = |size| ModelRows {
            torque_noise: 0.004,
            alarms: 2,
            samples: 300_000,
            arl_0_at_least: 5e4,
            learned: 15,
            mechanisms: vec![detectable(size)],
        };
        let mut study = study();
        assert!(!study_html(&study, &[]).contains("hidden-effect"));
        study.hidden_effect = Some(HiddenEffect {
            effect: "quadratic_drag".to_owned(),
            arl_0: 1e5,
            machines: 200,
            before: rows(None),
            after: rows(Some(0.0421)),
        });
        let text = study_html(&study, &[]);
        assert!(text.contains("not up to 60") && text.contains("4.21"), "{text}");
        assert!(Html::parse_document(&text).errors.is_empty());
    }
}
