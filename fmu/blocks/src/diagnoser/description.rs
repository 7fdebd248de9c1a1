//! The model description of a diagnoser.

use drivescope_diagnoser::Diagnoser;
use drivescope_fmu::description::{
    Capabilities, Causality, DefaultExperiment, ModelDescription, Structure, Type, Unknown,
    Variability, Variable,
};
use drivescope_monitor::State;

use super::layout::{BITS, Layout, Of, Part};

/// Length of the default experiment, s.
const STOP_S: f64 = 20.0;
/// Tolerance of the default experiment: nothing is integrated.
const TOLERANCE: f64 = 1e-6;
/// Names of the bank's sensors.
const SENSORS: [&str; 3] = ["speed", "current", "voltage"];

/// The model description; without a stored baseline a bank learns for so long.
pub(super) fn describe(
    diagnoser: &Diagnoser,
    layout: &Layout,
    learns_for: Option<f64>,
) -> ModelDescription {
    let output = &diagnoser.interface.output.name;
    let machine = match learns_for {
        Some(s) => format!(", machine learned from the first {s} s"),
        None => String::new(),
    };
    let variables: Vec<Variable> = layout
        .of
        .iter()
        .enumerate()
        .map(|(k, of)| variable(k as u32 + 1, *of, diagnoser, layout))
        .collect();
    let outputs = variables.iter().filter(|it| it.causality == Causality::Output);
    let unknowns: Vec<Unknown> =
        outputs.map(|it| Unknown { reference: it.reference, dependencies: Vec::new() }).collect();
    ModelDescription {
        name: format!("Diagnoser of {output}"),
        identifier: "drivescope_diagnoser".to_owned(),
        description: format!("Watches {output}: {}{machine}", layout.asked.label()),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        generation_tool: concat!("drivescope ", env!("CARGO_PKG_VERSION")).to_owned(),
        capabilities: Capabilities {
            co_simulation: true,
            model_exchange: false,
            directional_derivatives: false,
            variable_step: true,
        },
        variables,
        structure: Structure {
            outputs: unknowns.clone(),
            initial_unknowns: unknowns,
            ..Structure::default()
        },
        default_experiment: DefaultExperiment {
            start: Some(0.0),
            stop: Some(STOP_S),
            tolerance: Some(TOLERANCE),
            step: Some(diagnoser.interface.period_s),
        },
    }
}

/// Name, description, unit and type of a variable.
struct Described {
    name: String,
    description: String,
    unit: String,
    kind: Type,
}

fn described(
    name: impl Into<String>,
    description: impl Into<String>,
    unit: &str,
    kind: Type,
) -> Described {
    Described { name: name.into(), description: description.into(), unit: unit.to_owned(), kind }
}

fn variable(reference: u32, of: Of, diagnoser: &Diagnoser, layout: &Layout) -> Variable {
    let Described { name, description, unit, kind } = described_of(of, diagnoser, layout);
    let (causality, variability, start) = match of {
        Of::Signal(_) => (Causality::Input, Variability::Discrete, Some(0.0)),
        Of::Valid => (Causality::Input, Variability::Discrete, Some(1.0)),
        Of::Beta => (Causality::Parameter, Variability::Fixed, Some(diagnoser.confidence.beta())),
        Of::HasCurrent => (Causality::Parameter, Variability::Fixed, Some(1.0)),
        _ => (Causality::Output, Variability::Discrete, None),
    };
    let mut variable =
        Variable::new(reference, name, causality, variability).described(description);
    variable.kind = kind;
    variable.start = start;
    if of == Of::Beta {
        (variable.min, variable.max) = (Some(f64::MIN_POSITIVE), Some(1.0 - f64::EPSILON));
    }
    if unit.is_empty() {
        return variable;
    }
    // A unit that the standard cannot express is left out, never guessed.
    variable.clone().in_unit(&unit).unwrap_or(variable)
}

/// `1 tacho, 2 flux`: faults by their codes.
fn codes(layout: &Layout) -> String {
    let named = layout.faults.iter().enumerate().map(|(k, name)| {
        let unit = layout.units.get(k).map_or("", String::as_str);
        let unit =
            if unit.is_empty() || unit == "1" { String::new() } else { format!(" [{unit}]") };
        format!("{} {name}{unit}", k + 1)
    });
    named.collect::<Vec<_>>().join(", ")
}

