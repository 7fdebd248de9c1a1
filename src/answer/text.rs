//! Blocks as text for a terminal: plain, without colours, so that it reads the same in a log.

use super::block::{Align, Block, Card, Column, Fact, Item, Medium, Row, Table};

/// Characters of a heading that stand in one line.
const LEAST: usize = 10;
/// Between two columns.
const GAP: &str = "  ";

/// The blocks as text that ends in a line break.
pub(crate) fn text(blocks: &[Block]) -> String {
    let mut out = Text::default();
    out.blocks(blocks);
    out.0.trim_end_matches('\n').to_owned() + "\n"
}

/// The last row of a table in a line, with what stands above its columns.
pub(crate) fn line(table: &Table) -> String {
    let Some(row) = table.rows.last() else { return String::new() };
    let shown = shown(table);
    let value = |at: &usize| {
        let heading = table.columns[*at].heading.to_lowercase();
        format!("{heading} {}", row.cells[*at].text)
    };
    let Some((name, rest)) = shown.split_first() else { return String::new() };
    let values: Vec<String> = rest.iter().map(value).collect();
    clean(&format!("{}: {}", row.cells[*name].text, values.join(", ")))
}

/// What came from a file must not steer the terminal.
fn clean(words: &str) -> String {
    words.replace(char::is_control, "?")
}

#[derive(Default)]
struct Text(String);

impl Text {
    fn line(&mut self, words: &str) {
        self.0 += &clean(words);
        self.0.push('\n');
    }

    /// An empty line, but for two of them or one at the beginning.
    fn gap(&mut self) {
        if !self.0.is_empty() && !self.0.ends_with("\n\n") {
            self.0.push('\n');
        }
    }

    fn blocks(&mut self, blocks: &[Block]) {
        blocks.iter().for_each(|block| self.block(block));
    }

    fn block(&mut self, block: &Block) {
        match block {
            Block::Verdict { about, words, remark } => {
                let about = if about.is_empty() { String::new() } else { format!("{about}: ") };
                self.line(&format!("{about}{words}"));
                if !remark.is_empty() {
                    self.line(remark);
                }
            }
            Block::Sentence(words)
            | Block::Note(words)
            | Block::Alert(words)
            | Block::Heading(words) => self.line(words),
            Block::Command { words, command } => self.line(&format!("{words}: {command}")),
            Block::Tiles(facts) | Block::Facts(facts) => {
                facts.iter().filter(|it| is_shown(it)).for_each(|it| self.line(&fact(it)));
            }
            Block::List(items) => {
                for Item { head, note, .. } in items {
                    let note = if note.is_empty() { String::new() } else { format!(": {note}") };
                    self.line(&format!("{GAP}{head}{note}"));
                }
            }
            Block::Table(table) => self.table(table),
            Block::Figure(_) | Block::Panels(_) | Block::Contents(_) => {}
            Block::Cards(cards) => self.cards(cards),
            Block::Details { blocks, .. }
            | Block::Section { blocks, .. }
            | Block::Part { blocks, .. } => self.blocks(blocks),
            Block::Slot { blocks, .. } => {
                self.blocks(blocks);
                self.gap();
            }
            Block::In(media, blocks) if media.contains(&Medium::Terminal) => self.blocks(blocks),
            Block::In(..) => {}
        }
    }

    /// One table, or one for every group of its columns: a terminal is narrow.
    fn table(&mut self, table: &Table) {
        if table.rows.is_empty() {
            return;
        }
        let columns: Vec<(usize, &Column)> =
            shown(table).into_iter().map(|at| (at, &table.columns[at])).collect();
        let mut groups: Vec<&str> = Vec::new();
        for (_, column) in columns.iter().filter(|(_, column)| !column.group.is_empty()) {
            if groups.last() != Some(&column.group.as_str()) {
                groups.push(&column.group);
            }
        }
        if groups.is_empty() {
            self.part(&table.caption, &table.rows, &columns);
        }
        for group in groups {
            let with = columns.iter().filter(|(_, it)| it.group.is_empty() || it.group == group);
            let with: Vec<(usize, &Column)> = with.copied().collect();
            self.part(&format!("{}, {group}", table.caption), &table.rows, &with);
        }
    }

