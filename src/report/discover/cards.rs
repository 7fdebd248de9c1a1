//! Cards of missing effects: name, law, the curve that convicts, what speaks for it and against.

use drivescope_discovery::compare::Curve;
use drivescope_discovery::{Formula, LearnedCurve, Ranked, Verdict};
use drivescope_plant::effects::custom::Target;
use drivescope_plant::effects::info::Variable;
use drivescope_plant::effects::registry::Entry;
use maud::{Markup, PreEscaped, html};

use super::Missing;
use crate::formula_text::{self, PREFIX};
use crate::report::compare::pictures;
use crate::report::page::minus;
use crate::report::plot::{Axis, Dash, Figure, Ink, Layer, Panel};
use crate::report::words::{number, percent, probability};

/// Formulas that are shown.
const FORMULAS: usize = 3;
/// Width and height of a card's picture, pixels.
const WIDTH: f64 = 400.0;
const HEIGHT: f64 = 120.0;

/// The cards, best first, then the honest ones; `action` is what may be done about an effect.
pub(crate) fn cards(
    missing: &Missing,
    curves: &[Curve],
    action: &dyn Fn(&str) -> Markup,
) -> Markup {
    html! {
        p.verdict { (words(missing)) }
        div.cards {
            @if missing.verdict == Verdict::None { (nothing()) }
            @if let Some(learned) = &missing.learned { (unknown(learned, &missing.formulas, action)) }
            @else if missing.verdict == Verdict::Unknown { (without_curve(&missing.formulas)) }
            @else if let Some(named) = &missing.closer_than { (closer(named, &missing.formulas)) }
            @for (place, one) in missing.ranking.iter().enumerate() {
                (card(missing, one, place, curves, action))
            }
        }
        @for (effects, reason) in &missing.not_shown {
            p.note { "Not judged: " (effects) ": " (reason) "." }
        }
    }
}

/// The answer in a sentence.
fn words(missing: &Missing) -> String {
    let named: Vec<String> = missing.named.iter().map(|it| name(it)).collect();
    match missing.verdict {
        Verdict::Named => format!("Missing: {}.", named.join(", ")),
        Verdict::None => "Nothing is missing that these recordings could show.".to_owned(),
        Verdict::Unknown => "Something is missing, and no effect of the library is it.".to_owned(),
        Verdict::NotJudged => {
            "Not judged: the signals of the recordings do not allow it.".to_owned()
        }
    }
}

/// An identifier for people.
fn name(effect: &str) -> String {
    effect.replace('_', " ")
}

fn nothing() -> Markup {
    html! {
        article.card.honest aria-label="nothing is missing" {
            h3 { "Nothing" }
            p {
                "No effect of the library lowers the error by more than chance would. If something \
                 is missing, these recordings do not excite it."
            }
        }
    }
}

fn without_curve(formulas: &[Formula]) -> Markup {
    html! {
        article.card.honest aria-label="something unknown" {
            h3 { "Unknown" }
            p { "No curve over a single variable describes what is missing." }
            (proposals(formulas))
        }
    }
}

/// Formulas in the place of what was named.
fn closer(named: &str, formulas: &[Formula]) -> Markup {
    html! {
        article.card.honest aria-label={ "formulas in the place of " (name(named)) } {
            h3 { "Closer than " (name(named)) }
            p {
                "What is missing is of its kind, and another formula in its place describes these \
                 recordings closer."
            }
            (proposals(formulas))
        }
    }
}

fn unknown(
    learned: &LearnedCurve,
    formulas: &[Formula],
    action: &dyn Fn(&str) -> Markup,
) -> Markup {
    let balance = format!("{:?}", learned.balance).to_lowercase();
    let times = learned.times.map_or(String::new(), |times| format!(", times {times}"));
    html! {
        article.card.honest aria-label="something unknown, as a curve" {
            h3 { "Unknown" }
            p {
                "A curve over " (learned.over) (times) " in the " (balance)
                @if learned.addable {
                    " removes " (percent(learned.excess_removed, 0)) " % of the error above the noise."
                } @else {
                    " shows it; no effect of the drive file can hold that curve."
                }
            }
            (PreEscaped(learned_figure(learned, &balance).svg_of(WIDTH)))
            (numbers("Data of this curve", (learned.over, "adds"), learned.knots.iter().zip(&learned.values)))
            (proposals(formulas))
            @if learned.addable { (action("learned")) }
        }
    }
}

/// Formulas for what nobody knows, and how one is added.
fn proposals(formulas: &[Formula]) -> Markup {
    html! {
        @for it in formulas.iter().take(FORMULAS) {
            @let target = if it.law.parts().0 == Target::Voltage { "voltage" } else { "torque" };
            p {
                "Perhaps "
                code data-law=(it.with_values()) data-target=(target) { (formula_text::law(it)) }
                ": probability " (probability(it.probability)) " among those tried, evidence "
                (minus(&number(it.evidence))) ", " (it.complexity) " names and numbers"
            }
        }
        @if let Some(best) = formulas.first() {
            p.note {
                "To add one: " code {
                    "drivescope add DRIVE \"" (PREFIX) (formula_text::text(best)) "\" REC... -o FILE"
                }
            }
        }
    }
}

