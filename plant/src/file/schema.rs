//! The JSON Schema of the drive file, from which editors complete keys.
//!
//! The tables come from the structs that read the file, the effects from the registry, units,
//! ranges and descriptions of numbers from [`crate::parameters`]: no list is written twice.

use std::borrow::Cow;

use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde_json::{Map, Value, json};

use super::curve::{BALANCES, LEARNED, factors, overs};
use super::custom::{CUSTOM, targets};
use super::layout::{EffectTable, Layout, NoiseTable};
use crate::drive::{Field, Motion, NoiseData, fields};
use crate::effects::law::Parameter;
use crate::effects::learned::{FEWEST_KNOTS, MOST_KNOTS};
use crate::effects::registry::{Entry, REGISTRY};
use crate::units::for_motion;

/// The JSON Schema of the drive file, indented; draft 7, which the TOML editors read.
pub fn schema_json() -> String {
    format!("{:#}\n", schema())
}

fn schema() -> Value {
    let settings = SchemaSettings::draft07().with(|settings| settings.inline_subschemas = true);
    let mut schema = settings.into_generator().into_root_schema_for::<Layout>().to_value();
    without_null(&mut schema);
    for field in fields() {
        let section = &mut schema["properties"][field.section]["properties"];
        if let Some(Value::Object(number)) = section.get_mut(field.key) {
            describe(number, field);
            // The other name of a linear drive is the same number.
            let same = Value::Object(number.clone());
            section[field.key(Motion::Linear)] = same;
        }
    }
    schema
}

/// Takes `null` out of a JSON Schema of a TOML file, which has none: what is optional is left out.
pub fn without_null(schema: &mut Value) {
    match schema {
        Value::Object(map) => {
            if let Some(Value::Array(types)) = map.get_mut("type") {
                types.retain(|one| one != "null");
                if let [only] = &types[..] {
                    map["type"] = only.clone();
                }
            }
            for key in ["enum", "anyOf"] {
                if let Some(Value::Array(choices)) = map.get_mut(key) {
                    choices.retain(|one| !one.is_null() && one["type"] != "null");
                }
            }
            if let Some(Value::Array(choices)) = map.get("anyOf")
                && let [Value::Object(only)] = &choices[..]
            {
                let only = only.clone();
                map.remove("anyOf");
                map.extend(only);
            }
            map.values_mut().for_each(without_null);
        }
        Value::Array(all) => all.iter_mut().for_each(without_null),
        _ => {}
    }
}

fn describe(number: &mut Map<String, Value>, field: &Field) {
    number.remove("format");
    number.remove("default");
    number.extend(numeric(field.description, field.unit, field.range));
}

/// What is known of a number, in the words of JSON Schema.
fn numeric(description: &str, unit: &str, (low, high): (f64, f64)) -> Map<String, Value> {
    let mut of = Map::new();
    let linear = for_motion(Motion::Linear, unit);
    let units = if linear == unit { linear } else { format!("{unit}; linear: {linear}") };
    of.insert("description".to_owned(), json!(format!("{description} [{units}]")));
    if low == f64::MIN_POSITIVE {
        of.insert("exclusiveMinimum".to_owned(), json!(0.0));
    } else if low.is_finite() {
        of.insert("minimum".to_owned(), json!(low));
    }
    if high.is_finite() {
        of.insert("maximum".to_owned(), json!(high));
    }
    of
}

impl JsonSchema for NoiseTable {
    fn schema_name() -> Cow<'static, str> {
        NoiseData::schema_name()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        NoiseData::json_schema(generator)
    }
}

impl JsonSchema for EffectTable {
    fn schema_name() -> Cow<'static, str> {
        "Effect".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let kinds: Vec<Value> =
            REGISTRY.iter().map(registered).chain([custom(), learned()]).collect();
        let mut schema = Schema::default();
        schema.insert("oneOf".to_owned(), Value::Array(kinds));
        schema
    }
}

fn table(kind: &str, description: &str, mut keys: Map<String, Value>, needed: &[&str]) -> Value {
    keys.insert("kind".to_owned(), json!({ "const": kind, "description": description }));
    let id = json!({
        "type": "string",
        "pattern": "^[A-Za-z_][A-Za-z0-9_]*$",
        "description": "its name where several effects share a kind"
    });
    keys.insert("id".to_owned(), id);
    let required = [&["kind"], needed].concat();
    json!({
        "type": "object", "title": kind, "description": description, "properties": keys,
        "required": required, "additionalProperties": false
    })
}

fn registered(entry: &Entry) -> Value {
    let number = |parameter: &Parameter| {
        let mut of = numeric(parameter.description, parameter.unit, parameter.range);
        of.insert("type".to_owned(), json!("number"));
        (parameter.name.to_owned(), Value::Object(of))
    };
    let needed: Vec<_> = entry.parameters.iter().map(|parameter| parameter.name).collect();
    table(entry.info.id, entry.info.law, entry.parameters.iter().map(number).collect(), &needed)
}

fn custom() -> Value {
    let targets = targets(Motion::Linear);
    let law = json!({
        "type": "string",
        "description": "a law of i, omega (v), theta (x), u, t and the parameters"
    });
    let mut keys: Map<String, Value> =
        targets.iter().map(|(key, _)| ((*key).to_owned(), law.clone())).collect();
    let coefficients = json!({
        "type": "object",
        "additionalProperties": { "type": "number" },
        "description": "coefficients of the law by name"
    });
    keys.insert("parameters".to_owned(), coefficients);
    let mut table = table(CUSTOM, "a law of one's own; exactly one of its targets", keys, &[]);
    let one: Vec<Value> = targets.iter().map(|(key, _)| json!({ "required": [key] })).collect();
    table["oneOf"] = Value::Array(one);
    table
}

