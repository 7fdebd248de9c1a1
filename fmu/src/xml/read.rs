//! Reading XML with places: every problem names the line and column it was found at.

use roxmltree::{Document, Node, ParsingOptions};

use crate::position::{DocumentProblem, Position};

/// Depth of elements that FMU and SSP documents never come near.
const DEPTH: usize = 200;

/// Parses a document. Document type definitions are refused: they can make a small file expand
/// without bound, and neither FMI nor SSP uses them.
pub(crate) fn parse(text: &str) -> Result<Document<'_>, DocumentProblem> {
    // The byte order mark is legal before an XML declaration, but the parser does not take it.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let document =
        Document::parse_with_options(text, ParsingOptions::default()).map_err(|error| {
            let position = error.pos();
            // The parser repeats the position at the end of its text.
            let message = error.to_string();
            let problem = message.rsplit_once(" at ").map_or(message.as_str(), |(what, _)| what);
            let position = Position { line: position.row, column: position.col };
            DocumentProblem { position, text: problem.to_owned() }
        })?;
    match document.descendants().find(|node| node.ancestors().nth(DEPTH).is_some()) {
        Some(deep) => Err(problem(deep, format!("elements are nested more than {DEPTH} deep"))),
        None => Ok(document),
    }
}

/// A problem at a node.
pub(crate) fn problem(node: Node, problem: impl Into<String>) -> DocumentProblem {
    DocumentProblem { position: position(node), text: problem.into() }
}

/// Where a node starts.
pub(crate) fn position(node: Node) -> Position {
    let position = node.document().text_pos_at(node.range().start);
    Position { line: position.row, column: position.col }
}

/// Positions of many nodes in document order, in one pass: the parser's own look-up counts lines from
/// the start each time, which is slow for an FMU of 100,000 variables.
pub(crate) struct Positions<'a> {
    text: &'a str,
    at: usize,
    position: Position,
}

impl<'a> Positions<'a> {
    pub(crate) fn new(text: &'a str) -> Self {
        Positions { text, at: 0, position: Position { line: 1, column: 1 } }
    }

    pub(crate) fn of(&mut self, node: Node) -> Position {
        let start = node.range().start;
        let Some(between) = self.text.get(self.at..start) else { return position(node) };
        for character in between.chars() {
            if character == '\n' {
                self.position.line += 1;
                self.position.column = 1;
            } else {
                self.position.column += 1;
            }
        }
        self.at = start;
        self.position
    }
}

/// The child elements of a name, whatever their namespace.
pub(crate) fn children<'a, 'i: 'a>(
    node: Node<'a, 'i>,
    name: &'static str,
) -> impl Iterator<Item = Node<'a, 'i>> {
    node.children().filter(move |child| child.is_element() && child.tag_name().name() == name)
}

/// The first child element of a name.
pub(crate) fn child<'a, 'i: 'a>(node: Node<'a, 'i>, name: &'static str) -> Option<Node<'a, 'i>> {
    children(node, name).next()
}

/// An attribute that must be there.
pub(crate) fn required<'a>(node: Node<'a, '_>, name: &str) -> Result<&'a str, DocumentProblem> {
    let missing = || format!("<{}> has no attribute `{name}`", node.tag_name().name());
    node.attribute(name).ok_or_else(|| problem(node, missing()))
}

/// A text attribute.
pub(crate) fn text(node: Node, name: &str) -> Option<String> {
    node.attribute(name).map(str::to_owned)
}

/// A value that can be read from an attribute.
pub(crate) trait Value: Sized {
    const WHAT: &'static str;
    fn read(text: &str) -> Option<Self>;
}

macro_rules! values {
    ($($kind:ty: $what:literal),*) => {$(
        impl Value for $kind {
            const WHAT: &'static str = $what;
            fn read(text: &str) -> Option<Self> { text.parse().ok() }
        }
    )*};
}
values!(f64: "a number", i32: "an integer", i64: "an integer", u32: "a whole number", usize: "a whole number");

impl Value for bool {
    const WHAT: &'static str = "`true` or `false`";
    fn read(text: &str) -> Option<Self> {
        match text {
            "true" | "1" => Some(true),
            "false" | "0" => Some(false),
            _ => None,
        }
    }
}

/// A value attribute, if it is there.
pub(crate) fn value<T: Value>(node: Node, name: &str) -> Result<Option<T>, DocumentProblem> {
    let Some(text) = node.attribute(name) else { return Ok(None) };
    let wrong = || {
        let element = node.tag_name().name();
        problem(node, format!("attribute `{name}` of <{element}> is `{text}`, not {}", T::WHAT))
    };
    T::read(text.trim()).map(Some).ok_or_else(wrong)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn problems_have_line_and_column() {
        let malformed = parse("<a>\n  <b></c>\n</a>").unwrap_err();
        assert_eq!(malformed.position, Position { line: 2, column: 6 });
        let document = parse("<a>\n  <b n='x'/></a>").unwrap();
        let b = child(document.root_element(), "b").unwrap();
        let wrong = value::<f64>(b, "n").unwrap_err();
        assert_eq!(wrong.position, Position { line: 2, column: 3 });
        assert_eq!(wrong.text, "attribute `n` of <b> is `x`, not a number");
        assert_eq!(required(b, "m").unwrap_err().text, "<b> has no attribute `m`");
        assert_eq!(Positions::new(document.input_text()).of(b), position(b));
    }

    #[test]
    fn entity_bombs_are_refused() {
        let bomb = "<!DOCTYPE a [<!ENTITY b \"bb\">]><a>&b;</a>";
        assert!(parse(bomb).is_err());
    }

    #[test]
    fn deep_nesting_is_refused() {
        let deep = "<a>".repeat(300) + &"</a>".repeat(300);
        assert!(parse(&deep).unwrap_err().text.contains("nested"));
    }
}
