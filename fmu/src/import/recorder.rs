//! What a run records, sample by sample: numbers as signals; texts, bytes and whole numbers that a
//! Float64 cannot hold as texts.

use drivescope_recording::{Signal, TextSignal};

use super::access::Group;
use super::description::{Causality, Type, Variable};
use super::error::Error;
use super::fmu::Fmu;
use super::instance::Instance;

/// Whole numbers up to this magnitude are exact in a Float64.
const EXACT: i128 = 1 << 53;

/// The recorded variables of one run.
pub(super) struct Recorder {
    /// Scalars that a Float64 holds: read together, one C call a type.
    scalars: Group,
    row: Vec<f64>,
    columns: Vec<Column>,
    /// Outputs that have no value outside Event Mode.
    pub(super) left_out: Vec<String>,
}

/// One recorded variable: its elements, each with its values so far.
struct Column {
    name: String,
    unit: String,
    /// Indices of the elements, as `[1,2]`; one empty text for a scalar.
    indices: Vec<String>,
    values: Values,
}

enum Values {
    /// The number of this place among the scalars.
    Scalar(usize, Vec<f64>),
    Numbers(Vec<Vec<f64>>),
    Whole(Vec<Vec<i128>>),
    Texts(Vec<Vec<String>>),
    Bytes(Vec<Vec<String>>),
}

impl Recorder {
    /// Records the variables of these names, or all outputs.
    pub(super) fn new(
        fmu: &Fmu,
        instance: &Instance,
        names: Option<&[String]>,
    ) -> Result<Recorder, Error> {
        let description = fmu.description();
        let mut left_out = Vec::new();
        let variables: Vec<&Variable> = match names {
            Some(names) => names.iter().map(|name| fmu.variable(name)).collect::<Result<_, _>>()?,
            None => description
                .variables
                .iter()
                .filter(|variable| variable.causality == Causality::Output)
                .collect(),
        };
        let (mut columns, mut scalars) = (Vec::new(), Vec::new());
        for variable in variables {
            let count = description.elements(variable);
            let values = match variable.kind {
                // A clock ticks in Event Mode alone and holds no value between.
                Type::Clock => {
                    left_out.push(variable.name.clone());
                    continue;
                }
                Type::Int64 | Type::UInt64 => Values::Whole(vec![Vec::new(); count]),
                Type::String => Values::Texts(vec![Vec::new(); count]),
                Type::Binary => Values::Bytes(vec![Vec::new(); count]),
                _ if variable.dimensions.is_empty() => {
                    scalars.push(variable.name.as_str());
                    Values::Scalar(scalars.len() - 1, Vec::new())
                }
                _ => Values::Numbers(vec![Vec::new(); count]),
            };
            columns.push(Column {
                name: variable.name.clone(),
                unit: variable.unit.clone().unwrap_or_else(|| "1".to_owned()),
                indices: indices(&description.sizes(variable)),
                values,
            });
        }
        let scalars = instance.group(&scalars)?;
        Ok(Recorder { row: vec![0.0; scalars.len()], scalars, columns, left_out })
    }

    /// Numbers, or texts, of one sample.
    pub(super) fn columns(&self) -> usize {
        self.columns.iter().map(|column| column.indices.len()).sum()
    }

    /// Reads one sample.
    pub(super) fn sample(&mut self, instance: &mut Instance) -> Result<(), Error> {
        instance.read(&self.scalars, &mut self.row)?;
        for Column { name, values, .. } in &mut self.columns {
            match values {
                Values::Scalar(at, values) => values.push(self.row[*at]),
                Values::Numbers(values) => push(values, instance.array(name)?),
                Values::Whole(values) => push(values, instance.whole_numbers(name)?),
                Values::Texts(values) => push(values, instance.texts(name)?),
                Values::Bytes(values) => {
                    let hex = |bytes: Vec<u8>| bytes.iter().map(|b| format!("{b:02x}")).collect();
                    push(values, instance.binaries(name)?.into_iter().map(hex).collect());
                }
            }
        }
        Ok(())
    }

    /// What was recorded.
    pub(super) fn finish(self) -> (Vec<Signal>, Vec<TextSignal>) {
        let (mut signals, mut texts) = (Vec::new(), Vec::new());
        for Column { name, unit, indices, values } in self.columns {
            let mut number = |at: usize, values: Vec<f64>| {
                let name = format!("{name}{}", indices[at]);
                signals.push(Signal { name, unit: unit.clone(), values });
            };
            let mut text = |at: usize, values: Vec<String>| {
                texts.push(TextSignal { name: format!("{name}{}", indices[at]), values });
            };
            match values {
                Values::Scalar(_, values) => number(0, values),
                Values::Numbers(all) => {
                    all.into_iter().enumerate().for_each(|(at, values)| number(at, values));
                }
                Values::Whole(all) => {
                    for (at, values) in all.into_iter().enumerate() {
                        if values.iter().all(|value| (-EXACT..=EXACT).contains(value)) {
                            number(at, values.into_iter().map(|value| value as f64).collect());
                        } else {
                            text(at, values.iter().map(i128::to_string).collect());
                        }
                    }
                }
                Values::Texts(all) | Values::Bytes(all) => {
                    all.into_iter().enumerate().for_each(|(at, values)| text(at, values));
                }
            }
        }
        (signals, texts)
    }
}

fn push<T>(columns: &mut [Vec<T>], row: Vec<T>) {
    for (column, value) in columns.iter_mut().zip(row) {
        column.push(value);
    }
}

/// The indices of all elements of an array, from 1, the last one running first: `[1,1]`, `[1,2]`, ...
pub(super) fn indices(sizes: &[usize]) -> Vec<String> {
    if sizes.is_empty() {
        return vec![String::new()];
    }
    let mut all = vec![String::new()];
    for size in sizes {
        let extended = |index: &String| {
            let before = if index.is_empty() { String::new() } else { format!("{index},") };
            (1..=*size).map(move |k| format!("{before}{k}")).collect::<Vec<_>>()
        };
        all = all.iter().flat_map(extended).collect();
    }
    all.into_iter().map(|index| format!("[{index}]")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_are_named_row_by_row() {
        assert_eq!(indices(&[]), [""]);
        assert_eq!(indices(&[2]), ["[1]", "[2]"]);
        assert_eq!(indices(&[2, 2]), ["[1,1]", "[1,2]", "[2,1]", "[2,2]"]);
        assert!(indices(&[0]).is_empty());
    }
}
