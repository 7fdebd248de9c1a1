//! `fmu info`: what an FMU says about itself.

use std::fmt::Write;
use std::path::PathBuf;

use clap::Args;
use comfy_table::{ContentArrangement, Table, presets};
use drivescope_fmu::import::{Causality, Description, Fmu, Interface, Variable};
use drivescope_recording::rounded;
use serde::Serialize;

use crate::commands::Run;
use crate::failure::{Ending, into_report};
use crate::next::Next;
use crate::session::Session;

/// Describe an FMU: interfaces, platforms, default experiment, variables.
#[derive(Debug, Args)]
pub(crate) struct Info {
    /// The FMU.
    file: PathBuf,
}

#[derive(Debug, Serialize)]
struct InfoAnswer<'a> {
    name: &'a str,
    fmi: &'a str,
    description: Option<&'a str>,
    generation_tool: Option<&'a str>,
    interfaces: Vec<String>,
    platforms: Vec<String>,
    start: Option<f64>,
    stop: Option<f64>,
    step: Option<f64>,
    tolerance: Option<f64>,
    states: usize,
    event_indicators: usize,
    variables: Vec<Shown<'a>>,
}

#[derive(Debug, Serialize)]
struct Shown<'a> {
    name: &'a str,
    causality: &'static str,
    #[serde(rename = "type")]
    kind: &'static str,
    unit: Option<&'a str>,
    start: &'a [String],
    description: Option<&'a str>,
}

impl Run for Info {
    fn run(self, session: &Session) -> miette::Result<Ending> {
        let fmu = Fmu::open(&self.file).map_err(into_report)?;
        let about = fmu.description();
        let experiment = about.default_experiment;
        let answer = InfoAnswer {
            name: &about.model_name,
            fmi: &about.fmi_version,
            description: about.description.as_deref(),
            generation_tool: about.generation_tool.as_deref(),
            interfaces: about.interfaces().iter().map(Interface::to_string).collect(),
            platforms: fmu.platforms(),
            start: experiment.start,
            stop: experiment.stop,
            step: experiment.step,
            tolerance: experiment.tolerance,
            states: about.structure.derivatives.len(),
            event_indicators: about.structure.event_indicators,
            variables: about.variables.iter().map(shown).collect(),
        };
        let next = Next::new("fmu run").files([&self.file]).options(" -o run.csv");
        session.say(&text(&answer, about), &answer, &next)?;
        Ok(Ending::Done)
    }
}

fn causality(causality: Causality) -> &'static str {
    match causality {
        Causality::StructuralParameter => "structural parameter",
        Causality::Parameter => "parameter",
        Causality::CalculatedParameter => "calculated parameter",
        Causality::Input => "input",
        Causality::Output => "output",
        Causality::Local => "local",
        Causality::Independent => "independent",
    }
}

fn shown(variable: &Variable) -> Shown<'_> {
    Shown {
        name: &variable.name,
        causality: causality(variable.causality),
        kind: variable.kind.name(),
        unit: variable.unit.as_deref(),
        start: &variable.start,
        description: variable.description.as_deref(),
    }
}

/// What an FMU can do in an interface, in words.
fn abilities(about: &Description, kind: Interface) -> String {
    let Some(can) = about.capabilities(kind) else { return String::new() };
    let named = [
        (can.state, "state saved and restored"),
        (can.serialize_state, "state serialised"),
        (can.directional_derivatives, "directional derivatives"),
        (can.variable_step, "variable step"),
        (can.event_mode, "event mode"),
        (can.only_once_per_process, "one instance a process only"),
        (can.needs_execution_tool, "needs its tool to run"),
    ];
    let has: Vec<_> = named.iter().filter(|(has, _)| *has).map(|(_, name)| *name).collect();
    if has.is_empty() { "nothing optional".to_owned() } else { has.join(", ") }
}

fn text(answer: &InfoAnswer<'_>, about: &Description) -> String {
    let mut text = format!("{}, FMI {}\n", answer.name, answer.fmi);
    let mut line = |key: &str, value: &str| {
        let _ = writeln!(text, "  {key:<16} {value}");
    };
    if let Some(description) = answer.description {
        line("description", description);
    }
    if let Some(tool) = answer.generation_tool {
        line("made by", tool);
    }
    for kind in about.interfaces() {
        line(&kind.to_string(), &abilities(about, kind));
    }
    line("platforms", &answer.platforms.join(", "));
    let said =
        |name: &str, value: Option<f64>| value.map(|value| format!("{name} {}", rounded(value)));
    let experiment: Vec<_> = [
        said("start", answer.start),
        said("stop", answer.stop),
        said("step", answer.step),
        said("tolerance", answer.tolerance),
    ]
    .into_iter()
    .flatten()
    .collect();
    line(
        "experiment",
        &if experiment.is_empty() { "none".to_owned() } else { experiment.join(", ") },
    );
    line("states", &format!("{}, {} event indicators", answer.states, answer.event_indicators));
    let mut table = Table::new();
    table.load_style(presets::NOTHING);
    table.set_content_arrangement(ContentArrangement::Dynamic);
    table.set_header(["variable", "causality", "type", "unit", "start", "description"]);
    for variable in &answer.variables {
        let start = match variable.start {
            [one] => one.clone(),
            [] => String::new(),
            many => format!("{} values", many.len()),
        };
        let or_nothing = |text: Option<&str>| text.unwrap_or_default().to_owned();
        table.add_row([
            variable.name.to_owned(),
            variable.causality.to_owned(),
            variable.kind.to_owned(),
            or_nothing(variable.unit),
            start,
            or_nothing(variable.description),
        ]);
    }
    format!("{text}{table}\n")
}
