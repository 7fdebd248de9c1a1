//! Parameters with their standard errors, and those that the recordings do not tell.

use drivescope_discovery::{Estimate, NotIdentifiable};

use super::block::{Align, Block, Cell, Column, Key, Table};
use crate::report::words::significant;

/// Digits of a value: more than its standard error leaves, so that it can be typed again.
const DIGITS: i32 = 6;

/// The table of parameters, each with what is to be remarked.
pub(crate) fn parameters<'a>(all: impl Iterator<Item = (&'a Estimate, String)>) -> Block {
    let column = Column::new;
    let columns = vec![
        column(Align::Symbol, "Parameter"),
        column(Align::Number, "Value"),
        column(Align::Number, "Standard error"),
        column(Align::Name, "Unit"),
        column(Align::Number, "Before"),
        column(Align::Name, "Remark"),
    ];
    let mut table = Table::new("Values in SI units, one standard error", columns);
    let known = |value: f64, digits| match value.is_finite() {
        true => significant(value, digits),
        false => "-".to_owned(),
    };
    for (it, remark) in all {
        let bound = if it.at_bound { "at its bound" } else { "" };
        let remarks: Vec<&str> =
            [bound, &remark].into_iter().filter(|words| !words.is_empty()).collect();
        let key = Key::Parameter { name: it.name.clone(), unit: it.unit.clone(), value: it.value };
        table.push(vec![
            it.name.as_str().into(),
            Cell::of(significant(it.value, DIGITS), Some(key)),
            known(it.std_error, 3).into(),
            it.unit.as_str().into(),
            known(it.before, DIGITS).into(),
            remarks.join(", ").into(),
        ]);
    }
    Block::Table(table)
}

/// What the recordings do not tell, a sentence each.
pub(crate) fn not_told(all: &[NotIdentifiable]) -> Vec<Block> {
    let stated = |it: &NotIdentifiable| {
        let NotIdentifiable { parameter, kept, with } = it;
        let why = match with.as_slice() {
            [] => "nothing in the recordings depends on it".to_owned(),
            some => format!("only together with {}", some.join(", ")),
        };
        let kept = significant(*kept, DIGITS);
        Block::Note(format!("not identifiable: {parameter}, kept at {kept}: {why}"))
    };
    all.iter().map(stated).collect()
}
