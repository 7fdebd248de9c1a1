//! Groups of variables that are read or written together, whatever their types: FMI has one function
//! a type, so a group is sorted by type once, and each transfer is then one C call a type.

use super::boolean::Boolean2;
use super::description::{Description, Type, Variable, Version};
use super::handle::Handle;
use super::native::Native;
use super::problem::VariableProblem;
use super::status::Status;

/// Scalar numeric variables that are transferred together; made by
/// [`Instance::group`](super::Instance::group).
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    runs: Vec<Run>,
    names: Vec<String>,
}

/// The members of one type.
#[derive(Debug, Clone, PartialEq)]
struct Run {
    kind: Type,
    references: Vec<u32>,
    /// Where in the caller's slice each value is.
    positions: Vec<usize>,
    /// Whether the positions are `0, 1, 2, ...`: values of the native type need no copy then.
    in_place: bool,
}

/// Why a transfer failed.
pub(super) enum Failure {
    /// The FMI function did.
    Status(&'static str, Type, Status),
    /// The value at this position cannot be held by its type.
    Value(usize, Type),
}

impl Group {
    /// # Errors
    /// A variable that is no scalar number, with its position.
    pub(super) fn new(
        description: &Description,
        variables: &[&Variable],
    ) -> Result<Group, (usize, VariableProblem)> {
        let mut runs: Vec<Run> = Vec::new();
        for (position, variable) in variables.iter().enumerate() {
            if !variable.kind.is_numeric() {
                return Err((position, VariableProblem::NotNumeric(variable.kind.name())));
            }
            if !variable.dimensions.is_empty() {
                return Err((position, VariableProblem::Array(description.elements(variable))));
            }
            let at = runs.iter().position(|run| run.kind == variable.kind).unwrap_or_else(|| {
                let (references, positions) = (Vec::new(), Vec::new());
                runs.push(Run { kind: variable.kind, references, positions, in_place: true });
                runs.len() - 1
            });
            let run = &mut runs[at];
            run.in_place &= position == run.positions.len();
            run.references.push(variable.reference);
            run.positions.push(position);
        }
        let names = variables.iter().map(|variable| variable.name.clone()).collect();
        Ok(Group { runs, names })
    }

    /// Number of variables.
    pub fn len(&self) -> usize {
        self.names.len()
    }

    /// Their names, in the order of the values.
    pub(super) fn names(&self) -> &[String] {
        &self.names
    }

    /// Whether there is no variable.
    pub fn is_empty(&self) -> bool {
        self.names.is_empty()
    }

    pub(super) fn read(
        &self,
        from: &mut Handle,
        fmi: Version,
        values: &mut [f64],
    ) -> Result<(), Failure> {
        for run in &self.runs {
            if run.kind == Type::Float64 && run.in_place {
                let count = run.references.len();
                good("get", run.kind, from.get(&run.references, &mut values[..count]))?;
                continue;
            }
            match (run.kind, fmi) {
                (Type::Float64, _) => run.read::<f64>(from, values)?,
                (Type::Float32, _) => run.read::<f32>(from, values)?,
                (Type::Int8, _) => run.read::<i8>(from, values)?,
                (Type::UInt8, _) => run.read::<u8>(from, values)?,
                (Type::Int16, _) => run.read::<i16>(from, values)?,
                (Type::UInt16, _) => run.read::<u16>(from, values)?,
                (Type::Int32, _) | (Type::Enumeration, Version::Two) => {
                    run.read::<i32>(from, values)?
                }
                (Type::UInt32, _) => run.read::<u32>(from, values)?,
                (Type::Int64, _) | (Type::Enumeration, Version::Three) => {
                    run.read::<i64>(from, values)?
                }
                (Type::UInt64, _) => run.read::<u64>(from, values)?,
                (Type::Boolean, Version::Two) => run.read::<Boolean2>(from, values)?,
                (Type::Boolean, Version::Three) => run.read::<bool>(from, values)?,
                (Type::String | Type::Binary | Type::Clock, _) => {}
            }
        }
        Ok(())
    }

    pub(super) fn write(
        &self,
        to: &mut Handle,
        fmi: Version,
        values: &[f64],
    ) -> Result<(), Failure> {
        for run in &self.runs {
            if run.kind == Type::Float64 && run.in_place {
                let count = run.references.len();
                good("set", run.kind, to.set(&run.references, &values[..count]))?;
                continue;
            }
            match (run.kind, fmi) {
                (Type::Float64, _) => run.write::<f64>(to, values)?,
                (Type::Float32, _) => run.write::<f32>(to, values)?,
                (Type::Int8, _) => run.write::<i8>(to, values)?,
                (Type::UInt8, _) => run.write::<u8>(to, values)?,
                (Type::Int16, _) => run.write::<i16>(to, values)?,
                (Type::UInt16, _) => run.write::<u16>(to, values)?,
                (Type::Int32, _) | (Type::Enumeration, Version::Two) => {
                    run.write::<i32>(to, values)?
                }
                (Type::UInt32, _) => run.write::<u32>(to, values)?,
                (Type::Int64, _) | (Type::Enumeration, Version::Three) => {
                    run.write::<i64>(to, values)?
                }
                (Type::UInt64, _) => run.write::<u64>(to, values)?,
                (Type::Boolean, Version::Two) => run.write::<Boolean2>(to, values)?,
                (Type::Boolean, Version::Three) => run.write::<bool>(to, values)?,
                (Type::String | Type::Binary | Type::Clock, _) => {}
            }
        }
        Ok(())
    }
}

/// Values converted at a time, on the stack: a transfer must not allocate.
const CHUNK: usize = 16;

impl Run {
    fn read<T: Native>(&self, from: &mut Handle, values: &mut [f64]) -> Result<(), Failure> {
        let mut chunk = [T::default(); CHUNK];
        for (references, positions) in
            self.references.chunks(CHUNK).zip(self.positions.chunks(CHUNK))
        {
            let chunk = &mut chunk[..references.len()];
            good("get", self.kind, from.get(references, chunk))?;
            for (value, position) in chunk.iter().zip(positions) {
                values[*position] = value.number();
            }
        }
        Ok(())
    }

    fn write<T: Native>(&self, to: &mut Handle, values: &[f64]) -> Result<(), Failure> {
        let mut chunk = [T::default(); CHUNK];
        for (references, positions) in
            self.references.chunks(CHUNK).zip(self.positions.chunks(CHUNK))
        {
            let chunk = &mut chunk[..references.len()];
            for (value, position) in chunk.iter_mut().zip(positions) {
                let number = T::from_number(values[*position]);
                *value = number.ok_or(Failure::Value(*position, self.kind))?;
            }
            good("set", self.kind, to.set(references, chunk))?;
        }
        Ok(())
    }
}

fn good(function: &'static str, kind: Type, status: Status) -> Result<(), Failure> {
    if status.is_good() { Ok(()) } else { Err(Failure::Status(function, kind, status)) }
}
