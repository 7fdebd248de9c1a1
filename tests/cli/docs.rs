//! Docs say what names do not: public items have them, and no line repeats the name below it.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use crate::architecture::rust_files;

/// Words that add nothing to a name.
const EMPTY: [&str; 27] = [
    "a", "all", "an", "and", "are", "as", "each", "every", "here", "in", "is", "it", "its", "of",
    "one", "or", "that", "the", "them", "this", "to", "was", "were", "what", "where", "which", "s",
];
/// What an item that other crates use begins with.
const ITEMS: [&str; 7] = ["fn", "const fn", "struct", "enum", "trait", "type", "const"];

/// The words of a text or of a name, without what makes a plural.
fn words(text: &str) -> BTreeSet<String> {
    let mut parted = String::new();
    for c in text.chars() {
        match c {
            'A'..='Z' if !parted.ends_with(|last: char| last.is_ascii_uppercase()) => {
                parted.push(' ');
                parted.push(c.to_ascii_lowercase());
            }
            c if c.is_ascii_alphabetic() => parted.push(c.to_ascii_lowercase()),
            _ => parted.push(' '),
        }
    }
    let singular = |word: &str| word.strip_suffix('s').unwrap_or(word).to_owned();
    parted
        .split(' ')
        .filter(|word| !word.is_empty() && !EMPTY.contains(word))
        .map(singular)
        .collect()
}

/// The name of a field or a variant, if the line begins one.
fn field(line: &str) -> Option<&str> {
    let code = line.trim_start();
    let code = match code.strip_prefix("pub") {
        Some(more) if more.starts_with('(') => more.split_once(") ")?.1,
        Some(more) if more.starts_with(' ') => more.trim_start(),
        _ => code,
    };
    let end = code.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(code.len());
    let (name, more) = code.split_at(end);
    let is_variant = name.starts_with(|c: char| c.is_ascii_uppercase())
        && (more.is_empty() || more.starts_with([',', '(']) || more.starts_with(" {"));
    (is_variant || more.starts_with(": ")).then_some(name).filter(|name| !name.is_empty())
}

/// Whether a line of docs says no more than the name, but for units, numbers and links.
fn repeats(doc: &str, name: &str) -> bool {
    let says_more = doc.contains(|c: char| c.is_ascii_digit() || "[`,".contains(c));
    !says_more && words(doc).is_subset(&words(name))
}

/// The lines of a file before its tests.
fn code(path: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(path).expect("a text");
    text.lines().take_while(|line| *line != "#[cfg(test)]").map(str::to_owned).collect()
}

/// Files of the crates and of the program.
fn sources() -> (PathBuf, Vec<PathBuf>) {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let mut files = Vec::new();
    rust_files(&root, &mut files);
    files.retain(|file| file.components().any(|part| part.as_os_str() == "src"));
    (root, files)
}

#[test]
fn no_line_of_docs_repeats_the_name_of_a_field() {
    assert!(repeats("Its unit.", "x_unit") && repeats("The recordings.", "recordings"));
    assert!(!repeats("Its step, s.", "step_s") && !repeats("Share of it.", "part"));
    let (root, files) = sources();
    let mut found = Vec::new();
    for file in files {
        let lines = code(&file);
        // There the lines are told to users: help and schemas.
        let are_told = lines.iter().any(|it| it.contains("JsonSchema") || it.contains("clap::"));
        if are_told {
            continue;
        }
        for (k, line) in lines.iter().enumerate() {
            let Some(doc) = line.trim_start().strip_prefix("/// ") else { continue };
            let is_doc =
                |k: usize| lines.get(k).is_some_and(|it| it.trim_start().starts_with("///"));
            if k > 0 && is_doc(k - 1) || is_doc(k + 1) {
                continue;
            }
            let below = lines[k + 1..].iter().find(|it| !it.trim_start().starts_with("#["));
            if below.and_then(|it| field(it)).is_some_and(|name| repeats(doc, name)) {
                let file = file.strip_prefix(&root).expect("below the root").display();
                found.push(format!("{file}:{}: {doc}", k + 1));
            }
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn public_items_say_what_they_are() {
    let (root, files) = sources();
    let mut found = Vec::new();
    for file in files {
        let lines = code(&file);
        for (k, line) in lines.iter().enumerate() {
            let Some(item) = line.trim_start().strip_prefix("pub ") else { continue };
            let named = ITEMS.iter().find_map(|it| item.strip_prefix(it)?.strip_prefix(' '));
            // Macros name what they make elsewhere.
            let is_item = named.is_some_and(|name| !name.starts_with('$'));
            let above = lines[..k].iter().rev().map(|it| it.trim_start());
            let above = above.clone().find(|it| !it.starts_with("#["));
            if is_item && !above.is_some_and(|it| it.starts_with("///") || it.ends_with(']')) {
                let file = file.strip_prefix(&root).expect("below the root").display();
                found.push(format!("{file}:{}: {item}", k + 1));
            }
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}