fn learned() -> Value {
    let words = |names: Vec<&str>, description: &str| json!({ "type": "string", "enum": names, "description": description });
    let list = |description: &str| {
        json!({
            "type": "array", "items": { "type": "number" }, "description": description,
            "minItems": FEWEST_KNOTS, "maxItems": MOST_KNOTS
        })
    };
    let balances = BALANCES.iter().map(|(name, _)| *name).collect();
    let variables = overs(Motion::Linear).iter().map(|(name, _)| *name).collect();
    let factors = factors(Motion::Linear).iter().map(|(name, _)| *name).collect();
    let keys = [
        ("balance", words(balances, "what the curve gives")),
        ("over", words(variables, "what it goes over")),
        ("times", words(factors, "what multiplies it; the sign of the motion only a torque")),
        ("knots", list("where its values stand, increasing")),
        ("values", list("its values at the knots, in the direction of u or of the motor torque")),
    ];
    let keys = keys.into_iter().map(|(key, value)| (key.to_owned(), value)).collect();
    let needed = ["balance", "over", "knots", "values"];
    table(LEARNED, "a curve over one variable", keys, &needed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{DR300, EMPS};

    /// What the schema's words, as far as this schema uses them, say against the value.
    fn against(schema: &Value, value: &Value) -> Option<String> {
        let typed = match schema["type"].as_str() {
            Some("object") => value.is_object(),
            Some("array") => value.is_array(),
            Some("string") => value.is_string(),
            Some("number") => value.is_number(),
            Some("integer") => value.is_i64(),
            Some("boolean") => value.is_boolean(),
            _ => true,
        };
        let at_least = |word: &str| schema[word].as_f64().unwrap_or(f64::NEG_INFINITY);
        let number = value.as_f64().unwrap_or(f64::MAX);
        let fits = typed
            && schema.get("const").is_none_or(|only| only == value)
            && schema["enum"].as_array().is_none_or(|words| words.contains(value))
            && number >= at_least("minimum")
            && number > at_least("exclusiveMinimum");
        let chosen = |word: &str| {
            let choices = schema[word].as_array()?;
            Some(choices.iter().filter(|choice| against(choice, value).is_none()).count())
        };
        if !fits || chosen("oneOf").is_some_and(|n| n != 1) || chosen("anyOf") == Some(0) {
            return Some(format!("{value} against {schema}"));
        }
        let needed = schema["required"].as_array().into_iter().flatten().filter_map(Value::as_str);
        if let Some(key) = needed.into_iter().find(|key| value.get(key).is_none()) {
            return Some(format!("{key} is missing"));
        }
        let items = value.as_array().into_iter().flatten();
        let item = items.filter_map(|item| against(&schema["items"], item)).next();
        let below = value.as_object().into_iter().flatten();
        item.or_else(|| {
            below
                .filter_map(|(key, value)| match schema["properties"].get(key) {
                    Some(one) => against(one, value),
                    None if schema["additionalProperties"] == false => {
                        Some(format!("unknown {key}"))
                    }
                    None => against(&schema["additionalProperties"], value),
                })
                .next()
        })
    }

    fn of(text: &str) -> Value {
        toml::from_str(text).expect("TOML")
    }

    #[test]
    fn shipped_drives_fit_the_schema_and_mistakes_do_not() {
        let schema = schema();
        for text in [DR300, EMPS] {
            assert_eq!(against(&schema, &of(text)), None);
        }
        for (line, by) in [
            ("R = 3.13", "r = 3.13"),
            ("R = 3.13", "R = 0"),
            ("R = 3.13", "R = \"3\""),
            ("schema = 1", "schema = 2"),
            ("motion = \"rotary\"", "motion = \"round\""),
            ("J = 8.2e-5", ""),
            ("kind = \"coulomb\"", "kind = \"colomb\""),
            ("kind = \"coulomb\"", "kind = \"custom\""),
            ("T_c = 0.016", "T_c = -1"),
            ("T_b = 0.008", ""),
            ("period = 0.005", "period = 0"),
            ("tacho_unit = \"rpm\"", "tacho_unit = \"deg\""),
        ] {
            let text = DR300.replacen(line, by, 1);
            assert_ne!(text, DR300, "{line}");
            assert!(against(&schema, &of(&text)).is_some(), "{by}");
        }
    }

    /// The words of every effect and number are there for the editor to show.
    #[test]
    fn everything_that_is_registered_is_described() {
        let schema = schema();
        let effects = schema["properties"]["effect"]["items"]["oneOf"].as_array().expect("kinds");
        assert_eq!(effects.len(), REGISTRY.len() + 2);
        for (entry, effect) in REGISTRY.iter().zip(effects) {
            assert_eq!(effect["properties"]["kind"]["const"], entry.info.id);
            for parameter in entry.parameters {
                let text = effect["properties"][parameter.name]["description"].as_str();
                assert!(text.is_some_and(|text| text.starts_with(parameter.description)));
            }
        }
        for field in fields() {
            let number = &schema["properties"][field.section]["properties"][field.key];
            let text = number["description"].as_str();
            assert!(text.is_some_and(|text| text.starts_with(field.description)), "{}", field.key);
        }
        assert!(!schema_json().contains("null"), "TOML has no null");
    }
}
