//! Variables that are more than one number, or no number: arrays (FMI 3.0), whole numbers beyond the
//! 53 bits of a Float64, texts and bytes.

use super::boolean::Boolean2;
use super::description::{Type, Variable};
use super::error::Error;
use super::instance::Instance;
use super::native::Native;
use super::problem::VariableProblem;
use crate::import::Version;

/// Calls a generic method with the C type of a numeric variable.
macro_rules! of_native {
    ($kind:expr, $fmi:expr, $self:ident.$method:ident($($argument:expr),*)) => {
        match ($kind, $fmi) {
            (Type::Float64, _) => $self.$method::<f64>($($argument),*),
            (Type::Float32, _) => $self.$method::<f32>($($argument),*),
            (Type::Int8, _) => $self.$method::<i8>($($argument),*),
            (Type::UInt8, _) => $self.$method::<u8>($($argument),*),
            (Type::Int16, _) => $self.$method::<i16>($($argument),*),
            (Type::UInt16, _) => $self.$method::<u16>($($argument),*),
            (Type::Int32, _) | (Type::Enumeration, Version::Two) => {
                $self.$method::<i32>($($argument),*)
            }
            (Type::UInt32, _) => $self.$method::<u32>($($argument),*),
            (Type::Int64, _) | (Type::Enumeration, Version::Three) => {
                $self.$method::<i64>($($argument),*)
            }
            (Type::UInt64, _) => $self.$method::<u64>($($argument),*),
            (Type::Boolean, Version::Two) => $self.$method::<Boolean2>($($argument),*),
            (Type::Boolean, Version::Three) => $self.$method::<bool>($($argument),*),
            (Type::String | Type::Binary | Type::Clock, _) => Err($self.not_numeric($($argument),*)),
        }
    };
}

impl Instance {
    /// The elements of a numeric array (FMI 3.0), in row-major order; of a scalar, its one value.
    ///
    /// # Errors
    /// A variable that does not exist or is no number, or the FMU cannot compute it.
    pub fn array(&mut self, name: &str) -> Result<Vec<f64>, Error> {
        let variable = self.variable(name)?.clone();
        of_native!(variable.kind, self.fmi, self.numbers(&variable, &[]))
    }

    /// Sets all elements of a numeric array (FMI 3.0), in row-major order.
    ///
    /// # Errors
    /// A variable that does not exist, another number of elements, a value that its type cannot hold.
    pub fn set_array(&mut self, name: &str, values: &[f64]) -> Result<(), Error> {
        let variable = self.variable(name)?.clone();
        let there = self.fmu.description().elements(&variable);
        if there != values.len() {
            let problem = VariableProblem::Elements { there, given: values.len() };
            return Err(self.cannot(name, problem));
        }
        self.before_set()?;
        of_native!(variable.kind, self.fmi, self.put_numbers(&variable, values)).map(drop)
    }

    /// The elements of a variable of type Int64 or UInt64, exactly.
    ///
    /// # Errors
    /// As [`array`](Instance::array).
    pub fn whole_numbers(&mut self, name: &str) -> Result<Vec<i128>, Error> {
        let variable = self.variable(name)?.clone();
        match variable.kind {
            Type::Int64 => {
                Ok(self.natives::<i64>(&variable)?.into_iter().map(i128::from).collect())
            }
            Type::UInt64 => {
                Ok(self.natives::<u64>(&variable)?.into_iter().map(i128::from).collect())
            }
            other => Err(self.cannot(name, VariableProblem::NotWhole(other.name()))),
        }
    }

    /// The elements of a String.
    ///
    /// # Errors
    /// A variable that does not exist or is of another type, or the FMU cannot compute it.
    pub fn texts(&mut self, name: &str) -> Result<Vec<String>, Error> {
        let variable = self.variable(name)?.clone();
        if variable.kind != Type::String {
            return Err(self.cannot(name, VariableProblem::NotText(variable.kind.name())));
        }
        self.callable("texts")?;
        let count = self.fmu.description().elements(&variable);
        let (status, texts) = self.handle.get_strings(variable.reference, count);
        self.check_of("get String", name, status)?;
        Ok(texts)
    }

