//! Names and numbers out of the JSON of results, whatever is there.

use drivescope_scenarios::results::DetectorKind;
use serde_json::Value;

use crate::report::page::minus;
use crate::report::words::number;

/// A word of a key.
pub(super) fn text<'a>(value: &'a Value, key: &str) -> &'a str {
    value.get(key).and_then(Value::as_str).unwrap_or_default()
}

/// The list of a key.
pub(super) fn rows<'a>(value: &'a Value, key: &str) -> &'a [Value] {
    value.get(key).and_then(Value::as_array).map_or(&[], Vec::as_slice)
}

/// A fault in words: `tacho +5 %`.
pub(super) fn fault(of: &Value) -> String {
    let size = of
        .get("size")
        .and_then(Value::as_f64)
        .map_or(String::new(), |size| format!(" {:+} %", (size * 1e4).round() / 100.0));
    minus(&format!("{}{size}", text(of, "kind").replace('_', " ")))
}

/// Values of a key, each once, in the order in which they come.
pub(super) fn distinct<'a>(rows: &'a [Value], key: &str) -> Vec<&'a Value> {
    let mut all: Vec<&Value> = Vec::new();
    for value in rows.iter().filter_map(|row| row.get(key)) {
        if !all.contains(&value) {
            all.push(value);
        }
    }
    all
}

/// A word of a section.
pub(super) fn word_of<'a>(results: &'a Value, section: &str, key: &str) -> &'a str {
    results.get(section).map_or("", |it| text(it, key))
}

/// What people call a method; one that nobody knows by its name in the results.
pub(super) fn name_of(method: &Value) -> String {
    if let Some(known) = method.as_str().and_then(DetectorKind::find) {
        return known.label().to_owned();
    }
    method.as_str().map_or_else(|| method.to_string(), |name| name.replace('_', " "))
}

/// A number or a word as text; a dash for what is not there.
pub(super) fn scalar(value: Option<&Value>) -> String {
    match value {
        None | Some(Value::Null) => "\u{2013}".to_owned(),
        Some(Value::String(text)) => text.clone(),
        Some(Value::Number(it)) if it.is_f64() => minus(&number(it.as_f64().unwrap_or(f64::NAN))),
        Some(Value::Array(ends)) => {
            ends.iter().map(|end| scalar(Some(end))).collect::<Vec<_>>().join(" to ")
        }
        Some(Value::Object(of)) if of.contains_key("kind") => value.map(fault).unwrap_or_default(),
        Some(other) => other.to_string(),
    }
}