    fn part(&mut self, caption: &str, rows: &[Row], columns: &[(usize, &Column)]) {
        self.gap();
        if !caption.is_empty() {
            self.line(caption);
        }
        self.rows(rows, columns);
        self.gap();
    }

    fn rows(&mut self, rows: &[Row], columns: &[(usize, &Column)]) {
        let cell = |row: &Row, at: usize| row.cells[at].text.clone();
        let widths: Vec<usize> = columns
            .iter()
            .map(|(at, column)| {
                let cells = rows.iter().map(|row| cell(row, *at).chars().count());
                let words = column.heading.split_whitespace().map(|word| word.chars().count());
                // A heading breaks where its cells are short, but not after every word.
                let heading = column.heading.chars().count().min(LEAST);
                cells.chain(words).chain([heading]).max().unwrap_or(0)
            })
            .collect();
        let headings: Vec<Vec<String>> = columns
            .iter()
            .zip(&widths)
            .map(|((_, column), width)| wrapped(&column.heading, *width))
            .collect();
        let tallest = headings.iter().map(Vec::len).max().unwrap_or(0);
        for number in 0..tallest {
            // The last line of each stands above its cells.
            let part = |lines: &Vec<String>| {
                let above = tallest - lines.len();
                number.checked_sub(above).map_or(String::new(), |at| lines[at].clone())
            };
            self.cells(columns, &widths, &headings.iter().map(part).collect::<Vec<_>>());
        }
        for row in rows {
            let cells: Vec<String> = columns.iter().map(|(at, _)| cell(row, *at)).collect();
            self.cells(columns, &widths, &cells);
        }
    }

    fn cells(&mut self, columns: &[(usize, &Column)], widths: &[usize], cells: &[String]) {
        let each = columns.iter().zip(widths).zip(cells);
        let padded = each.map(|(((_, column), width), cell)| match column.align {
            Align::Number => format!("{GAP}{cell:>width$}"),
            Align::Name | Align::Symbol | Align::Words => format!("{GAP}{cell:<width$}"),
        });
        self.line(padded.collect::<String>().trim_end());
    }

    /// What is ranked as a table of its facts, each by its name; what belongs to the others, first.
    fn cards(&mut self, cards: &[Card]) {
        let (ranked, honest): (Vec<&Card>, Vec<&Card>) =
            cards.iter().partition(|card| card.rank.is_some());
        honest.iter().for_each(|card| self.blocks(&card.blocks));
        if ranked.is_empty() {
            return;
        }
        let mut names: Vec<&str> = Vec::new();
        for fact in ranked.iter().flat_map(|card| &card.facts).filter(|it| is_shown(it)) {
            if !names.contains(&fact.name.as_str()) {
                names.push(&fact.name);
            }
        }
        let mut columns = vec![Column::new(Align::Name, "")];
        columns.extend(names.iter().map(|name| Column::new(Align::Number, *name)));
        columns.push(Column::new(Align::Words, ""));
        let mut table = Table::new("", columns);
        for card in ranked {
            let mark = card.mark.as_ref().map_or("", |mark| match mark {
                Ok(words) | Err(words) => words,
            });
            let fact = |name: &&str| {
                let own = card.facts.iter().find(|it| is_shown(it) && it.name == **name);
                own.map_or("-", |it| it.value.as_str()).into()
            };
            let mut cells = vec![card.title.as_str().into()];
            cells.extend(names.iter().map(fact));
            cells.push(mark.into());
            table.push(cells);
        }
        self.table(&table);
    }
}

fn is_shown(fact: &Fact) -> bool {
    fact.media.contains(&Medium::Terminal)
}

/// Places of the columns that a terminal shows.
fn shown(table: &Table) -> Vec<usize> {
    let is_shown = |at: &usize| table.columns[*at].media.contains(&Medium::Terminal);
    (0..table.columns.len()).filter(is_shown).collect()
}

fn fact(it: &Fact) -> String {
    let note = if it.note.is_empty() { String::new() } else { format!(" ({})", it.note) };
    format!("{}: {}{note}", it.name, it.value)
}

/// The words in lines of at most that many characters.
fn wrapped(words: &str, width: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in words.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}
