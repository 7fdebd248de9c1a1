//! The standard's rules for variables (FMI 2.0 section 2.2.7, FMI 3.0 section 2.4.7).

use std::collections::HashMap;

use super::description::*;
use super::finding::Finding;
use crate::vocabulary::go_together;

/// All findings about variables, in the order of the file.
pub(super) fn check(description: &Description) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut names: HashMap<&str, Position> = HashMap::new();
    let mut references: HashMap<u32, &str> = HashMap::new();
    for variable in &description.variables {
        let place = variable.place;
        let name = &variable.name;
        let mut error = |text: String| findings.push(Finding::error(place, text));
        if name.is_empty() {
            error("a variable has an empty name".to_owned());
        }
        if let Some(first) = names.insert(name, place) {
            error(format!("variable `{name}` exists twice, first in line {}", first.line));
        }
        if description.structured_names && !is_structured(name) {
            error(format!("`{name}` does not follow the structured naming convention"));
        }
        if variable.alias_of.is_some() {
            continue;
        }
        if description.fmi == Version::Three
            && let Some(other) = references.insert(variable.reference, name)
        {
            error(format!("`{name}` has value reference {}, as has `{other}`", variable.reference));
        }
        if let Some(unit) = &variable.unit
            && description.unit(unit).is_none()
        {
            error(format!("unit `{unit}` of `{name}` is not defined"));
        }
        let declared = variable.declared_type.as_ref();
        let known = |name: &String| description.types.iter().any(|t| t.name == *name);
        if let Some(declared) = declared.filter(|declared| !known(declared)) {
            error(format!("type `{declared}` of `{name}` is not defined"));
        }
        if variable.kind == Type::Enumeration && declared.is_none() {
            error(format!("the enumeration `{name}` declares no type"));
        }
        for text in combination(description, variable) {
            error(text);
        }
        for text in start(description, variable) {
            error(text);
        }
    }
    let independent: Vec<&Variable> =
        description.variables.iter().filter(|v| v.causality == Causality::Independent).collect();
    for variable in independent.iter().skip(1) {
        let text = format!("`{}` is a second independent variable", variable.name);
        findings.push(Finding::error(variable.place, text));
    }
    if independent.is_empty() && description.fmi == Version::Three {
        findings.push(Finding::error(None, "there is no independent variable"));
    }
    findings
}

/// The table of allowed combinations of causality, variability and initial.
fn combination(description: &Description, variable: &Variable) -> Vec<String> {
    use Causality as C;
    use Variability as V;
    let name = &variable.name;
    let mut texts = Vec::new();
    if variable.variability == V::Continuous && !variable.kind.is_float() {
        texts.push(format!("`{name}` is continuous, but of type {}", variable.kind.name()));
    }
    let good = go_together(variable.causality, variable.variability, variable.initial);
    if !good {
        texts.push(format!(
            "`{name}`: causality {:?}, variability {:?} and initial {:?} do not go together",
            variable.causality, variable.variability, variable.initial
        ));
    }
    let no_initial = matches!(variable.causality, C::Input | C::Independent);
    if description.fmi == Version::Two && no_initial && variable.initial_stated {
        texts.push(format!("`{name}` must not state `initial`"));
    }
    texts
}

/// Start values: there where they must be, and values of the type.
fn start(description: &Description, variable: &Variable) -> Vec<String> {
    let name = &variable.name;
    let mut texts = Vec::new();
    let stated = !variable.start.is_empty();
    let needed = matches!(variable.initial, Some(Initial::Exact | Initial::Approx));
    if needed && !stated && variable.kind != Type::Clock {
        texts.push(format!("`{name}` has no start value"));
    }
    let calculated = variable.initial == Some(Initial::Calculated);
    if stated && (calculated || variable.causality == Causality::Independent) {
        texts.push(format!("`{name}` must not have a start value"));
    }
    let elements = description.elements(variable);
    // One value may stand for all elements.
    if stated && variable.start.len() != elements && variable.start.len() != 1 {
        let count = variable.start.len();
        texts.push(format!("`{name}` has {count} start values for {elements} elements"));
    }
    for text in &variable.start {
        let Some(value) = number(variable.kind, text) else {
            let kind = variable.kind.name();
            texts.push(format!("the start value `{text}` of `{name}` is no {kind}"));
            continue;
        };
        let (min, max) = variable.range;
        if min.is_some_and(|min| value < min) || max.is_some_and(|max| value > max) {
            texts.push(format!("the start value `{text}` of `{name}` is outside its range"));
        }
    }
    if variable.nominal.is_some_and(|nominal| nominal == 0.0 || !nominal.is_finite()) {
        texts.push(format!("the nominal value of `{name}` must be finite and not zero"));
    }
    if let (Some(min), Some(max)) = variable.range
        && min > max
    {
        texts.push(format!("the range of `{name}` is empty"));
    }
    texts
}

