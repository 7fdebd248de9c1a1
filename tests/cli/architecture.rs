//! What ARCHITECTURE.md says of the crates is what their manifests say.

use std::collections::BTreeSet;
use std::path::Path;

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
        let told: BTreeSet<String> =
            uses.split(", ").filter(|it| !it.is_empty()).map(str::to_owned).collect();
        assert_eq!(told, used(&manifest), "{name}");
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
