//! A block that is made once, in every medium.

use maud::html;

use super::block::*;
use super::testing::{holds, in_report, on_page};
use super::{html as renderer, line, text};

fn table() -> Table {
    let columns = vec![
        Column::new(Align::Symbol, "Parameter"),
        Column::new(Align::Number, "Value of it"),
        Column::new(Align::Number, "Wide").only(WIDE),
    ];
    let mut table = Table::new("Values", columns);
    let key = Some(Key::Step(7));
    let value = Cell::of("-1.50", key.clone());
    let cells = vec!["K_m".into(), value, "2.25".into()];
    table.rows.push(Row { key, cells });
    table
}

fn every_kind() -> Vec<Block> {
    let item = Item { key: None, code: true, head: "c * omega".into(), note: "3 names".into() };
    let fact = || vec![Fact::new(ALL, "Error", "1.25").note("floor 1")];
    let card = Card {
        key: Some(Key::Effect("cogging".to_owned())),
        rank: Some(1),
        title: "cogging".to_owned(),
        mark: Some(Err("not named: too small".to_owned())),
        blocks: vec![Block::In(HTML, vec![Block::Note("only where there is room".to_owned())])],
        facts: vec![Fact::new(ALL, "Probability", "0.5000"), Fact::new(HTML, "Evidence", "12.5")],
    };
    vec![
        Block::Verdict { about: "AMIRA".into(), words: "it fails".into(), remark: "By 4.".into() },
        Block::Sentence("a sentence".to_owned()),
        Block::Alert("an alert".to_owned()),
        Block::Command { words: "to add one".to_owned(), command: "drivescope add".to_owned() },
        Block::Tiles(fact()),
        Block::Facts(fact()),
        Block::List(vec![item]),
        Block::Section {
            id: "part",
            title: "Part",
            blocks: vec![Block::Heading("a heading".into()), Block::Table(table())],
        },
        Block::Cards(vec![card]),
        Block::In(TERMINAL, vec![Block::Note("written: a.toml".to_owned())]),
    ]
}

#[test]
fn a_block_made_once_is_in_every_medium() {
    let blocks = every_kind();
    let (said, page, report) = (text(&blocks), on_page(&blocks), in_report(&blocks));
    for words in [
        "it fails",
        "by 4.",
        "sentence",
        "an alert",
        "drivescope add",
        "1.25",
        "floor 1",
        "c * omega",
        "3 names",
        "a heading",
        "-1.50",
        "cogging",
        "too small",
        "0.5000",
    ] {
        for (medium, all) in [("text", &said), ("page", &page), ("report", &report)] {
            assert!(all.to_lowercase().contains(words), "{words:?} is not in the {medium}: {all}");
        }
    }
    holds(&blocks, &report);
}

#[test]
fn what_is_for_some_media_is_in_those() {
    let blocks = every_kind();
    let (said, page, report) = (text(&blocks), on_page(&blocks), in_report(&blocks));
    for (words, in_text, in_page, in_report) in [
        ("written: a.toml", true, false, false),
        ("only where there is room", false, true, true),
        ("12.5", false, true, true),
        ("2.25", true, false, true),
    ] {
        let found = [&said, &page, &report].map(|all| all.to_lowercase().contains(words));
        assert_eq!(found, [in_text, in_page, in_report], "{words}");
    }
}

#[test]
fn the_page_offers_what_may_be_done() {
    let offered = |key: &Key| match key {
        Key::Step(number) => Some(html! { button { "go to " (number) } }),
        Key::Effect(effect) => Some(html! { button { "add " (effect) } }),
        _ => None,
    };
    let page = renderer::page(&every_kind(), &offered).into_string();
    assert!(page.contains("<button>go to 7</button>") && page.contains("<button>add cogging"));
    assert!(page.contains("data-step=\"7\"") && page.contains("K<sub>m</sub>"), "{page}");
    assert!(!renderer::report(&every_kind()).into_string().contains("<button"));
}

#[test]
fn a_text_is_aligned_and_does_not_steer_the_terminal() {
    let said = text(&[Block::Table(table()), Block::Note("a\u{1b}[2Jb".to_owned())]);
    assert_eq!(
        said,
        "Values\n               Value of\n  Parameter          it  Wide\n  K_m             -1.50  2.25\n\n\
         a?[2Jb\n"
    );
    assert_eq!(line(&table()), "K_m: value of it -1.50, wide 2.25");
}