    /// The elements of a Binary (FMI 3.0).
    ///
    /// # Errors
    /// As [`texts`](Instance::texts).
    pub fn binaries(&mut self, name: &str) -> Result<Vec<Vec<u8>>, Error> {
        let variable = self.variable(name)?.clone();
        if variable.kind != Type::Binary {
            return Err(self.cannot(name, VariableProblem::NotBytes(variable.kind.name())));
        }
        self.callable("binaries")?;
        let count = self.fmu.description().elements(&variable);
        let (status, bytes) = self.handle.get_binaries(variable.reference, count);
        self.check_of("get Binary", name, status)?;
        Ok(bytes)
    }

    /// Sets an array from a text: its elements, parted by blanks or commas.
    pub(super) fn set_elements(&mut self, variable: &Variable, text: &str) -> Result<(), Error> {
        let parts: Vec<&str> = text
            .split(|c: char| c.is_whitespace() || c == ',' || c == ';')
            .filter(|part| !part.is_empty())
            .collect();
        let there = self.fmu.description().elements(variable);
        if parts.len() != there {
            let problem = VariableProblem::Elements { there, given: parts.len() };
            return Err(self.cannot(&variable.name, problem));
        }
        if matches!(variable.kind, Type::Int64 | Type::UInt64) {
            return self.set_whole(variable, &parts);
        }
        let number = |part: &&str| {
            self.parse(variable, part).ok_or_else(|| {
                let (kind, text) = (variable.kind.name(), (*part).to_owned());
                self.cannot(&variable.name, VariableProblem::Text { kind, text })
            })
        };
        let numbers = parts.iter().map(number).collect::<Result<Vec<f64>, _>>()?;
        self.set_array(&variable.name, &numbers)
    }

    /// Sets the elements of an Int64 or UInt64 as they are written: a Float64 would round them.
    pub(super) fn set_whole(&mut self, variable: &Variable, parts: &[&str]) -> Result<(), Error> {
        let wrong = |instance: &Self, part: &str| {
            let (kind, text) = (variable.kind.name(), part.to_owned());
            instance.cannot(&variable.name, VariableProblem::Text { kind, text })
        };
        self.before_set()?;
        let status = if variable.kind == Type::Int64 {
            let values =
                parts.iter().map(|part| part.trim().parse().map_err(|_| wrong(self, part)));
            let values = values.collect::<Result<Vec<i64>, _>>()?;
            self.handle.set(&[variable.reference], &values)
        } else {
            let values =
                parts.iter().map(|part| part.trim().parse().map_err(|_| wrong(self, part)));
            let values = values.collect::<Result<Vec<u64>, _>>()?;
            self.handle.set(&[variable.reference], &values)
        };
        self.check_of(&format!("set {}", variable.kind.name()), &variable.name, status)
    }

    fn natives<T: Native>(&mut self, variable: &Variable) -> Result<Vec<T>, Error> {
        self.callable("array")?;
        let mut values = vec![T::default(); self.fmu.description().elements(variable)];
        let status = self.handle.get(&[variable.reference], &mut values);
        self.check_of(&format!("get {}", variable.kind.name()), &variable.name, status)?;
        Ok(values)
    }

    fn numbers<T: Native>(&mut self, variable: &Variable, _: &[f64]) -> Result<Vec<f64>, Error> {
        Ok(self.natives::<T>(variable)?.into_iter().map(T::number).collect())
    }

    fn put_numbers<T: Native>(
        &mut self,
        variable: &Variable,
        values: &[f64],
    ) -> Result<Vec<f64>, Error> {
        let native = |value: &f64| {
            T::from_number(*value).ok_or_else(|| {
                let (kind, value) = (variable.kind.name(), *value);
                self.cannot(&variable.name, VariableProblem::Value { kind, value })
            })
        };
        let values = values.iter().map(native).collect::<Result<Vec<T>, _>>()?;
        let status = self.handle.set(&[variable.reference], &values);
        self.check_of(&format!("set {}", variable.kind.name()), &variable.name, status)?;
        Ok(Vec::new())
    }

    fn not_numeric(&self, variable: &Variable, _: &[f64]) -> Error {
        self.cannot(&variable.name, VariableProblem::NotNumeric(variable.kind.name()))
    }
}
