//! Isolation (26): symptoms of every fault (Fig. 5), what can be told apart, and Table 2.

use drivescope_scenarios::results::{IsolationTable, Merge, Pair, StudyResults};
use maud::{Markup, html};

use crate::report::page::{self, figure, label, math, minus, table};
use crate::report::plot::{Axis, Figure, Ink, Layer, Panel};
use crate::report::words::{count, percent};

const HEIGHT: f64 = 380.0;
const INKS: [Ink; 6] = [Ink::Blue, Ink::Orange, Ink::Green, Ink::Vermilion, Ink::Purple, Ink::Text];

/// The section.
pub(super) fn section(study: &StudyResults) -> Markup {
    page::section(
        "isolation",
        "Isolation: symptoms (Fig. 5) and classes (Table 2 of the paper)",
        &html! {
            @if study.symptoms.is_empty() {
                p.note { "No symptoms were gathered." }
            } @else {
                (figure("figure-5", scatter(study).svg(), "Figure 5, from our runs", &html! {
                    "Fig. 5: 100 symptoms of every fault, control signal and residual while it stands "
                    "declared. With integral action the loop holds T at its set point whatever fails, so "
                    (math("C_m")) " and " (math("r = T \u{2212} y_m(C_m)"))
                    " move along one curve: a symptom is essentially one number, and faults that need the "
                    "same " (math("C_m")) " look alike. The paper finds that f\u{2081}\u{b9}, "
                    "f\u{2086}\u{b2} and f\u{2082}\u{b9}, f\u{2085}\u{b2} overlap."
                }))
            }
            (separability(study))
            (limits(study))
            (matrix("Table 2. Recognition with the paper's classes, ours [%]", &study.isolation_paper, None))
            (matrix(
                "Table 2 of the paper [%]", &study.isolation_paper, Some(&study.paper.isolation),
            ))
            @if study.separability.classes != study.separability.classes_paper {
                (matrix("Recognition with the classes of our test [%]", &study.isolation_merged, None))
            }
            (matrix("Recognition with every fault a class of its own [%]", &study.isolation, None))
            p.note {
                "Perceptron 2-15-10 and code bits, trained on 100 samples a fault of runs of their own, "
                "judged on every sample of the study's faulty runs from the earliest declaration on. "
                "\u{201c}Unknown\u{201d}: the symptom lies where none of the answered class was seen."
            }
        },
    )
}

fn scatter(study: &StudyResults) -> Figure {
    let clouds = study.symptoms.iter().enumerate().map(|(place, of)| Layer::Cloud {
        name: label(&of.fault.label),
        points: of.points.iter().map(|[u, r]| (*u, *r)).collect(),
        ink: INKS[place % INKS.len()],
        below: of.fault.kind != "tacho",
    });
    let unit = &study.drive.tacho_unit;
    Figure {
        id: "figure-5-plot".into(),
        title: "Distribution of the symptoms of every fault".into(),
        description: "Residual over control signal, a cloud of points a fault, with the paper's \
                      label: f with raised 1 are tachometer faults, with raised 2 torque faults."
            .into(),
        x: Axis::new("control signal C_m", "V"),
        spans: Vec::new(),
        markers: Vec::new(),
        panels: vec![Panel {
            height: HEIGHT,
            y: Axis::new("residual r", unit),
            layers: clouds.collect(),
            strip: None,
        }],
    }
}

fn separability(study: &StudyResults) -> Markup {
    let found = &study.separability;
    let merged = |classes: &[Vec<String>]| -> String {
        let several = classes.iter().filter(|class| class.len() > 1);
        let named: Vec<String> = several.map(|class| format!("{{{}}}", class.join(", "))).collect();
        if named.is_empty() { "none".into() } else { minus(&named.join(", ")) }
    };
    let pairs = |pairs: &[Pair]| -> String {
        let named: Vec<String> = pairs.iter().map(|[a, b]| format!("{a} with {b}")).collect();
        if named.is_empty() { "none".into() } else { minus(&named.join(", ")) }
    };
    let limit = percent(found.limit, 0);
    let often = |merge: &Merge| {
        let [a, b] = &merge.faults;
        format!("{a} with {b}: {} of {}", merge.draws, found.draws)
    };
    let often: Vec<String> = found.merges.iter().map(often).collect();
    let often = if often.is_empty() { "none".to_owned() } else { minus(&often.join(", ")) };
    html! {
        dl.facts {
            div { dt { "Merged by our test" } dd { (merged(&found.classes)) } }
            div { dt { "Merged in draws of the noise" } dd { (often) } }
            div { dt { "Merged in the paper" } dd { (merged(&found.classes_paper)) } }
            div { dt { "Merged only here" } dd { (pairs(&found.merged_only_here)) } }
            div { dt { "Merged only in the paper" } dd { (pairs(&found.merged_only_in_paper)) } }
        }
        p.note {
            "Our test: two faults share a class if a quadratic discriminant between the two, "
            "cross-validated, takes more than " (limit) " % of the samples of either for the other, on "
            "average over " (count(found.draws, "draw")) " of the noise with 100 samples a fault each."
        }
    }
}

/// Whether the classifier or the symptoms set the limit.
fn limits(study: &StudyResults) -> Markup {
    let worst = |shares: &[f64]| percent(shares.iter().copied().fold(1.0, f64::min), 1);
    let right = |table: &IsolationTable| -> Vec<f64> {
        (0..table.faults.len()).map(|fault| table.right(fault)).collect()
    };
    let line = |table: &IsolationTable| {
        format!(
            "{} classes: perceptron {} %, discriminant {} %",
            table.classes.len(),
            worst(&right(table)),
            worst(&table.discriminant)
        )
    };
    html! {
        p.note {
            "What limits the recognition: a cubic in " (math("C_m")) " alone explains "
            (percent(study.separability.explained, 1)) " % of the variance of r over all symptoms: a "
            "symptom is essentially one number. A quadratic discriminant, a classifier of "
            "another kind, answers to the same symptoms; share of right answers for the worst fault: "
            (line(&study.isolation_paper)) "; " (line(&study.isolation)) ". Where the two agree, the "
            "symptoms set the limit and not the classifier; two faults with the same symptoms share "
            "their answers by chance."
        }
    }
}

/// A table of shares; `paper` puts the paper's in the place of ours.
fn matrix(caption: &str, isolation: &IsolationTable, paper: Option<&Vec<Vec<f64>>>) -> Markup {
    let numbered = |class: usize| format!("C_{}", class + 1);
    let head = html! {
        tr {
            th.name scope="col" { "Fault" }
            @for (class, name) in isolation.classes.iter().enumerate() {
                th scope="col" title=(minus(name)) { (math(&numbered(class))) }
            }
            @if paper.is_none() { th scope="col" { "unknown" } }
        }
    };
    let share = |value: f64| if value < 5e-4 { "\u{2013}".into() } else { percent(value, 1) };
    let body = html! {
        @for (fault, name) in isolation.faults.iter().enumerate() {
            @let row = paper.unwrap_or(&isolation.matrix).get(fault);
            tr {
                th scope="row" { (minus(name)) }
                @if let Some(row) = row {
                    @for (class, value) in row.iter().enumerate() {
                        td {
                            @if isolation.class_of.get(fault) == Some(&class) {
                                strong { (share(*value)) }
                            } @else {
                                (share(*value))
                            }
                        }
                    }
                }
            }
        }
    };
    table(caption, &head, &body)
}
