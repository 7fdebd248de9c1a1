//! A table in HTML.

use maud::{Markup, html};

use super::{Html, toned};
use crate::answer::block::{Align, Cell, Column, Key, Row, Table};
use crate::report::page::{math, minus, typeset};
use crate::report::words::capital;

/// A column that is shown: its place in the table, and whether a group begins with it.
type Shown<'a> = (usize, &'a Column, bool);

/// A table that scrolls by itself where the page is narrow, by keyboard too.
pub(super) fn table(html: Html<'_>, table: &Table) -> Markup {
    let mut columns: Vec<Shown<'_>> = Vec::new();
    let all = table.columns.iter().enumerate();
    for (at, column) in all.filter(|(_, column)| column.media.contains(&html.medium)) {
        let before = columns.last().map_or("", |(_, before, _)| &before.group);
        columns.push((at, column, !column.group.is_empty() && column.group != before));
    }
    html! {
        div.scroll role="region" tabindex="0" aria-label=(minus(&table.caption)) {
            table {
                caption { (typeset(&table.caption)) }
                thead { (head(&columns)) }
                tbody {
                    @for (place, row) in table.rows.iter().enumerate() {
                        tr.part[table.parts.contains(&place)] data-step=[step(row)] {
                            @for column in &columns {
                                (cell(html, &row.cells[column.0], *column))
                            }
                        }
                    }
                }
            }
        }
    }
}

/// What stands above the columns; above those, what groups of them share.
fn head(columns: &[Shown<'_>]) -> Markup {
    let grouped = columns.iter().any(|(.., is_start)| *is_start);
    let size = |of: &Column| columns.iter().filter(|(_, it, _)| it.group == of.group).count();
    let heading = |(_, column, is_start): &Shown<'_>, rows: Option<&str>| {
        html! {
            th.name[column.align != Align::Number].start[*is_start].theirs[column.beside]
                scope="col" rowspan=[rows] { (typeset(&column.heading)) }
        }
    };
    html! {
        tr {
            @for column in columns {
                @if column.1.group.is_empty() { (heading(column, grouped.then_some("2"))) }
                @else if column.2 {
                    th.group.start colspan=(size(column.1)) scope="colgroup" {
                        (typeset(&capital(&column.1.group)))
                    }
                }
            }
        }
        @if grouped {
            tr {
                @for column in columns {
                    @if !column.1.group.is_empty() { (heading(column, None)) }
                }
            }
        }
    }
}

fn cell(html: Html<'_>, cell: &Cell, (at, column, is_start): Shown<'_>) -> Markup {
    let words = || match (column.align, cell.text.as_str()) {
        // Nothing is there.
        (_, "-") => html! { "\u{2013}" },
        (Align::Symbol, text) => math(text),
        (Align::Words, text) => typeset(text),
        (Align::Number | Align::Name, text) => html! { (minus(text)) },
    };
    let content = html.act(cell.key.as_ref(), &cell.text);
    let content = content.unwrap_or_else(|| toned(cell.tone, words()));
    match column.align {
        _ if at == 0 => html! { th scope="row" { (content) } },
        Align::Number => html! { td.start[is_start].theirs[column.beside] { (content) } },
        Align::Name | Align::Symbol => html! { td.name.theirs[column.beside] { (content) } },
        Align::Words => html! { td.words { (content) } },
    }
}

/// The step that a row is.
fn step(row: &Row) -> Option<usize> {
    match row.key {
        Some(Key::Step(number)) => Some(number),
        _ => None,
    }
}
