//! Blocks as HTML, for the page and for reports.

mod table;

use maud::{Markup, PreEscaped, html};

use super::block::{Block, Card, Fact, Item, Key, Medium, Picture, Plot, Tone};
use crate::report::page::{section, typeset};
use crate::report::words::capital;

/// Width of the pictures that stand beside each other, pixels.
const NARROW: f64 = 400.0;

/// What the page offers in the place of what a key stands for, or below it.
pub(crate) type Actions<'a> = &'a dyn Fn(&Key) -> Option<Markup>;

/// The blocks in a report, in which nothing can be done but to go from place to place.
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
                @if !remark.is_empty() { p.second { (typeset(remark)) } }
            },
            Block::Sentence(words) => html! { p { (sentence(words)) } },
            Block::Note(words) => html! { p.note { (sentence(words)) } },
            Block::Alert(words) => html! { p.note.alert { (sentence(words)) } },
            Block::Command { words, command } => html! {
                p.note { (capital(words)) ": " code { (command) } }
            },
            Block::Tiles(facts) => self.facts("tiles", facts, below),
            Block::Facts(facts) => self.facts("facts", facts, in_brackets),
            Block::List(items) => html! { ul.reading { @for item in items { (self.item(item)) } } },
            Block::Table(table) if table.rows.is_empty() => html! {},
            Block::Table(table) => table::table(self, table),
            Block::Figure(picture) => figure(picture, None, &html! {}),
            Block::Panels(all) => html! {
                div.panels {
                    @for (picture, blocks) in all {
                        (figure(picture, Some(NARROW), &self.blocks(blocks)))
                    }
                }
            },
            Block::Cards(cards) => html! { div.cards { @for card in cards { (self.card(card)) } } },
            Block::Heading(words) => html! { h3 { (typeset(words)) } },
            Block::Part { id, title, blocks } => html! {
                h3 id=(id) { (link(id, typeset(&capital(title)))) }
                (self.blocks(blocks))
            },
            Block::Details { summary, blocks } => html! {
                details { summary { (summary) } (self.blocks(blocks)) }
            },
            Block::Section { id, title, blocks } => section(id, title, &self.blocks(blocks)),
            Block::Contents(lists) => html! {
                nav aria-label="Contents" {
                    @for list in lists {
                        ul { @for (id, name) in list { li { (link(id, typeset(name))) } } }
                    }
                }
            },
            Block::Slot { name, blocks } => html! {
                (PreEscaped(format!("<!-- {name} -->")))
                (self.blocks(blocks))
                (PreEscaped(format!("<!-- /{name} -->")))
            },
            Block::In(media, blocks) if media.contains(&self.medium) => self.blocks(blocks),
            Block::In(..) => html! {},
        }
    }

    /// What is done with a key: a place is gone to.
    fn act(self, key: Option<&Key>, words: &str) -> Option<Markup> {
        match key? {
            Key::Anchor(id) => Some(link(id, typeset(words))),
            key => (self.actions)(key),
        }
    }

    fn shown(self, facts: &[Fact]) -> impl Iterator<Item = &Fact> {
        facts.iter().filter(move |fact| fact.media.contains(&self.medium))
    }

    fn facts(self, class: &str, facts: &[Fact], note: fn(&str) -> Markup) -> Markup {
        html! {
            dl class=(class) {
                @for fact in self.shown(facts) {
                    div {
                        dt { (typeset(&fact.name)) }
                        dd { (toned(fact.tone, typeset(&fact.value))) (note(&fact.note)) }
                    }
                }
            }
        }
    }

    fn item(self, item: &Item) -> Markup {
        let head = self.act(item.key.as_ref(), &item.head);
        html! {
            li {
                @if let Some(head) = head { (head) }
                @else if item.code { code { (item.head) } }
                @else { (typeset(&item.head)) }
                @if !item.note.is_empty() { " " span.note { (typeset(&item.note)) } }
            }
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
                @if !card.facts.is_empty() { (self.facts("facts", &card.facts, in_brackets)) }
                @if let Some(done) = self.act(card.key.as_ref(), &card.title) { (done) }
            }
        }
    }
}

/// With a capital, unless a symbol is its first word, and a full stop.
fn sentence(words: &str) -> Markup {
    let end = if words.ends_with(['.', ':', '!', '?']) { "" } else { "." };
    let symbol = words.as_bytes().get(1) == Some(&b'_');
    let words = if symbol { words.to_owned() } else { capital(words) };
    typeset(&(words + end))
}

fn link(id: &str, words: Markup) -> Markup {
    html! { a href={ "#" (id) } { (words) } }
}

/// The note of a fact behind its value.
fn in_brackets(note: &str) -> Markup {
    html! { @if !note.is_empty() { " (" (typeset(note)) ")" } }
}

/// The note of a tile below its value.
fn below(note: &str) -> Markup {
    html! { span.sub { (typeset(note)) } }
}

fn toned(tone: Tone, value: Markup) -> Markup {
    match tone {
        Tone::Plain => value,
        Tone::Strong => html! { strong { (value) } },
        Tone::Good => html! { span.good { (value) } },
        Tone::Alert => html! { span.alert { (value) } },
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
            @if !caption.is_empty() { figcaption { (typeset(caption)) } }
            (below)
        }
    }
}
