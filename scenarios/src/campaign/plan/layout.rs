//! The plan file as serde and the schema see it: tables and keys, without the rules between them.

use std::collections::BTreeMap;
use std::fmt;

use schemars::JsonSchema;
use serde::de::value::MapAccessDeserializer;
use serde::de::{self, MapAccess, Visitor};
use serde::{Deserialize, Deserializer};
use toml::Spanned;

/// A plan of a campaign: which scenarios there are. Numbers are SI.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table", rename = "Plan")]
pub(super) struct Layout {
    /// Version of the format: 1.
    #[schemars(with = "i64", extend("const" = 1))]
    pub(super) schema: Spanned<i64>,
    /// A name for people.
    #[serde(default)]
    pub(super) name: String,
    /// The drive: a file, beside the plan or by its whole path, or the name of a built-in one.
    #[schemars(with = "String")]
    pub(super) drive: Spanned<String>,
    /// An FMU of any tool that is the machine in place of the drive, beside the plan or by its whole path:
    /// the closed loop, with the inputs and outputs of an exported drive. The drive then gives sampling
    /// time, set point and noise, and is what the detectors are designed on.
    #[schemars(with = "Option<String>")]
    pub(super) fmu: Option<Spanned<String>>,
    /// How long a scenario of the FMU may take, s; what takes longer is given up. 60 if absent.
    #[schemars(with = "Option<f64>", range(min = 0, max = 1e6))]
    pub(super) fmu_time_limit: Option<Spanned<f64>>,
    /// Names that the FMU has for variables of an exported drive, where they differ.
    #[serde(default)]
    #[schemars(with = "BTreeMap<String, String>")]
    pub(super) fmu_variables: BTreeMap<Spanned<String>, Spanned<String>>,
    /// Seed of all that is drawn.
    #[serde(default = "first")]
    pub(super) seed: u64,
    /// Scenarios drawn at each point of the grid.
    #[schemars(with = "u64", range(min = 1))]
    pub(super) draws: Spanned<u64>,
    /// Length of a scenario, s.
    #[schemars(with = "f64")]
    pub(super) duration: Spanned<f64>,
    /// Share of the scenarios whose signals are kept.
    #[schemars(with = "Option<f64>", range(min = 0, max = 1))]
    pub(super) keep_traces: Option<Spanned<f64>>,
    /// Speed that the controller follows, rad/s (m/s); by default that of the study.
    #[schemars(with = "Option<Given>")]
    pub(super) set_point: Option<Spanned<Given>>,
    /// Number of the noise: scenarios of one number have the same; by default each has its own.
    #[schemars(with = "Option<Given>")]
    pub(super) noise_seed: Option<Spanned<Given>>,
    /// Parameters of the drive that differ from its file, by name (`R`, `coulomb.T_c`, `noise.i`).
    #[serde(default)]
    #[schemars(with = "BTreeMap<String, Given>")]
    pub(super) parameters: BTreeMap<Spanned<String>, Spanned<Given>>,
    /// Faults; those of one scenario act together.
    #[serde(default)]
    #[schemars(with = "Vec<FaultTable>")]
    pub(super) fault: Vec<Spanned<FaultTable>>,
    /// Detectors that watch every scenario.
    #[serde(default)]
    pub(super) detector: DetectorTable,
    /// How the detectors are designed, on healthy runs of the nominal drive.
    #[serde(default)]
    pub(super) design: DesignTable,
}

fn first() -> u64 {
    1
}

/// One fault.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct FaultTable {
    /// What fails; `none` for health.
    #[schemars(with = "GivenWords")]
    pub(super) kind: Spanned<GivenWords>,
    /// Its size: a fraction, or in the unit of the mechanism.
    #[schemars(with = "Given")]
    pub(super) size: Spanned<Given>,
    /// When it begins, s.
    #[schemars(with = "Given")]
    pub(super) onset: Spanned<Given>,
    /// How long it lasts, s; to the end of the run if absent.
    #[schemars(with = "Option<Given>")]
    pub(super) duration: Option<Spanned<Given>>,
    /// How it goes with time: `step`, `ramp=5`, `pulses=0.1/1`, `intermittent=0.5/2`.
    #[schemars(with = "Option<GivenWords>")]
    pub(super) profile: Option<Spanned<GivenWords>>,
    /// Share of the scenarios that have it.
    #[schemars(with = "Option<f64>", range(min = 0, max = 1))]
    pub(super) probability: Option<Spanned<f64>>,
}

