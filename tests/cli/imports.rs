//! Files of a crate use each other in one direction, but for a module and what lies below it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use crate::architecture::rust_files;

/// Names from the root of the crate.
type Name = Vec<String>;

/// A module: what it uses of its crate, and what it hands on under names of its own.
#[derive(Default)]
struct Module {
    uses: BTreeSet<Name>,
    hands_on: BTreeMap<String, Name>,
}

/// The code of a file: without comments, texts and tests.
fn code(text: &str) -> String {
    let mut code = String::new();
    for line in text.lines().take_while(|line| *line != "#[cfg(test)]") {
        let line = line.split("//").next().unwrap_or_default();
        code.extend(line.split('"').step_by(2));
        code.push('\n');
    }
    code
}

/// The paths of a `use`, of which braces hold several.
fn spread(tree: &str) -> Vec<String> {
    let tree = tree.trim();
    let Some((before, inner)) = tree.strip_suffix('}').and_then(|it| it.split_once('{')) else {
        let path = tree.split(" as ").next().unwrap_or_default();
        return if path.is_empty() { Vec::new() } else { vec![path.replace(' ', "")] };
    };
    let (mut parts, mut depth) = (vec![String::new()], 0);
    for c in inner.chars() {
        depth += i32::from(c == '{') - i32::from(c == '}');
        match parts.last_mut() {
            Some(part) if c != ',' || depth > 0 => part.push(c),
            _ => parts.push(String::new()),
        }
    }
    parts.iter().flat_map(|part| spread(part)).map(|path| format!("{before}{path}")).collect()
}

/// The name that a path in that module stands for, if it is one of the crate.
fn resolved(path: &str, module: &[String], modules: &BTreeSet<Name>) -> Option<Name> {
    let mut parts = path.trim().split("::").peekable();
    let mut name = match *parts.peek()? {
        "crate" => Vec::new(),
        "self" | "super" => module.to_vec(),
        first => {
            let inner = [module, &[first.to_owned()]].concat();
            return modules
                .contains(&inner)
                .then(|| [module, &parts.map(str::to_owned).collect::<Vec<_>>()].concat());
        }
    };
    for part in parts {
        match part {
            "crate" | "self" => {}
            "super" => drop(name.pop()),
            part => name.push(part.to_owned()),
        }
    }
    Some(name)
}

/// The module in which a name is written, through those that hand it on.
fn home(name: &[String], modules: &BTreeMap<Name, Module>, steps: usize) -> Option<Name> {
    let found = (0..=name.len()).rev().find(|k| modules.contains_key(&name[..*k]))?;
    let (module, inner) = name.split_at(found);
    let handed_on = inner.first().and_then(|it| modules[module].hands_on.get(it));
    match handed_on.filter(|to| steps > 0 && ***to != *name) {
        Some(to) => home(&[to, &inner[1..]].concat(), modules, steps - 1),
        None => Some(module.to_vec()),
    }
}

/// The modules of a crate by their names.
fn modules(source: &Path) -> BTreeMap<Name, Module> {
    let mut files = Vec::new();
    rust_files(source, &mut files);
    let name = |file: &Path| -> Name {
        let inner = file.strip_prefix(source).expect("below it").with_extension("");
        let parts = inner.iter().map(|part| part.to_string_lossy().into_owned());
        parts.filter(|part| !["lib", "main", "mod"].contains(&part.as_str())).collect()
    };
    let names: BTreeSet<Name> = files.iter().map(|file| name(file)).collect();
    let mut found: BTreeMap<Name, Module> = BTreeMap::new();
    for file in &files {
        let module = name(file);
        let text = code(&std::fs::read_to_string(file).expect("a text"));
        let of = found.entry(module.clone()).or_default();
        let mut statements = Vec::new();
        for statement in text.split(';') {
            let begin = statement
                .rfind("use ")
                .filter(|at| statement[..*at].chars().next_back().is_none_or(char::is_whitespace));
            let Some(at) = begin else { continue };
            let is_public = statement[..at].trim_end().ends_with(['b', ')'])
                && statement[..at].lines().last().is_some_and(|it| it.contains("pub"));
            statements.push((is_public, statement[at + 4..].replace('\n', " ")));
        }
        let paths = statements
            .iter()
            .flat_map(|(is_public, tree)| spread(tree).into_iter().map(|path| (*is_public, path)));
        let inline = text.split(|c: char| !(c.is_alphanumeric() || "_:".contains(c)));
        // What ends in colons is before the braces of a `use`, which are spread above.
        let inline = inline.filter(|it| {
            (it.starts_with("crate::") || it.starts_with("super::")) && !it.ends_with("::")
        });
        for (is_public, path) in paths.chain(inline.map(|path| (false, path.to_owned()))) {
            let Some(name) = resolved(&path, &module, &names) else { continue };
            if let Some(last) = name.last().filter(|_| is_public) {
                of.hands_on.insert(last.clone(), name.clone());
            }
            of.uses.insert(name);
        }
    }
    found
}

/// What each module uses, but for those above and below it.
fn edges(modules: &BTreeMap<Name, Module>) -> BTreeMap<&Name, BTreeSet<Name>> {
    let related = |a: &Name, b: &Name| a.starts_with(b) || b.starts_with(a);
    let of = |(name, module): (_, &Module)| {
        let homes = module.uses.iter().filter_map(|it| home(it, modules, modules.len()));
        (name, homes.filter(|it| !related(it, name)).collect())
    };
    modules.iter().map(of).collect()
}

/// Modules of which each uses, at last, itself.
fn circle(edges: &BTreeMap<&Name, BTreeSet<Name>>) -> Vec<String> {
    let mut open: BTreeSet<&Name> = edges.keys().copied().collect();
    // What uses nothing that is open, and what nothing open uses, is in no circle.
    loop {
        let uses = |name: &Name| edges[name].iter().any(|it| open.contains(it));
        let used = |name: &Name| open.iter().any(|it| edges[*it].contains(name));
        let next: BTreeSet<&Name> =
            open.iter().copied().filter(|name| uses(name) && used(name)).collect();
        if next.len() == open.len() {
            return open.into_iter().map(|name| name.join("::")).collect();
        }
        open = next;
    }
}

#[test]
fn no_files_of_a_crate_use_each_other_in_a_circle() {
    let paths = spread("a::{b, c::{self, D as E}}");
    assert_eq!(paths, ["a::b", "a::c::self", "a::c::D"]);
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let manifest = std::fs::read_to_string(root.join("Cargo.toml")).expect("a manifest");
    let manifest: toml::Table = manifest.parse().expect("it is TOML");
    let members = manifest["workspace"]["members"].as_array().expect("a list").clone();
    for folder in members.iter().filter_map(|it| it.as_str()).chain(["."]) {
        let modules = modules(&root.join(folder).join("src"));
        assert!(modules.values().any(|it| !it.uses.is_empty()) || modules.len() == 1, "{folder}");
        assert_eq!(circle(&edges(&modules)), Vec::<String>::new(), "{folder}");
    }
}
