//! Blocks as HTML, for the page and for reports.

use maud::{Markup, PreEscaped, html};

use super::block::{
    Align, Block, Card, Cell, Column, Fact, Item, Key, Medium, Picture, Plot, Table,
};
use crate::report::page::{math, minus, section};
use crate::report::words::capital;

/// Width of the pictures that stand beside each other, pixels.
const NARROW: f64 = 400.0;

/// What the page offers in the place of what a key stands for, or below it.
pub(crate) type Actions<'a> = &'a dyn Fn(&Key) -> Option<Markup>;

/// The blocks in a report, in which nothing can be done.
pub(crate) fn report(blocks: &[Block]) -> Markup {
    Html { medium: Medium::Report, actions: &|_| None }.blocks(blocks)
}

/// The blocks on the page.
pub(crate) fn page(blocks: &[Block], actions: Actions<'_>) -> Markup {
    Html { medium: Medium::Page, actions }.blocks(blocks)
}

#[derive(Clone, Copy)]
struct Html<'a> {
    medium: Medium,
    actions: Actions<'a>,
}

impl Html<'_> {
    fn blocks(self, blocks: &[Block]) -> Markup {
        html! { @for block in blocks { (self.block(block)) } }
    }

    fn block(self, block: &Block) -> Markup {
        match block {
            Block::Verdict { words, remark, .. } => html! {
                p.verdict { (sentence(words)) }
                @if !remark.is_empty() { p.second { (minus(remark)) } }
            },
            Block::Sentence(words) => html! { p { (sentence(words)) } },
            Block::Note(words) => html! { p.note { (sentence(words)) } },
            Block::Alert(words) => html! { p.note.alert { (sentence(words)) } },
            Block::Command { words, command } => html! {
                p.note { (capital(words)) ": " code { (command) } }
            },
            Block::Tiles(facts) => html! {
                dl.tiles {
                    @for fact in self.shown(facts) {
                        div {
                            dt { (fact.name) }
                            dd { (minus(&fact.value)) span.sub { (minus(&fact.note)) } }
                        }
                    }
                }
            },
            Block::Facts(facts) => self.facts(facts),
            Block::List(items) => html! { ul.reading { @for item in items { (self.item(item)) } } },
            Block::Table(table) if table.rows.is_empty() => html! {},
            Block::Table(table) => self.table(table),
            Block::Figure(picture) => figure(picture, None, &html! {}),
            Block::Panels(all) => html! {
                div.panels {
                    @for (picture, blocks) in all {
                        (figure(picture, Some(NARROW), &self.blocks(blocks)))
                    }
                }
            },
            Block::Cards(cards) => html! { div.cards { @for card in cards { (self.card(card)) } } },
            Block::Heading(words) => html! { h3 { (words) } },
            Block::Details { summary, blocks } => html! {
                details { summary { (summary) } (self.blocks(blocks)) }
            },
            Block::Section { id, title, blocks } => section(id, title, &self.blocks(blocks)),
            Block::In(media, blocks) if media.contains(&self.medium) => self.blocks(blocks),
            Block::In(..) => html! {},
        }
    }

    fn shown(self, facts: &[Fact]) -> impl Iterator<Item = &Fact> {
        facts.iter().filter(move |fact| fact.media.contains(&self.medium))
    }

    fn facts(self, facts: &[Fact]) -> Markup {
        html! {
            dl.facts {
                @for fact in self.shown(facts) {
                    div {
                        dt { (fact.name) }
                        dd {
                            (minus(&fact.value))
                            @if !fact.note.is_empty() { " (" (minus(&fact.note)) ")" }
                        }
                    }
                }
            }
        }
    }

    fn item(self, item: &Item) -> Markup {
        let head = item.key.as_ref().and_then(|key| (self.actions)(key));
        html! {
            li {
                @if let Some(head) = head { (head) }
                @else if item.code { code { (item.head) } }
                @else { (minus(&item.head)) }
                @if !item.note.is_empty() { " " span.note { (minus(&item.note)) } }
            }
        }
    }

    fn table(self, table: &Table) -> Markup {
        let columns: Vec<(usize, &Column)> = table
            .columns
            .iter()
            .enumerate()
            .filter(|(_, column)| column.media.contains(&self.medium))
            .collect();
        html! {
            div.scroll role="region" tabindex="0" aria-label=(table.caption) {
                table {
                    caption { (table.caption) }
                    thead { tr {
                        @for (_, column) in &columns {
                            th.name[column.align != Align::Number] scope="col" { (column.heading) }
                        }
                    } }
                    tbody {
                        @for row in &table.rows {
                            tr data-step=[step(row.key.as_ref())] {
                                @for (at, column) in &columns {
                                    (self.cell(&row.cells[*at], column.align, *at == 0))
                                }
                            }
                        }
                    }
                }
            }
        }
    }

    fn cell(self, cell: &Cell, align: Align, names_the_row: bool) -> Markup {
        let done = cell.key.as_ref().and_then(|key| (self.actions)(key));
        let content = done.unwrap_or_else(|| match align {
            Align::Symbol => math(&cell.text),
            _ => html! { (minus(&cell.text)) },
        });
        match align {
            _ if names_the_row => html! { th scope="row" { (content) } },
            Align::Number => html! { td { (content) } },
            Align::Name | Align::Symbol => html! { td.name { (content) } },
            Align::Words => html! { td.words { (content) } },
        }
    }

    fn card(self, card: &Card) -> Markup {
        let effect = match &card.key {
            Some(Key::Effect(effect)) => Some(effect),
            _ => None,
        };
        let refused = matches!(card.mark, Some(Err(_)));
        html! {
            article.card.honest[card.rank.is_none()] data-effect=[effect] data-refused[refused]
                aria-label=(card.title) {
                h3 { @if let Some(rank) = card.rank { span.rank { (rank) } " " } (card.title) }
                @match &card.mark {
                    Some(Ok(words)) => p.mark.good { (words) },
                    Some(Err(why)) => p.mark { (why) },
                    None => {},
                }
                (self.blocks(&card.blocks))
                @if !card.facts.is_empty() { (self.facts(&card.facts)) }
                @if let Some(done) = card.key.as_ref().and_then(|key| (self.actions)(key)) { (done) }
            }
        }
    }
}

/// With a capital and a full stop.
fn sentence(words: &str) -> String {
    let end = if words.ends_with(['.', ':', '!', '?']) { "" } else { "." };
    capital(&minus(words)) + end
}

/// The step that a row is.
fn step(key: Option<&Key>) -> Option<usize> {
    match key {
        Some(Key::Step(number)) => Some(*number),
        _ => None,
    }
}

/// A picture with what to see in it; on a narrow page it scrolls by itself.
fn figure(picture: &Picture, width: Option<f64>, below: &Markup) -> Markup {
    let Picture { plot, caption } = picture;
    let (name, svg) = match (plot, width) {
        (Plot::Figure(it), None) => (&it.title, it.svg()),
        (Plot::Figure(it), Some(width)) => (&it.title, it.svg_of(width)),
        (Plot::Rows(it), _) => (&it.title, it.svg()),
        (Plot::Drawn { title, svg }, _) => (title, svg.clone()),
    };
    html! {
        figure {
            div.scroll role="region" tabindex="0" aria-label=(name) { (PreEscaped(svg)) }
            @if !caption.is_empty() { figcaption { (minus(caption)) } }
            (below)
        }
    }
}
