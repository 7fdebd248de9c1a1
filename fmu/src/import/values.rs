//! Values in and out of an instance: by value reference (the fast way), by group, by name.

use std::ffi::CString;

use super::access::{Failure, Group};
use super::description::{Causality, Type, Variability, Variable};
use super::error::Error;
use super::instance::Instance;
use super::mode::Mode;
use super::problem::VariableProblem;
use super::status::Status;

/// A value of one variable.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// A number; Boolean: 0 or 1, enumeration: the item's value.
    Number(f64),
    /// The value of a String.
    Text(String),
}

impl From<f64> for Value {
    fn from(number: f64) -> Value {
        Value::Number(number)
    }
}

impl Instance {
    /// Writes Float64 variables (FMI 2.0: Real). No allocation: this is the way within a loop.
    ///
    /// # Errors
    /// The FMU refuses a value, or the numbers of references and values differ.
    #[inline]
    pub fn set(&mut self, references: &[u32], values: &[f64]) -> Result<(), Error> {
        if references.len() != values.len() {
            return Err(self.lengths(references.len(), values.len()));
        }
        self.before_set()?;
        let status = self.handle.set(references, values);
        self.check("set Float64", status)
    }

    /// Reads Float64 variables (FMI 2.0: Real) into `values`, which the caller keeps: no allocation.
    ///
    /// # Errors
    /// The FMU cannot compute a value, or the numbers of references and values differ.
    #[inline]
    pub fn get(&mut self, references: &[u32], values: &mut [f64]) -> Result<(), Error> {
        if references.len() != values.len() {
            return Err(self.lengths(references.len(), values.len()));
        }
        self.callable("get")?;
        let status = self.handle.get(references, values);
        self.check("get Float64", status)
    }

    /// Prepares the joint transfer of scalar numeric variables of any types.
    ///
    /// # Errors
    /// A name that does not exist, an array, a variable without a numeric value.
    pub fn group(&self, names: &[&str]) -> Result<Group, Error> {
        let variables =
            names.iter().map(|name| self.variable(name)).collect::<Result<Vec<_>, _>>()?;
        Group::new(self.fmu.description(), &variables)
            .map_err(|(position, problem)| self.cannot(names[position], problem))
    }

    /// Writes a group of variables, one value each, in the order of the group's names.
    ///
    /// # Errors
    /// A value that its variable's type cannot hold, or the FMU refuses.
    pub fn write(&mut self, group: &Group, values: &[f64]) -> Result<(), Error> {
        if group.len() != values.len() {
            return Err(self.lengths(group.len(), values.len()));
        }
        self.before_set()?;
        group
            .write(&mut self.handle, self.fmi, values)
            .map_err(|failure| self.transfer_failed(failure, group, values))
    }

    /// Reads a group of variables into `values`, one value each.
    ///
    /// # Errors
    /// The FMU cannot compute a value.
    pub fn read(&mut self, group: &Group, values: &mut [f64]) -> Result<(), Error> {
        if group.len() != values.len() {
            return Err(self.lengths(group.len(), values.len()));
        }
        self.callable("read")?;
        group
            .read(&mut self.handle, self.fmi, values)
            .map_err(|failure| self.transfer_failed(failure, group, &[]))
    }

    /// Sets one variable by name, usually a parameter before the initialisation. A text for a numeric
    /// variable is read as its type: `true`, `0.5`, the name of an enumeration's item.
    ///
    /// # Errors
    /// A variable that does not exist or cannot be set, a value that is none of its type.
    pub fn set_value(&mut self, name: &str, value: &Value) -> Result<(), Error> {
        let variable = self.variable(name)?.clone();
        if matches!(variable.causality, Causality::CalculatedParameter | Causality::Independent)
            || variable.variability == Variability::Constant
        {
            let what =
                format!("{:?} {:?}", variable.variability, variable.causality).to_lowercase();
            return Err(self.cannot(name, VariableProblem::NotSettable(what)));
        }
        match value {
            Value::Text(text) if variable.kind == Type::String => {
                let text = CString::new(text.as_str())
                    .map_err(|_| self.cannot(name, VariableProblem::Nul))?;
                self.before_set()?;
                let status = self.handle.set_string(variable.reference, &text);
                self.check_of("set String", name, status)
            }
            Value::Text(text) if !variable.dimensions.is_empty() => {
                self.set_elements(&variable, text)
            }
            Value::Text(text) if matches!(variable.kind, Type::Int64 | Type::UInt64) => {
                self.set_whole(&variable, &[text])
            }
            Value::Number(number) => self.set_number(name, &variable, *number),
            Value::Text(text) => {
                let number = self.parse(&variable, text).ok_or_else(|| {
                    let (kind, text) = (variable.kind.name(), text.clone());
                    self.cannot(name, VariableProblem::Text { kind, text })
                })?;
                self.set_number(name, &variable, number)
            }
        }
    }

    /// Reads one variable by name.
    ///
    /// # Errors
    /// A variable that does not exist, is an array or a binary, or cannot be computed.
    pub fn value(&mut self, name: &str) -> Result<Value, Error> {
        let variable = self.variable(name)?;
        if variable.kind == Type::String {
            let reference = variable.reference;
            self.callable("value")?;
            let (status, mut texts) = self.handle.get_strings(reference, 1);
            self.check_of("get String", name, status)?;
            return Ok(Value::Text(texts.pop().unwrap_or_default()));
        }
        let group = self.group(&[name])?;
        let mut number = [0.0];
        self.read(&group, &mut number)?;
        Ok(Value::Number(number[0]))
    }

