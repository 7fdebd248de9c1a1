//! The `.toml` form of a system description:
//!
//! ```toml
//! [experiment]
//! stop = 1.0                      # s; also: start, tolerance, rollback, order
//! step = 0.005                    # s
//! algorithm = "gauss-seidel"      # or "jacobi"
//! [[component]]
//! name = "drive"
//! fmu = "drive.fmu"               # beside this file
//! parameters = { R = 3.0 }        # also: kind = "co-simulation" or "model-exchange"
//! [[connect]]
//! from = "drive.omega"
//! to = "load.omega"               # also: factor, offset
//! [[input]]
//! recording = "reference.csv"
//! signal = "reference"
//! to = "drive.reference"
//! [[record]]
//! port = "drive.omega"            # without any: all outputs
//! ```

use std::collections::BTreeMap;
use std::fs;
use std::ops::Range;
use std::path::Path;

use serde::Deserialize;
use toml::Spanned;

use crate::import::{Conversion, Interface, Value};
use crate::position::Position;

use super::document::{
    ComponentEntry, ConnectionEntry, Document, InputEntry, ParameterEntry, wrong,
};
use super::error::Error;
use super::system::Algorithm;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    experiment: ExperimentTable,
    #[serde(default)]
    component: Vec<Spanned<ComponentTable>>,
    #[serde(default)]
    connect: Vec<Spanned<ConnectTable>>,
    #[serde(default)]
    input: Vec<Spanned<InputTable>>,
    #[serde(default)]
    record: Vec<RecordTable>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ExperimentTable {
    start: Option<f64>,
    stop: Option<f64>,
    step: Option<f64>,
    tolerance: Option<f64>,
    #[serde(default)]
    algorithm: AlgorithmName,
    order: Option<Spanned<Vec<String>>>,
    #[serde(default)]
    rollback: bool,
}

