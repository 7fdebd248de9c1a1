//! What an effect that the model lacked cost: the smallest faults that are detected without it and with
//! it.

use drivescope_scenarios::results::StudyResults;
use drivescope_scenarios::trials::{Detectable, HiddenEffect, ModelRows};

use crate::answer::block::{Align, Block, Column, HTML, Picture, Plot, Table};
use crate::report::plot::{Axis, Ink, Mark, Rows, Series, Value};
use crate::report::words::{number, percent};

/// The section; nothing where no effect was hidden.
pub(super) fn blocks(study: &StudyResults) -> Vec<Block> {
    let Some(hidden) = &study.hidden_effect else { return Vec::new() };
    let caption = format!(
        "Size from which on nine machines in ten are detected within 2 s, in steps between speeds, by \
         a bank whose model lacks {} and after it was added. Both at the same designed mean time \
         between false alarms on this machine: {} samples. Where it says so, at no size that was \
         tried.",
        mechanism(&hidden.effect),
        number(hidden.arl_0)
    );
    let about = format!(
        "False alarms counted on other healthy machines: {} before, {} after. Random load that the \
         bank had to assume: {} and {} N\u{a0}m. {} machines a point",
        alarms(&hidden.before),
        alarms(&hidden.after),
        number(hidden.before.torque_noise),
        number(hidden.after.torque_noise),
        hidden.machines
    );
    vec![
        Block::Figure(Picture { plot: Plot::Rows(chart(hidden)), caption }),
        Block::Table(table(hidden)),
        Block::In(HTML, vec![Block::Note(about)]),
    ]
}

fn alarms(rows: &ModelRows) -> String {
    if rows.learned == 0 {
        return "none, for nothing is judged (baselines do not fit that model)".to_owned();
    }
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

fn table(hidden: &HiddenEffect) -> Table {
    let size = |of: &Detectable| match of.size {
        // The smallest that was tried.
        Some(size) if of.curve.first().is_some_and(|(least, _)| size <= *least) => {
            format!("{} or less", percent(size, 2))
        }
        Some(size) => percent(size, 2),
        None => {
            let most = of.curve.last().map_or(f64::NAN, |(size, _)| *size);
            format!("not up to {}", percent(most, 0))
        }
    };
    let columns = vec![
        Column::new(Align::Name, "Mechanism"),
        Column::new(Align::Number, "before"),
        Column::new(Align::Number, "after"),
    ];
    let effect = mechanism(&hidden.effect);
    let caption = format!("Smallest detectable size, %, {effect} hidden and added");
    let mut table = Table::new(caption, columns);
    for (before, after) in pairs(hidden) {
        table.push(vec![
            mechanism(&before.mechanism).into(),
            size(before).into(),
            size(after).into(),
        ]);
    }
    table
}
