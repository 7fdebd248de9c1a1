//! Cards of missing effects: name, law, the curve that convicts, what speaks for it and against.

use drivescope_discovery::compare::Curve;
use drivescope_discovery::{Formula, LearnedCurve, Ranked, Verdict};
use drivescope_plant::effects::info::Variable;
use drivescope_plant::effects::registry::Entry;

use super::missing::Missing;
use crate::answer::block::{
    ALL, Align, Block, Card, Column, Fact, HTML, Item, Key, Picture, Plot, Table,
};
use crate::answer::compare::pictures;
use crate::formula_text::{self, PREFIX};
use crate::report::plot::{Axis, Dash, Figure, Ink, Layer, Panel};
use crate::report::words::{estimated, number, percent, probability, significant};

/// Formulas that are shown.
const FORMULAS: usize = 3;
/// Share of the error above the noise that a curve must remove to be drawn: it is told in whole per cent.
const FALLS: f64 = 0.005;
/// Height of a card's picture, pixels.
const HEIGHT: f64 = 120.0;

/// The cards: the honest ones, then what was ranked, what may be named before what was refused,
/// however much that explains.
pub(super) fn cards(missing: &Missing, curves: &[Curve]) -> Vec<Card> {
    let mut ranking: Vec<&Ranked> = missing.ranking.iter().collect();
    ranking.sort_by_key(|one| one.refused.is_some());
    let ranked = ranking.into_iter().enumerate();
    let nothing = (missing.verdict == Verdict::None).then(nothing);
    let honest = match (&missing.learned, &missing.closer_than) {
        (Some(learned), _) => Some(unknown(learned, &missing.formulas)),
        (None, _) if missing.verdict == Verdict::Unknown => Some(without_curve(&missing.formulas)),
        (None, named) => named.as_ref().map(|named| closer(named, &missing.formulas)),
    };
    let ranked = ranked.map(|(place, one)| card(missing, one, place, curves));
    nothing.into_iter().chain(honest).chain(ranked).collect()
}

fn honest(title: impl Into<String>, blocks: Vec<Block>) -> Card {
    let title = title.into();
    Card { key: None, rank: None, title, mark: None, blocks, facts: Vec::new() }
}

fn nothing() -> Card {
    let words = "No effect of the library lowers the error by more than chance would. If something \
                 is missing, these recordings do not excite it";
    honest("Nothing", vec![Block::In(HTML, vec![Block::Sentence(words.to_owned())])])
}

fn without_curve(formulas: &[Formula]) -> Card {
    let words = "no curve over a single variable describes what is missing".to_owned();
    honest("Unknown", [Block::Sentence(words)].into_iter().chain(proposals(formulas)).collect())
}

/// Formulas in the place of what was named.
fn closer(named: &str, formulas: &[Formula]) -> Card {
    let words = format!(
        "what is missing is of the kind of {named}, and formulas in its place describe these \
         recordings closer"
    );
    let blocks = [Block::Sentence(words)].into_iter().chain(proposals(formulas));
    honest(format!("Closer than {named}"), blocks.collect())
}

fn unknown(learned: &LearnedCurve, formulas: &[Formula]) -> Card {
    let LearnedCurve { over, over_unit, unit, excess_removed, .. } = learned;
    let balance = format!("{:?}", learned.balance).to_lowercase();
    let times = learned.times.map_or(String::new(), |times| format!(", times {times}"));
    if *excess_removed < FALLS {
        let words = format!(
            "a curve over {over}{times} in the {balance} has most evidence, and with it the error does \
             not fall: what is missing is no function of {over} alone"
        );
        let blocks = [Block::Sentence(words)].into_iter().chain(proposals(formulas));
        return honest("Unknown", blocks.collect());
    }
    let does = format!("removes {} % of the error above the noise", percent(*excess_removed, 0));
    let of = |name: &str, unit: &str| match unit {
        "" => name.to_owned(),
        unit => format!("{name} [{unit}]"),
    };
    let columns = [of(over, over_unit), of("adds", unit)];
    let columns = columns.map(|heading| Column::new(Align::Number, heading));
    let mut data = Table::new("Data of this curve", columns.into());
    for (knot, value) in learned.knots.iter().zip(&learned.values) {
        data.push(vec![significant(*knot, 5).into(), significant(*value, 5).into()]);
    }
    let picture = Picture { plot: Plot::Figure(figure(learned, &balance)), caption: String::new() };
    let mut blocks = vec![
        Block::Sentence(format!("a curve over {over}{times} in the {balance} {does}")),
        Block::Panels(vec![(picture, Vec::new())]),
        Block::Details { summary: data.caption.clone(), blocks: vec![Block::Table(data)] },
    ];
    blocks.extend(proposals(formulas));
    Card { key: Some(Key::Effect("learned".to_owned())), ..honest("Unknown", blocks) }
}