    /// The directional derivative of `unknowns` in the direction `seed` of `knowns`, all given by
    /// value reference; one value an unknown.
    ///
    /// # Errors
    /// The FMU does not provide it, or fails.
    pub fn directional_derivative(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        seed: &[f64],
    ) -> Result<Vec<f64>, Error> {
        if knowns.len() != seed.len() {
            return Err(self.lengths(knowns.len(), seed.len()));
        }
        let offered = self
            .fmu
            .description()
            .capabilities(self.interface())
            .is_some_and(|c| c.directional_derivatives);
        if !offered {
            let fmu = self.fmu.name().to_owned();
            return Err(Error::Capability { fmu, capability: "a directional derivative" });
        }
        let mut values = vec![0.0; unknowns.len()];
        self.callable("directional_derivative")?;
        let status = self.handle.directional_derivative(unknowns, knowns, seed, &mut values);
        self.check("GetDirectionalDerivative", status)?;
        Ok(values)
    }

    fn set_number(&mut self, name: &str, variable: &Variable, number: f64) -> Result<(), Error> {
        if variable.kind == Type::String {
            return Err(self.cannot(name, VariableProblem::NotNumeric(variable.kind.name())));
        }
        let group = self.group(&[name])?;
        self.write(&group, &[number])
    }

    /// The number that a text means for a variable's type.
    pub(super) fn parse(&self, variable: &Variable, text: &str) -> Option<f64> {
        let text = text.trim();
        match variable.kind {
            Type::Boolean => match text {
                "true" | "1" => Some(1.0),
                "false" | "0" => Some(0.0),
                _ => None,
            },
            Type::Enumeration => {
                let name = variable.declared_type.as_ref()?;
                let definition = self.fmu.description().types.iter().find(|t| t.name == *name)?;
                let item = definition.items.iter().find(|(item, _)| item == text);
                item.map(|(_, value)| *value as f64).or_else(|| text.parse().ok())
            }
            _ => text.parse().ok(),
        }
    }

    /// A Model Exchange instance takes inputs in event mode: a held input that changes is an event.
    #[inline]
    pub(super) fn before_set(&mut self) -> Result<(), Error> {
        self.callable("set")?;
        let Some(integrator) = self.integrator.as_mut().filter(|_| self.mode == Mode::Stepping)
        else {
            return Ok(());
        };
        let status = integrator.enter_event_mode(&mut self.handle);
        self.check("EnterEventMode", status)
    }

    pub(super) fn variable(&self, name: &str) -> Result<&Variable, Error> {
        self.fmu.variable(name)
    }

    pub(super) fn cannot(&self, name: &str, problem: VariableProblem) -> Error {
        Error::Variable { fmu: self.fmu.name().to_owned(), name: name.to_owned(), problem }
    }

    #[cold]
    fn lengths(&self, references: usize, values: usize) -> Error {
        Error::Lengths { fmu: self.fmu.name().to_owned(), references, values }
    }

    #[cold]
    fn transfer_failed(&mut self, failure: Failure, group: &Group, values: &[f64]) -> Error {
        match failure {
            Failure::Status(function, kind, status) => {
                let call = format!("{function} {}", kind.name());
                self.failed_at(&call, group.names(), status)
            }
            Failure::Value(position, kind) => {
                let problem = VariableProblem::Value { kind: kind.name(), value: values[position] };
                self.cannot(&group.names()[position], problem)
            }
        }
    }

    /// The error of a call about these variables.
    #[cold]
    fn failed_at(&mut self, call: &str, names: &[String], status: Status) -> Error {
        /// Names that an error shows of many.
        const SHOWN: usize = 5;
        let more = if names.len() > SHOWN { ", ..." } else { "" };
        let names: Vec<String> = names.iter().take(SHOWN).map(|name| format!("`{name}`")).collect();
        self.failed(format!("{call} {}{more}", names.join(", ")), status)
    }

    pub(super) fn check_of(&mut self, call: &str, name: &str, status: Status) -> Result<(), Error> {
        if status.is_good() {
            return Ok(());
        }
        Err(self.failed_at(call, &[name.to_owned()], status))
    }
}

impl super::Fmu {
    /// The variable of that name.
    ///
    /// # Errors
    /// There is none; the error names the most similar one.
    pub fn variable(&self, name: &str) -> Result<&Variable, Error> {
        self.description().variable(name).ok_or_else(|| {
            let names = self.description().variables.iter().map(|variable| variable.name.as_str());
            let near = nearest(name, names).map(str::to_owned);
            Error::UnknownVariable { fmu: self.name().to_owned(), name: name.to_owned(), near }
        })
    }
}

/// The most similar of some names, if one is similar at all.
pub(crate) fn nearest<'a>(name: &str, names: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let wanted = name.to_lowercase();
    let distances = names.map(|other| (distance(&wanted, &other.to_lowercase()), other));
    let limit = 1 + name.chars().count() / 3;
    distances.filter(|(d, _)| *d <= limit).min_by_key(|(d, _)| *d).map(|(_, other)| other)
}

/// Levenshtein's distance: insertions, deletions and substitutions.
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let substituted = diagonal + usize::from(x != *y);
            diagonal = row[j + 1];
            row[j + 1] = substituted.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_similar_name_is_found() {
        let names = ["omega", "theta", "T_l"];
        assert_eq!(nearest("Omga", names.into_iter()), Some("omega"));
        assert_eq!(nearest("temperature", names.into_iter()), None);
        assert_eq!(distance("kitten", "sitting"), 3);
    }
}