/// A start value as a number; text types have none to check and count as 0 within any range.
fn number(kind: Type, text: &str) -> Option<f64> {
    fn whole<T: std::str::FromStr + TryInto<i128>>(text: &str) -> Option<f64> {
        text.parse::<T>().ok()?.try_into().ok().map(|value: i128| value as f64)
    }
    match kind {
        Type::Float64 | Type::Float32 => text.parse().ok(),
        Type::Int8 => whole::<i8>(text),
        Type::UInt8 => whole::<u8>(text),
        Type::Int16 => whole::<i16>(text),
        Type::UInt16 => whole::<u16>(text),
        Type::Int32 => whole::<i32>(text),
        Type::UInt32 => whole::<u32>(text),
        Type::Int64 | Type::Enumeration => whole::<i64>(text),
        Type::UInt64 => whole::<u64>(text),
        Type::Boolean => match text {
            "true" | "1" => Some(1.0),
            "false" | "0" => Some(0.0),
            _ => None,
        },
        Type::String | Type::Binary | Type::Clock => Some(0.0),
    }
}

/// The structured naming convention (FMI 2.0 section 2.2.9): `a.b[1,2].der(c,2)`, quoted names.
fn is_structured(name: &str) -> bool {
    if let Some(inner) = name.strip_prefix("der(").and_then(|rest| rest.strip_suffix(')')) {
        let (variable, order) = inner.rsplit_once(',').unwrap_or((inner, "1"));
        // A comma within the brackets of an array belongs to the name.
        return match order.parse::<u32>() {
            Ok(order) => order > 0 && is_identifier(variable),
            Err(_) => is_identifier(inner),
        };
    }
    is_identifier(name)
}

fn is_identifier(name: &str) -> bool {
    let mut rest = name;
    loop {
        rest = match part(rest) {
            Some("") => return true,
            Some(after) => match after.strip_prefix('.') {
                Some(after) => after,
                None => return false,
            },
            None => return false,
        };
    }
}

/// Takes one name with its array indices; what follows it.
fn part(text: &str) -> Option<&str> {
    let mut rest = match text.strip_prefix('\'') {
        Some(quoted) => {
            let mut escaped = false;
            let end = quoted.char_indices().find(|(_, c)| {
                let ends = *c == '\'' && !escaped;
                escaped = *c == '\\' && !escaped;
                ends
            });
            &quoted[end?.0 + 1..]
        }
        None => {
            let first = |c: char| c.is_ascii_alphabetic() || c == '_';
            let end = text.find(|c: char| !(c.is_ascii_alphanumeric() || c == '_'));
            let (name, after) = text.split_at(end.unwrap_or(text.len()));
            if !name.starts_with(first) {
                return None;
            }
            after
        }
    };
    if let Some(indices) = rest.strip_prefix('[') {
        let (inside, after) = indices.split_once(']')?;
        if !inside.split(',').all(|index| index.trim().parse::<u32>().is_ok()) {
            return None;
        }
        rest = after;
    }
    Some(rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn structured_names_are_told_from_others() {
        for good in ["x", "a.b[1,2].c", "der(x)", "der(a.b[1],2)", "'any thing'.x", "_x1"] {
            assert!(is_structured(good), "{good}");
        }
        for bad in ["", "1x", "a..b", "a.", "x[", "x[a]", "der(x,0)", "a b", "'open", "x y"] {
            assert!(!is_structured(bad), "{bad}");
        }
    }

    #[test]
    fn start_values_are_read_as_their_type() {
        assert_eq!(number(Type::Int8, "200"), None);
        assert_eq!(number(Type::UInt8, "200"), Some(200.0));
        assert_eq!(number(Type::Boolean, "yes"), None);
        assert_eq!(number(Type::Float64, "1e3"), Some(1000.0));
    }
}
