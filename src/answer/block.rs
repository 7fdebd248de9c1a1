//! What an answer is told in: blocks, which know nothing of terminals or browsers.
//!
//! Sentences and numbers stand in a block as they are read, with plain hyphens before digits; how a
//! block looks is the affair of [`super::text`] and [`super::html`].

use crate::report::plot::{Figure, Rows};

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
    /// What may be unfolded.
    Details { summary: String, blocks: Vec<Block> },
    /// A part with a title that can be linked to.
    Section { id: &'static str, title: &'static str, blocks: Vec<Block> },
    /// Blocks for some media.
    In(Media, Vec<Block>),
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
}

/// A value with its name.
#[derive(Debug)]
pub(crate) struct Fact {
    /// What it is.
    pub(crate) name: String,
    /// The value, with its unit.
    pub(crate) value: String,
    /// What to know of it.
    pub(crate) note: String,
    /// Where it is shown.
    pub(crate) media: Media,
}

impl Fact {
    pub(crate) fn new(media: Media, name: impl Into<String>, value: impl Into<String>) -> Self {
        Self { name: name.into(), value: value.into(), note: String::new(), media }
    }

    pub(crate) fn note(self, note: impl Into<String>) -> Self {
        Self { note: note.into(), ..self }
    }
}

/// One of a list.
#[derive(Debug)]
pub(crate) struct Item {
    /// What its head stands for.
    pub(crate) key: Option<Key>,
    /// Whether the head is typed, as a law is, rather than read.
    pub(crate) code: bool,
    /// What it is.
    pub(crate) head: String,
    /// What to know of it.
    pub(crate) note: String,
}

/// Rows and columns.
#[derive(Debug)]
pub(crate) struct Table {
    /// What it shows.
    pub(crate) caption: String,
    /// The columns; the first one names the rows.
    pub(crate) columns: Vec<Column>,
    /// The rows, with a cell for every column.
    pub(crate) rows: Vec<Row>,
}

impl Table {
    /// Without rows as yet.
    pub(crate) fn new(caption: impl Into<String>, columns: Vec<Column>) -> Self {
        Self { caption: caption.into(), columns, rows: Vec::new() }
    }

    /// With a row more.
    pub(crate) fn push(&mut self, cells: Vec<Cell>) {
        self.rows.push(Row { key: None, cells });
    }
}

/// How the cells of a column stand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Align {
    /// Numbers, flush right.
    Number,
    /// Names, flush left.
    Name,
    /// Symbols of the equations, typeset where they can be.
    Symbol,
    /// Sentences, which may break.
    Words,
}

/// A column.
#[derive(Debug)]
pub(crate) struct Column {
    /// What stands above it, with the unit.
    pub(crate) heading: String,
    /// How its cells stand.
    pub(crate) align: Align,
    /// Where it is shown.
    pub(crate) media: Media,
}

impl Column {
    pub(crate) fn new(align: Align, heading: impl Into<String>) -> Self {
        Self { heading: heading.into(), align, media: ALL }
    }

    pub(crate) fn only(self, media: Media) -> Self {
        Self { media, ..self }
    }
}

/// A row.
#[derive(Debug)]
pub(crate) struct Row {
    /// What it stands for.
    pub(crate) key: Option<Key>,
    /// Its cells.
    pub(crate) cells: Vec<Cell>,
}

/// A cell.
#[derive(Debug)]
pub(crate) struct Cell {
    /// What it says.
    pub(crate) text: String,
    /// What it stands for.
    pub(crate) key: Option<Key>,
}

impl<T: Into<String>> From<T> for Cell {
    fn from(text: T) -> Self {
        Self { text: text.into(), key: None }
    }
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