fn described_of(of: Of, diagnoser: &Diagnoser, layout: &Layout) -> Described {
    let output = &diagnoser.interface.output;
    let (real, integer, boolean) = (Type::Float64, Type::Int32, Type::Boolean);
    match of {
        Of::Signal(k) => {
            let (name, unit) = &layout.signals[k];
            described(name, format!("{name} as it is measured"), unit, real)
        }
        Of::Valid => {
            described("valid", "Whether the signals hold a row; false: it was lost", "", boolean)
        }
        Of::Beta => described(
            "beta",
            "Share of healthy samples outside the bands of the detectors",
            "",
            real,
        ),
        Of::HasCurrent => {
            let current = layout.current.map_or("", |at| &layout.signals[at].0);
            let name = format!("has_{current}");
            described(
                name,
                format!("Whether {current} is measured; false: it is ignored"),
                "",
                boolean,
            )
        }
        Of::Rows => {
            described("rows", "Rows taken so far; all outputs are those of the last", "", integer)
        }
        Of::RowTime => described("row_time", "Time of the last row", "s", real),
        Of::Decision => {
            let codes = State::ALL.map(|(state, means)| format!("{} {means}", state.code()));
            described("decision", format!("Decision: {}", codes.join(", ")), "", integer)
        }
        Of::Declared => described("declared", "Whether a fault stands declared", "", boolean),
        Of::Alarms => described("alarms", "Faults declared so far", "", integer),
        Of::Mechanism => {
            let codes = codes(layout);
            let codes = if codes.is_empty() { codes } else { format!(", {codes}") };
            described(
                "mechanism",
                format!("What failed: 0 nothing, -1 unknown{codes}"),
                "",
                integer,
            )
        }
        Of::Set => {
            let text = format!(
                "What it cannot be told from, itself included: bit k - 1 for code k up to {BITS}"
            );
            described("set", text, "", integer)
        }
        Of::Size => described(
            "size",
            "Size of the fault, a fraction or in the unit of its mechanism; 0 where none is told",
            "",
            real,
        ),
        Of::Lower => {
            described("size_lower", "Lower end of the 95 % interval of the size", "", real)
        }
        Of::Upper => {
            described("size_upper", "Upper end of the 95 % interval of the size", "", real)
        }
        Of::Onset => described("onset", "First faulty sample of the fault that stands", "s", real),
        Of::Noticed => described("noticed", "When it was noticed", "s", real),
        Of::Detector(method, part) => {
            let label = method.label();
            let (name, text, unit, kind) = match part {
                Part::Residual => ("residual", "residual", &*output.unit, real),
                Part::Lower => ("lower", "lower bound of a healthy residual", &*output.unit, real),
                Part::Upper => ("upper", "upper bound of a healthy residual", &*output.unit, real),
                Part::Outside => ("outside", "whether the residual lies outside", "", boolean),
                Part::Declared => ("declared", "whether a fault stands declared", "", boolean),
            };
            described(format!("{}.{name}", method.id()), format!("{label}: {text}"), unit, kind)
        }
        Of::Innovation(sensor, part) => {
            let sensor = SENSORS[sensor];
            let (name, text) = match part {
                Part::Lower => ("lower", "lower bound of 95 % of healthy ones"),
                Part::Upper => ("upper", "upper bound of 95 % of healthy ones"),
                _ => ("residual", "shown less predicted, in standard deviations"),
            };
            described(format!("bank.{sensor}.{name}"), format!("Bank, {sensor}: {text}"), "", real)
        }
        Of::Ratio => {
            described("bank.ratio", "Bank: likelihood ratio of the likeliest fault", "", real)
        }
        Of::RatioLimit => described("bank.ratio_limit", "Bank: its limit", "", real),
        Of::Squares => described("bank.squares", "Bank: cumulative sum of squares", "", real),
        Of::SquaresLimit => described("bank.squares_limit", "Bank: its limit", "", real),
    }
}
