//! What ARCHITECTURE.md says of crates, files and unsafe code is what manifests and files say.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

const ARCHITECTURE: &str = include_str!("../../ARCHITECTURE.md");
const OURS: &str = "drivescope-";
const PROGRAM: &str = "drivescope";

/// Crates of the workspace that a manifest names.
fn used(manifest: &toml::Table) -> BTreeSet<String> {
    let tables = ["dependencies", "build-dependencies", "dev-dependencies"];
    let of = tables.iter().filter_map(|table| manifest.get(*table)?.as_table());
    of.flat_map(toml::Table::keys)
        // The program itself is called by its own name.
        .filter_map(|name| name.strip_prefix(OURS).or((name == PROGRAM).then_some(PROGRAM)))
        .map(str::to_owned)
        .collect()
}

#[test]
fn crates_use_what_the_table_says_and_nothing_else() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let manifest = |folder: &str| -> toml::Table {
        let file = root.join(folder).join("Cargo.toml");
        let text = std::fs::read_to_string(&file).expect("a manifest is there");
        text.parse().expect("it is TOML")
    };
    let mut folders = BTreeSet::new();
    for row in ARCHITECTURE.lines().filter(|line| line.starts_with("| `drivescope")) {
        let cells: Vec<&str> = row.split('|').map(|cell| cell.trim().trim_matches('`')).collect();
        let (name, folder, uses) = (cells[1], cells[2], cells[3]);
        let manifest = manifest(folder);
        assert_eq!(manifest["package"]["name"].as_str(), Some(name), "{folder}");
        let stated: BTreeSet<String> =
            uses.split(", ").filter(|it| !it.is_empty()).map(str::to_owned).collect();
        assert_eq!(stated, used(&manifest), "{name}");
        folders.insert(folder.to_owned());
    }
    let members = manifest(".")["workspace"]["members"].clone();
    let members = members.as_array().expect("a list").iter().filter_map(|it| it.as_str());
    let all: BTreeSet<String> = members.chain(["."]).map(str::to_owned).collect();
    assert_eq!(folders, all);
}

#[test]
fn files_that_are_named_are_there() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let named = ARCHITECTURE.split('`').skip(1).step_by(2);
    let mut count = 0;
    for file in named.filter(|it| it.contains('/') && it.contains(".rs")) {
        let places =
            ["", "discovery/src/", "fmu/src/import/"].map(|from| root.join(from).join(file));
        assert!(places.iter().any(|place| place.exists()), "{file}");
        count += 1;
    }
    assert!(count > 15, "{count}");
}

/// Every Rust file of the project below a folder.
pub(crate) fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder that can be read").flatten() {
        let (path, name) = (entry.path(), entry.file_name());
        let name = name.to_string_lossy();
        // Build outputs, virtual environments, the repository's own data.
        let is_ours = !name.starts_with('.') && !name.starts_with("target");
        match entry.file_type().expect("a type") {
            kind if kind.is_dir() && is_ours => rust_files(&path, found),
            kind if kind.is_file() && name.ends_with(".rs") => found.push(path),
            _ => {}
        }
    }
}

/// Whether a file holds the keyword outside of comments and texts.
fn has_unsafe(text: &str) -> bool {
    text.lines().map(|line| line.split("//").next().unwrap_or_default()).any(|code| {
        let outside: String = code.split('"').step_by(2).collect();
        let word = |c: char| !(c.is_alphanumeric() || c == '_' || c == '-' || c == '\'');
        outside.split(word).any(|it| it == "unsafe")
    })
}

#[test]
fn unsafe_code_is_where_the_table_says() {
    assert!(has_unsafe("        unsafe { x() };") && has_unsafe("#[unsafe(no_mangle)]"));
    assert!(!has_unsafe("// unsafe {") && !has_unsafe("\"unsafe\"; unsafe_code; 'unsafe-inline'"));
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = Vec::new();
    rust_files(root, &mut files);
    let holds = |path: &&PathBuf| has_unsafe(&std::fs::read_to_string(path).expect("a text"));
    let found: BTreeSet<String> = files
        .iter()
        .filter(holds)
        .map(|path| path.strip_prefix(root).expect("below the root").display().to_string())
        .collect();
    let section = ARCHITECTURE.split("## Unsafe code").nth(1).expect("a section");
    let section = section.split("\n## ").next().expect("an end");
    let cells = section.lines().filter_map(|line| line.strip_prefix("| ")?.split(" |").next());
    let stated: BTreeSet<String> = cells
        .flat_map(|cell| cell.split('`').skip(1).step_by(2).map(str::to_owned).collect::<Vec<_>>())
        .collect();
    assert_eq!(found, stated);
}