/// Formulas for what nobody knows, and how one is added.
fn proposals(formulas: &[Formula]) -> Vec<Block> {
    let Some(best) = formulas.first() else { return Vec::new() };
    let item = |it: &Formula| {
        let values: Vec<String> = it
            .parameters
            .iter()
            .map(|(name, value)| format!("{name} = {}", significant(*value, 4)))
            .collect();
        Item {
            key: Some(Key::Law {
                target: formula_text::target(it),
                text: it.with_values(),
                head: formula_text::law(it),
            }),
            code: true,
            head: formula_text::law(it),
            note: format!(
                "probability {} among those tried, evidence {}, {} names and numbers, {}",
                probability(it.probability),
                number(it.evidence),
                it.complexity,
                values.join(", ")
            ),
        }
    };
    vec![
        Block::Sentence("formulas for it, the most probable first:".to_owned()),
        Block::List(formulas.iter().take(FORMULAS).map(item).collect()),
        Block::Command {
            words: "to add one".to_owned(),
            command: format!(
                "drivescope add DRIVE \"{PREFIX}{}\" REC... -o FILE",
                formula_text::text(best)
            ),
        },
    ]
}

fn figure(learned: &LearnedCurve, balance: &str) -> Figure {
    let points = learned.knots.iter().zip(&learned.values).map(|(x, y)| (*x, *y)).collect();
    let (label, y) = (String::new(), 0.0);
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
                Layer::Level { label: label.clone(), y, ink: Ink::Text, dash: Dash::Dashed },
                Layer::Line { label, points, ink: Ink::Blue, dash: Dash::Solid },
            ],
            strip: None,
        }],
    }
}

fn card(missing: &Missing, one: &Ranked, place: usize, curves: &[Curve]) -> Card {
    let info = Entry::find(&one.effect).map(|entry| entry.info);
    let typed = missing.typed.iter().find(|law| law.id == one.effect);
    let law = |law: &str| Block::Command { words: "law".to_owned(), command: law.to_owned() };
    let mut about = match (info, typed) {
        (Some(info), _) => {
            vec![law(info.law), Block::Note(format!("without it: {}", info.fingerprint))]
        }
        (None, Some(own)) => vec![law(&own.text), Block::Note("a law of your own".to_owned())],
        (None, None) => Vec::new(),
    };
    let of_library = info.map(|info| info.fails_over);
    let fails_over = of_library.or(typed.map(|law| law.fails_over.as_slice()));
    if let Some((at, curve)) = fails_over.and_then(|variables| convicting(variables, curves)) {
        let figure = pictures::curve(curve, &format!("card-{place}-{at}"));
        let caption = pictures::caption(curve);
        about.push(Block::Panels(vec![(
            Picture { plot: Plot::Figure(figure), caption },
            Vec::new(),
        )]));
    }
    let mark = match &one.refused {
        None => Ok("named".to_owned()),
        Some(why) => Err(format!("not named: {why}")),
    };
    Card {
        key: Some(Key::Effect(one.effect.clone())),
        rank: Some(place + 1),
        title: one.effect.clone(),
        mark: Some(mark),
        blocks: vec![Block::In(HTML, about)],
        facts: facts(one),
    }
}

/// What speaks for an effect.
fn facts(one: &Ranked) -> Vec<Fact> {
    let removed = match one.excess_removed {
        // It was not fitted in free run.
        0.0 => "-".to_owned(),
        share => format!("{} %", percent(share, 1)),
    };
    let of_balance = match one.size {
        size if !size.is_finite() => "-".to_owned(),
        // Its own size over that of the balance: of more than all of it no reader learns anything.
        size if size > 1.0 => "> 100 %".to_owned(),
        size => format!("{} %", percent(size, 1)),
    };
    let mut facts = vec![
        Fact::new(ALL, "Probability", probability(one.probability)),
        Fact::new(HTML, "Evidence", format!("{} nats", number(0.5 * one.delta_bic))),
        Fact::new(ALL, "Share of the balance", of_balance),
        Fact::new(ALL, "Share of the error above the noise", removed),
    ];
    facts.extend(one.parameters.iter().map(|(name, it)| {
        Fact::new(HTML, name, estimated(&number(it.value), it.std_error, &it.unit))
    }));
    if !one.confusion_set.is_empty() {
        facts.push(Fact::new(HTML, "Could also be", one.confusion_set.join(", ")));
    }
    facts
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