/// Detectors.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct DetectorTable {
    /// Which of `constant`, `bands`, `cusum`, `bank`; all but the bank by default.
    #[schemars(with = "Option<Vec<String>>")]
    pub(super) methods: Option<Spanned<Vec<Spanned<String>>>>,
    /// Share of healthy samples outside constant thresholds and bands.
    #[schemars(with = "Option<Given>")]
    pub(super) beta: Option<Spanned<Given>>,
    /// Exceedances in a row that declare a fault.
    #[schemars(with = "Option<Given>")]
    pub(super) window: Option<Spanned<Given>>,
    /// Mean samples between false alarms that CUSUM and bank are designed for.
    #[schemars(with = "Option<Given>")]
    pub(super) arl_0: Option<Spanned<Given>>,
    /// Drift of the CUSUM, in standard deviations of the innovations.
    #[schemars(with = "Option<Given>")]
    pub(super) kappa: Option<Spanned<Given>>,
    /// Time at the start of a scenario that is not judged, s; the bank learns the machine at its end.
    #[schemars(with = "Option<f64>")]
    pub(super) run_up: Option<Spanned<f64>>,
}

/// The design of the detectors.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct DesignTable {
    /// Seed of the healthy runs; by default one more than the plan's.
    #[schemars(with = "Option<u64>")]
    pub(super) seed: Option<Spanned<u64>>,
    /// Healthy samples that widths are measured on.
    #[schemars(with = "Option<u64>")]
    pub(super) samples: Option<Spanned<u64>>,
}

/// A number that may differ from scenario to scenario.
#[derive(Debug, Clone, JsonSchema)]
#[serde(untagged)]
pub(super) enum Given {
    /// The same in all.
    Number(f64),
    /// Drawn, or on a grid.
    Table(GivenTable),
}

/// How a number is chosen: one of `grid`, `from` to `to` in `steps`, `choice`, `uniform`,
/// `log_uniform` and `normal`.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a number or a table")]
pub(super) struct GivenTable {
    /// Every value of the list, with every value of other grids.
    pub(super) grid: Option<Vec<f64>>,
    /// First value of a regular grid.
    pub(super) from: Option<f64>,
    /// Last value of it.
    pub(super) to: Option<f64>,
    /// Number of its values.
    pub(super) steps: Option<u32>,
    /// Whether its values have equal ratios, not equal differences.
    #[serde(default)]
    pub(super) logarithmic: bool,
    /// Drawn from the list.
    pub(super) choice: Option<Vec<f64>>,
    /// Drawn between two values.
    pub(super) uniform: Option<[f64; 2]>,
    /// Drawn between two values, its logarithm uniform.
    pub(super) log_uniform: Option<[f64; 2]>,
    /// Mean and standard deviation of a normal distribution.
    pub(super) normal: Option<[f64; 2]>,
    /// Whether the value multiplies that of the drive file.
    #[serde(default)]
    pub(super) relative: bool,
    /// Whether it has either sign, each in half of the scenarios.
    #[serde(default)]
    pub(super) either_sign: bool,
}

/// A word that may differ from scenario to scenario.
#[derive(Debug, Clone, JsonSchema)]
#[serde(untagged)]
pub(super) enum GivenWords {
    /// The same in all.
    Word(String),
    /// Drawn, or on a grid.
    Table(WordsTable),
}

/// How a word is chosen: one of `grid` and `choice`.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a text or a table")]
pub(super) struct WordsTable {
    /// Every word of the list, with every value of other grids.
    pub(super) grid: Option<Vec<String>>,
    /// Drawn from the list.
    pub(super) choice: Option<Vec<String>>,
}

impl<'de> Deserialize<'de> for Given {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Read;
        impl<'de> Visitor<'de> for Read {
            type Value = Given;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "a number, or a table such as {{ uniform = [0.1, 0.3] }}")
            }

            fn visit_i64<E: de::Error>(self, value: i64) -> Result<Given, E> {
                Ok(Given::Number(value as f64))
            }

            fn visit_u64<E: de::Error>(self, value: u64) -> Result<Given, E> {
                Ok(Given::Number(value as f64))
            }

            fn visit_f64<E: de::Error>(self, value: f64) -> Result<Given, E> {
                Ok(Given::Number(value))
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Given, A::Error> {
                GivenTable::deserialize(MapAccessDeserializer::new(map)).map(Given::Table)
            }
        }
        deserializer.deserialize_any(Read)
    }
}

impl<'de> Deserialize<'de> for GivenWords {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Read;
        impl<'de> Visitor<'de> for Read {
            type Value = GivenWords;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "a text, or a table such as {{ grid = [\"tacho\", \"load\"] }}")
            }

            fn visit_str<E: de::Error>(self, word: &str) -> Result<GivenWords, E> {
                Ok(GivenWords::Word(word.to_owned()))
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<GivenWords, A::Error> {
                WordsTable::deserialize(MapAccessDeserializer::new(map)).map(GivenWords::Table)
            }
        }
        deserializer.deserialize_any(Read)
    }
}
