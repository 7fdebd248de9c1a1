//! The JSON Schema of the drive file, from which editors complete keys.
//!
//! The tables come from the structs that read the file, the effects from the registry, units,
//! ranges and descriptions of numbers from [`crate::parameters`]: no list is written twice.

use std::borrow::Cow;

use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde_json::{Map, Value, json};

use super::effects::{CUSTOM, targets};
use super::layout::{EffectTable, Layout};
use crate::drive::Motion;
use crate::effects::law::Parameter;
use crate::effects::registry::{Entry, REGISTRY};
use crate::parameters::{FIELDS, Field};
use crate::units::{for_motion, name_for_motion};

/// The JSON Schema of the drive file, indented; draft 7, which the TOML editors read.
pub fn schema_json() -> String {
    format!("{:#}\n", schema())
}

fn schema() -> Value {
    let settings = SchemaSettings::draft07().with(|settings| settings.inline_subschemas = true);
    let mut schema = settings.into_generator().into_root_schema_for::<Layout>().to_value();
    without_null(&mut schema);
    for field in FIELDS {
        let keys = [field.key, linear(field.key)];
        for key in &keys[..if keys[0] == keys[1] { 1 } else { 2 }] {
            let section = &mut schema["properties"][field.section]["properties"];
            if let Some(Value::Object(number)) = section.get_mut(*key) {
                describe(number, field);
            }
        }
    }
    schema
}

fn linear(key: &'static str) -> &'static str {
    if matches!(key, "omega" | "theta") { name_for_motion(Motion::Linear, key) } else { key }
}

/// TOML has no null: what is optional is left out.
fn without_null(schema: &mut Value) {
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

impl JsonSchema for EffectTable {
    fn schema_name() -> Cow<'static, str> {
        "Effect".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let kinds: Vec<Value> = REGISTRY.iter().map(registered).chain([custom()]).collect();
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
