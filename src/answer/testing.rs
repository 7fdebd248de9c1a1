//! What tests of answers share: that all media tell the same numbers.

use std::collections::BTreeSet;

use maud::Markup;
use scraper::Html;
use scraper::node::Element;

use super::block::Block;
use super::{html, text};

/// The numbers of a text, as they are written.
fn numbers(words: &str) -> BTreeSet<String> {
    let apart = |c: char| c.is_whitespace() || ",;:()%[]".contains(c);
    let written = words.split(apart).map(|word| word.trim_end_matches('.'));
    written.filter(|word| word.parse::<f64>().is_ok()).map(str::to_owned).collect()
}

/// What is read in HTML, but for its pictures.
fn read(html: &Markup) -> String {
    let page = Html::parse_fragment(&html.0);
    assert!(page.errors.is_empty(), "{:?}", page.errors);
    let drawn = |name: Option<&Element>| name.is_some_and(|it| it.name() == "svg");
    let words = page.root_element().descendants().filter_map(|node| {
        let is_drawn = node.ancestors().any(|above| drawn(above.value().as_element()));
        node.value().as_text().filter(|_| !is_drawn)
    });
    let words: Vec<&str> = words.map(|text| &**text).collect();
    words.join(" ").replace('\u{2212}', "-")
}

/// What a report of these blocks says.
pub(super) fn in_report(blocks: &[Block]) -> String {
    read(&html::report(blocks))
}

/// What the page says.
pub(super) fn on_page(blocks: &[Block]) -> String {
    read(&html::page(blocks, &|_| None))
}

/// Every number of the text stands there too, rounded alike.
pub(super) fn holds(blocks: &[Block], elsewhere: &str) {
    let (said, there) = (numbers(&text(blocks)), numbers(elsewhere));
    assert!(said.len() > 1, "nothing is compared: {said:?}");
    let lost: Vec<&String> = said.difference(&there).collect();
    assert!(lost.is_empty(), "{lost:?} of the text are not in: {elsewhere}");
}
