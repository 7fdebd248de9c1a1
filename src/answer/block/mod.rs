//! What an answer is told in: blocks, which know nothing of terminals or browsers.
//!
//! Sentences and numbers stand in a block as they are read, with plain hyphens before digits; how a
//! block looks is the affair of [`super::text`] and [`super::html`].

mod table;

use crate::report::plot::{Figure, Rows};

pub(crate) use table::{Align, Cell, Column, Row, Said, Table};

/// Where an answer is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Medium {
    /// As text.
    Terminal,
    /// On the local page.
    Page,
    /// In a file that explains itself.
    Report,
}

/// The media that something is shown in.
pub(crate) type Media = &'static [Medium];
/// Everywhere.
pub(crate) const ALL: Media = &[Medium::Terminal, Medium::Page, Medium::Report];
/// As text alone, such as the name of a file that was written.
pub(crate) const TERMINAL: Media = &[Medium::Terminal];
/// Where there is room, and something is looked up rather than read.
pub(crate) const HTML: Media = &[Medium::Page, Medium::Report];
/// On the page alone.
pub(crate) const PAGE: Media = &[Medium::Page];
/// In a report alone.
pub(crate) const REPORT: Media = &[Medium::Report];
/// Everywhere but on the page, whose window is narrow.
pub(crate) const WIDE: Media = &[Medium::Terminal, Medium::Report];

/// A piece of an answer.
#[derive(Debug)]
pub(crate) enum Block {
    /// The answer in a sentence, and the one that belongs to it. What it is about stands before it in a
    /// text, and in the title of a report.
    Verdict { about: String, words: String, remark: String },
    /// What is to be read.
    Sentence(String),
    /// What is good to know beside it.
    Note(String),
    /// What makes the rest doubtful or worthless.
    Alert(String),
    /// What to type, and what for.
    Command { words: String, command: String },
    /// The numbers that matter most.
    Tiles(Vec<Fact>),
    /// Names with values.
    Facts(Vec<Fact>),
    /// One after the other.
    List(Vec<Item>),
    /// Rows and columns.
    Table(Table),
    /// A picture; a text has none.
    Figure(Picture),
    /// Small pictures beside each other, each with what belongs to it.
    Panels(Vec<(Picture, Vec<Block>)>),
    /// Things to choose among.
    Cards(Vec<Card>),
    /// A part of a section.
    Heading(String),
    /// The same with a title that can be linked to.
    Part { id: String, title: String, blocks: Vec<Block> },
    /// What may be unfolded.
    Details { summary: String, blocks: Vec<Block> },
    /// A part with a title that can be linked to.
    Section { id: &'static str, title: &'static str, blocks: Vec<Block> },
    /// Where to go in a report: a list a line, of ids and what is there.
    Contents(Vec<Vec<(String, String)>>),
    /// What another program may put something else in the place of, between comments of this name.
    Slot { name: &'static str, blocks: Vec<Block> },
    /// Blocks for some media.
    In(Media, Vec<Block>),
}

/// What a value means, beside what it is.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Tone {
    /// Nothing of its own.
    #[default]
    Plain,
    /// It is the one to look at among others.
    Strong,
    /// It is as it should be.
    Good,
    /// It is not.
    Alert,
}

/// What something in a block stands for, so that the page can offer what may be done with it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Key {
    /// An effect that may be added.
    Effect(String),
    /// A law that may be tried: what it gives, its text with values, and as it is read.
    Law { target: &'static str, text: String, head: String },
    /// A step of a ladder.
    Step(usize),
    /// A parameter, its unit and its value, which may be set.
    Parameter { name: String, unit: String, value: f64 },
    /// A span of time, s, and what happens there.
    Span { from: f64, to: f64, sentence: String },
    /// A place in a report, by its id.
    Anchor(String),
}

/// A value with its name.
#[derive(Debug)]
pub(crate) struct Fact {
    pub(crate) name: String,
    /// The value, with its unit.
    pub(crate) value: String,
    /// What to know of it.
    pub(crate) note: String,
    /// What it means.
    pub(crate) tone: Tone,
    /// Where it is shown.
    pub(crate) media: Media,
}

impl Fact {
    pub(crate) fn new(media: Media, name: impl Into<String>, value: impl Into<String>) -> Self {
        let (note, tone) = (String::new(), Tone::Plain);
        Self { name: name.into(), value: value.into(), note, tone, media }
    }

    pub(crate) fn note(self, note: impl Into<String>) -> Self {
        Self { note: note.into(), ..self }
    }

    /// As it should be, or not.
    pub(crate) fn judged(self, good: bool) -> Self {
        Self { tone: if good { Tone::Good } else { Tone::Alert }, ..self }
    }
}

/// One of a list.
#[derive(Debug)]
pub(crate) struct Item {
    /// What its head stands for.
    pub(crate) key: Option<Key>,
    /// Whether the head is typed, as a law is, rather than read.
    pub(crate) code: bool,
    pub(crate) head: String,
    /// What to know of it.
    pub(crate) note: String,
}

/// A plot with what to see in it.
#[derive(Debug)]
pub(crate) struct Picture {
    /// The plot, whose id is unique on its page.
    pub(crate) plot: Plot,
    /// What to see in it.
    pub(crate) caption: String,
}

/// A plot.
#[derive(Debug)]
pub(crate) enum Plot {
    /// Over an axis.
    Figure(Figure),
    /// By categories.
    Rows(Rows),
    /// Drawn already: what it is, and its SVG.
    Drawn { title: String, svg: String },
}

/// Something to choose.
#[derive(Debug)]
pub(crate) struct Card {
    /// What it stands for.
    pub(crate) key: Option<Key>,
    /// Its place among others, where they are ranked.
    pub(crate) rank: Option<usize>,
    /// Its name.
    pub(crate) title: String,
    /// Whether it was chosen, or why not.
    pub(crate) mark: Option<Result<String, String>>,
    /// What it is, before its facts.
    pub(crate) blocks: Vec<Block>,
    /// What speaks for it.
    pub(crate) facts: Vec<Fact>,
}