fn learned_figure(learned: &LearnedCurve, balance: &str) -> Figure {
    let points = learned.knots.iter().zip(&learned.values).map(|(x, y)| (*x, *y)).collect();
    Figure {
        id: "learned-plot".to_owned(),
        title: format!("What is missing over {}", learned.over),
        description: format!("A learned curve in the {balance} over {}", learned.over),
        x: Axis::new(learned.over, learned.over_unit.as_str()),
        spans: Vec::new(),
        markers: Vec::new(),
        panels: vec![Panel {
            height: HEIGHT,
            y: Axis::new(format!("missing {balance}"), learned.unit.as_str()),
            layers: vec![
                zero(),
                Layer::Line { label: String::new(), points, ink: Ink::Blue, dash: Dash::Solid },
            ],
            strip: None,
        }],
    }
}

fn zero() -> Layer {
    Layer::Level { label: String::new(), y: 0.0, ink: Ink::Text, dash: Dash::Dashed }
}

fn card(
    missing: &Missing,
    one: &Ranked,
    place: usize,
    curves: &[Curve],
    action: &dyn Fn(&str) -> Markup,
) -> Markup {
    let info = Entry::find(&one.effect).map(|entry| entry.info);
    let typed = missing.typed.iter().find(|law| law.id == one.effect);
    let of_library = info.map(|info| info.fails_over);
    let fails_over = of_library.or(typed.map(|law| law.fails_over.as_slice()));
    let evidence = fails_over.and_then(|variables| convicting(variables, curves));
    html! {
        article.card data-effect=(one.effect) data-refused[one.refused.is_some()]
            aria-label=(name(&one.effect)) {
            h3 { span.rank { (place + 1) } " " (name(&one.effect)) }
            @match &one.refused {
                None => p.mark.good { "named" },
                Some(why) => p.mark { "not named: " (why) },
            }
            @if let Some(info) = info {
                p { code { (info.law) } }
                p.note { "Without it: " (info.fingerprint) }
            } @else if let Some(law) = typed {
                p { code { (law.text) } }
                p.note { "A law of your own." }
            }
            @if let Some((at, curve)) = evidence {
                (PreEscaped(pictures::curve_at(curve, &format!("card-{place}-{at}"), HEIGHT).svg_of(WIDTH)))
                p.note { (pictures::caption(curve)) }
            }
            dl.facts {
                div { dt { "Probability" } dd { (probability(one.probability)) ", evidence " (minus(&number(0.5 * one.delta_bic))) } }
                div { dt { "Size" } dd { (percent(one.size, 1)) " % of what the balance holds" } }
                @if one.excess_removed > 0.0 {
                    div { dt { "Share of the error" } dd { (percent(one.excess_removed, 1)) " % of what is above the noise" } }
                }
                @for (parameter, value) in &one.parameters {
                    div {
                        dt { code { (parameter) } }
                        dd {
                            (minus(&number(value.value)))
                            @if value.std_error.is_finite() { " \u{b1} " (minus(&number(value.std_error))) }
                            @if value.unit != "1" { " " (value.unit) }
                        }
                    }
                }
                @if !one.confusion_set.is_empty() {
                    div {
                        dt { "Could also be" }
                        dd { (one.confusion_set.iter().map(|it| name(it)).collect::<Vec<_>>().join(", ")) }
                    }
                }
                @if let Some(next) = missing.next.as_ref().filter(|it| it.separates.contains(&one.effect)) {
                    div { dt { "To tell them apart" } dd { "record " (next.description) } }
                }
            }
            (action(&one.effect))
        }
    }
}

/// The curve that shows an effect best: over the variable over which a model without it fails
/// most tellingly, of those that were drawn.
fn convicting<'a>(variables: &[Variable], curves: &'a [Curve]) -> Option<(usize, &'a Curve)> {
    // The curve over the speed shows both directions.
    let drawn =
        |variable: &str| if variable == "omega_sign" { "omega" } else { variable }.to_owned();
    variables.iter().find_map(|variable| {
        let wanted = drawn(variable.name());
        curves.iter().enumerate().find(|(_, curve)| curve.variable == wanted)
    })
}

/// Numbers behind a picture.
fn numbers<'a>(
    title: &str,
    (x, y): (&str, &str),
    pairs: impl Iterator<Item = (&'a f64, &'a f64)>,
) -> Markup {
    html! {
        details {
            summary { (title) }
            div.scroll role="region" tabindex="0" aria-label=(title) {
                table {
                    thead { tr { th scope="col" { (x) } th scope="col" { (y) } } }
                    tbody {
                        @for (x, y) in pairs {
                            tr { td { (minus(&number(*x))) } td { (minus(&number(*y))) } }
                        }
                    }
                }
            }
        }
    }
}