#[derive(Deserialize, Default, PartialEq)]
#[serde(rename_all = "kebab-case")]
enum AlgorithmName {
    #[default]
    GaussSeidel,
    Jacobi,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ComponentTable {
    name: String,
    fmu: String,
    kind: Option<KindName>,
    #[serde(default)]
    parameters: BTreeMap<String, Spanned<Scalar>>,
}

#[derive(Deserialize)]
#[serde(rename_all = "kebab-case")]
enum KindName {
    CoSimulation,
    ModelExchange,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Scalar {
    Boolean(bool),
    Number(f64),
    Text(String),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ConnectTable {
    from: String,
    to: String,
    #[serde(default = "one")]
    factor: f64,
    #[serde(default)]
    offset: f64,
}

fn one() -> f64 {
    1.0
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct InputTable {
    recording: String,
    signal: String,
    to: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RecordTable {
    port: Spanned<String>,
}

/// Reads the file; other files are looked for beside it.
pub(super) fn read(path: &Path) -> Result<Document, Error> {
    let text =
        fs::read_to_string(path).map_err(|source| Error::Read { path: path.to_owned(), source })?;
    parse(path, &text)
}

fn parse(path: &Path, text: &str) -> Result<Document, Error> {
    let place = |span: Range<usize>| place(text, span.start);
    let file: File = toml::from_str(text).map_err(|error| {
        wrong(path, place(error.span().unwrap_or(0..0)), error.message().to_owned())
    })?;
    let beside = |name: &str| path.parent().unwrap_or(Path::new("")).join(name);
    let ExperimentTable { start, stop, step, tolerance, algorithm, order, rollback } =
        file.experiment;
    let algorithm = match (algorithm, order) {
        (AlgorithmName::GaussSeidel, None) => Algorithm::GaussSeidel,
        (AlgorithmName::GaussSeidel, Some(order)) => Algorithm::GaussSeidelIn(order.into_inner()),
        (AlgorithmName::Jacobi, None) => Algorithm::Jacobi,
        (AlgorithmName::Jacobi, Some(order)) => {
            return Err(wrong(
                path,
                place(order.span()),
                "`order` has no meaning for Jacobi".to_owned(),
            ));
        }
    };
    let component = |entry: Spanned<ComponentTable>| {
        let at = place(entry.span());
        let ComponentTable { name, fmu, kind, parameters } = entry.into_inner();
        let parameters = parameters.into_iter().map(|(name, value)| {
            let at = place(value.span());
            let value = match value.into_inner() {
                Scalar::Boolean(value) => Value::Text(value.to_string()),
                Scalar::Number(value) => Value::Number(value),
                Scalar::Text(value) => Value::Text(value),
            };
            ParameterEntry { name, value, unit: None, place: at }
        });
        let kind = kind.map(|kind| match kind {
            KindName::CoSimulation => Interface::CoSimulation,
            KindName::ModelExchange => Interface::ModelExchange,
        });
        ComponentEntry {
            name,
            fmu: beside(&fmu),
            kind,
            parameters: parameters.collect(),
            connectors: Vec::new(),
            place: at,
        }
    };
    let connection = |entry: Spanned<ConnectTable>| {
        let at = place(entry.span());
        let ConnectTable { from, to, factor, offset } = entry.into_inner();
        ConnectionEntry {
            from,
            to,
            scaling: Conversion { factor, offset },
            converts: true,
            place: at,
        }
    };
    let input = |entry: Spanned<InputTable>| {
        let at = place(entry.span());
        let InputTable { recording, signal, to } = entry.into_inner();
        InputEntry { recording: beside(&recording), signal, to, place: at }
    };
    Ok(Document {
        start,
        stop,
        step,
        tolerance,
        algorithm,
        rollback,
        components: file.component.into_iter().map(component).collect(),
        connections: file.connect.into_iter().map(connection).collect(),
        inputs: file.input.into_iter().map(input).collect(),
        records: file
            .record
            .into_iter()
            .map(|entry| (entry.port.get_ref().clone(), place(entry.port.span())))
            .collect(),
        ..Document::empty(path)
    })
}

/// Line and column of a byte, from 1.
fn place(text: &str, at: usize) -> Position {
    let before = text.get(..at).unwrap_or(text);
    let line = before.matches('\n').count() + 1;
    let column = before.rsplit('\n').next().map_or(0, |last| last.chars().count()) + 1;
    let bounded = |count: usize| u32::try_from(count).unwrap_or(u32::MAX);
    Position { line: bounded(line), column: bounded(column) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "[experiment]\nstop = 2\nstep = 0.1\nalgorithm = \"jacobi\"\n\
        [[component]]\nname = \"a\"\nfmu = \"a.fmu\"\nparameters = { K = 2, on = true, s = \"x\" }\n\
        [[connect]]\nfrom = \"a.y\"\nto = \"b.u\"\nfactor = 3\n\
        [[record]]\nport = \"a.y\"\n";

    fn message(text: &str) -> String {
        parse(Path::new("dir/s.toml"), text).unwrap_err().to_string()
    }

    #[test]
    fn the_form_is_read() {
        let document = parse(Path::new("dir/s.toml"), TEXT).unwrap();
        assert_eq!((document.stop, document.algorithm), (Some(2.0), Algorithm::Jacobi));
        let a = &document.components[0];
        assert_eq!((a.name.as_str(), a.fmu.as_path()), ("a", Path::new("dir/a.fmu")));
        let (name, value) = ("K".to_owned(), Value::Number(2.0));
        let first =
            ParameterEntry { name, value, unit: None, place: Position { line: 8, column: 20 } };
        assert_eq!(a.parameters[0], first);
        assert_eq!(a.parameters[1].value, Value::Text("true".to_owned()));
        assert_eq!(document.connections[0].scaling, Conversion { factor: 3.0, offset: 0.0 });
        assert_eq!(document.records, [("a.y".to_owned(), Position { line: 14, column: 8 })]);
    }

    #[test]
    fn mistakes_have_line_and_column() {
        let unknown = message(&TEXT.replace("step =", "stepp ="));
        assert!(unknown.starts_with("dir/s.toml:3:1: unknown field `stepp`"), "{unknown}");
        let kind = message(&TEXT.replace("stop = 2", "stop = \"2\""));
        assert!(kind.starts_with("dir/s.toml:2:8: "), "{kind}");
        let algorithm = message(&TEXT.replace("jacobi", "euler"));
        assert!(algorithm.starts_with("dir/s.toml:4:13: "), "{algorithm}");
        let order = message(&TEXT.replace("stop = 2", "order = [\"a\"]"));
        assert!(order.starts_with("dir/s.toml:2:9: `order`"), "{order}");
    }
}
