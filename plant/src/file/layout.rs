//! The drive file as serde and the schema see it: tables and keys, without the rules between
//! them. The sections of numbers are declared in `drive/sections.rs`.

use std::collections::BTreeMap;
use std::fmt;

use schemars::JsonSchema;
use serde::de::{self, MapAccess, SeqAccess, Visitor};
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::drive::{
    AmplifierData, ControllerData, GeneratorData, Motion, MotorData, NoiseData, SensorData,
};

/// A drive file: SI units throughout.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table", rename = "Drive")]
pub(super) struct Layout {
    /// Version of the format: 1.
    #[serde(default = "first")]
    #[schemars(extend("const" = 1))]
    pub(super) schema: i64,
    /// A name for people.
    #[serde(default)]
    pub(super) name: String,
    /// Whether the drive turns or slides.
    #[serde(default = "motion")]
    pub(super) motion: Motion,
    /// The motor.
    pub(super) motor: MotorData,
    /// The physical effects besides the motor's linear balances.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) effect: Vec<EffectTable>,
    /// PI speed control.
    pub(super) controller: Option<ControllerData>,
    /// Power amplifier from the control signal C_m to u; without it u = C_m.
    pub(super) amplifier: Option<AmplifierData>,
    /// Second motor as a generator: a load torque that a current sets.
    pub(super) generator: Option<GeneratorData>,
    /// Resolution of the sensors.
    pub(super) sensors: Option<SensorData>,
    /// Known standard deviations of the noise.
    pub(super) noise: Option<NoiseTable>,
    /// What a fit does with the parameters.
    pub(super) fit: Option<FitTable>,
    /// Where values come from, by parameter name (`R`, `coulomb.T_c`, `noise.omega`).
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub(super) origin: BTreeMap<String, Origin>,
}

fn first() -> i64 {
    1
}

fn motion() -> Motion {
    Motion::Rotary
}

#[derive(Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct FitTable {
    /// Parameters that a fit leaves as they are.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) fixed: Vec<String>,
    /// Parameters that may differ from recording to recording.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) per_recording: Vec<String>,
}

/// The noise: read under the names of either motion, written under those of the drive's.
#[derive(Debug)]
pub(super) enum NoiseTable {
    Read(NoiseData),
    Written(Vec<(&'static str, f64)>),
}

/// One `[[effect]]`: which keys it takes depends on its kind, and is checked with the registry.
#[derive(Debug)]
pub(super) struct EffectTable(pub(super) Vec<(String, EffectValue)>);

/// A value in an effect: a number, a text, the knots or values of a curve, or the coefficients of
/// a typed law.
#[derive(Debug)]
pub(super) enum EffectValue {
    Number(f64),
    Text(String),
    List(Vec<f64>),
    Coefficients(Vec<(String, f64)>),
}

/// The origin of a value, or of the values below a name (`coulomb.T_c` without quotes).
#[derive(Debug, Serialize, JsonSchema)]
#[serde(untagged)]
pub(super) enum Origin {
    Text(String),
    Below(BTreeMap<String, String>),
}

/// Collects a table in the order of the file.
struct Ordered<T>(std::marker::PhantomData<T>);

impl<'de, T: Deserialize<'de>> Visitor<'de> for Ordered<T> {
    type Value = Vec<(String, T)>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a table")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let mut entries = Vec::new();
        while let Some(entry) = map.next_entry()? {
            entries.push(entry);
        }
        Ok(entries)
    }
}

impl<'de> Deserialize<'de> for EffectTable {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(Ordered(std::marker::PhantomData)).map(Self)
    }
}

impl<'de> Deserialize<'de> for EffectValue {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Any;
        impl<'de> Visitor<'de> for Any {
            type Value = EffectValue;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number, a text in quotes, or a list or a table of numbers")
            }

            fn visit_f64<E: de::Error>(self, value: f64) -> Result<EffectValue, E> {
                Ok(EffectValue::Number(value))
            }

            fn visit_i64<E: de::Error>(self, value: i64) -> Result<EffectValue, E> {
                Ok(EffectValue::Number(value as f64))
            }

            fn visit_str<E: de::Error>(self, value: &str) -> Result<EffectValue, E> {
                Ok(EffectValue::Text(value.to_owned()))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut all: A) -> Result<EffectValue, A::Error> {
                let mut list = Vec::new();
                while let Some(number) = all.next_element()? {
                    list.push(number);
                }
                Ok(EffectValue::List(list))
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<EffectValue, A::Error> {
                Ordered(std::marker::PhantomData).visit_map(map).map(EffectValue::Coefficients)
            }
        }
        deserializer.deserialize_any(Any)
    }
}

impl<'de> Deserialize<'de> for Origin {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Any;
        impl<'de> Visitor<'de> for Any {
            type Value = Origin;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a text in quotes")
            }

            fn visit_str<E: de::Error>(self, value: &str) -> Result<Origin, E> {
                Ok(Origin::Text(value.to_owned()))
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Origin, A::Error> {
                let all = Ordered(std::marker::PhantomData).visit_map(map)?;
                Ok(Origin::Below(all.into_iter().collect()))
            }
        }
        deserializer.deserialize_any(Any)
    }
}

impl<'de> Deserialize<'de> for NoiseTable {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        NoiseData::deserialize(deserializer).map(Self::Read)
    }
}

impl Serialize for NoiseTable {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Read(noise) => noise.serialize(serializer),
            Self::Written(numbers) => serializer.collect_map(numbers.iter().copied()),
        }
    }
}

impl Serialize for EffectTable {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(key, value)| (key, value)))
    }
}

impl Serialize for EffectValue {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Number(value) => serializer.serialize_f64(*value),
            Self::Text(text) => serializer.serialize_str(text),
            Self::List(all) => serializer.collect_seq(all),
            Self::Coefficients(all) => {
                let mut map = serializer.serialize_map(Some(all.len()))?;
                for (name, value) in all {
                    map.serialize_entry(name, value)?;
                }
                map.end()
            }
        }
    }
}
