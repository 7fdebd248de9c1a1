//! Getting and setting variables: who may set what, and when
//! (FMI 2.0.4 sections 2.1.7, 3.2.3, 4.2.4; FMI 3.0.2 sections 2.2.6 and 2.3).

use super::Model;
use super::instance::Instance;
use super::phase::Phase;
use super::refusal::{Refusal, same_length};
use crate::description::{Causality, Initial, TIME, Type, Variability, Variable, Version};

/// A C type in which values cross the interface.
pub trait Value: Copy {
    /// The variables' type.
    const KIND: Type;

    /// From the model's number.
    fn from_number(number: f64) -> Self;

    /// To the model's number.
    fn number(self) -> f64;
}

impl Value for f64 {
    const KIND: Type = Type::Float64;

    fn from_number(number: f64) -> Self {
        number
    }

    fn number(self) -> f64 {
        self
    }
}

impl Value for i32 {
    const KIND: Type = Type::Int32;

    fn from_number(number: f64) -> Self {
        number as i32
    }

    fn number(self) -> f64 {
        f64::from(self)
    }
}

/// FMI 2.0 `fmi2Boolean`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(transparent)]
pub struct Boolean2(i32);

impl Value for Boolean2 {
    const KIND: Type = Type::Boolean;

    fn from_number(number: f64) -> Self {
        Self(i32::from(number != 0.0))
    }

    fn number(self) -> f64 {
        f64::from(u8::from(self.0 != 0))
    }
}

/// FMI 3.0 `fmi3Boolean`, as the byte it is: a C caller may store any value in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(transparent)]
pub struct Boolean3(u8);

impl Value for Boolean3 {
    const KIND: Type = Type::Boolean;

    fn from_number(number: f64) -> Self {
        Self(u8::from(number != 0.0))
    }

    fn number(self) -> f64 {
        f64::from(u8::from(self.0 != 0))
    }
}

impl Boolean2 {
    /// `fmi2False`.
    pub const FALSE: Self = Self(0);
}

impl From<bool> for Boolean3 {
    fn from(value: bool) -> Self {
        Self(u8::from(value))
    }
}

/// FMI 2.0 has no values before initialization.
const READABLE_2: &[Phase] = &[
    Phase::Initialization,
    Phase::Event,
    Phase::Continuous,
    Phase::Step,
    Phase::Terminated,
    Phase::Failed,
];
const READABLE_3: &[Phase] = &[
    Phase::Instantiated,
    Phase::Initialization,
    Phase::Event,
    Phase::Continuous,
    Phase::Step,
    Phase::Terminated,
    Phase::Failed,
];
const WRITABLE: &[Phase] =
    &[Phase::Instantiated, Phase::Initialization, Phase::Event, Phase::Continuous, Phase::Step];

#[derive(Clone, Copy, PartialEq, Eq)]
enum Permission {
    Granted,
    /// Only the value that the variable has.
    Held,
    Denied,
}

impl<M: Model> Instance<M> {
    /// Values of variables of one type.
    pub fn get<T: Value>(&self, references: &[u32], values: &mut [T]) -> Result<(), Refusal> {
        self.require(match self.version {
            Version::Two => READABLE_2,
            Version::Three => READABLE_3,
        })?;
        same_length(values.len(), references.len())?;
        for (reference, value) in references.iter().zip(values) {
            *value = T::from_number(self.value(*reference, T::KIND)?);
        }
        Ok(())
    }

    /// Sets all values or, refused, none of them.
    pub fn set<T: Value>(&mut self, references: &[u32], values: &[T]) -> Result<(), Refusal> {
        self.require(WRITABLE)?;
        same_length(values.len(), references.len())?;
        for (reference, value) in references.iter().zip(values) {
            self.check(*reference, T::KIND, value.number())?;
        }
        if self.run.phase == Phase::Continuous {
            return self.set_between_events(references, values);
        }
        for (reference, value) in references.iter().zip(values) {
            self.set_one(*reference, value.number())?;
        }
        Ok(())
    }

    /// Where discrete variables are held: another value than theirs is not taken, with a warning.
    fn set_between_events<T: Value>(
        &mut self,
        references: &[u32],
        values: &[T],
    ) -> Result<(), Refusal> {
        let mut held = Ok(());
        for (reference, value) in references.iter().zip(values) {
            let (given, variable) = (value.number(), self.table.variable(*reference, T::KIND)?);
            let name = || variable.name.clone();
            if permission(variable, self.run.phase) == Permission::Granted {
                self.set_one(*reference, given)?;
                continue;
            }
            let kept = self.model.get(*reference).ok_or_else(|| Refusal::NoValue(name()))?;
            if kept != given {
                held = Err(Refusal::Held { name: name(), held: kept, given });
            }
        }
        held
    }

    fn set_one(&mut self, reference: u32, value: f64) -> Result<(), Refusal> {
        self.model.set(reference, value).map_err(|error| Refusal::model("set", &error))
    }

    /// Refuses to get or set a type of which there is no variable.
    pub fn no_such_type(&self, asked: &'static str, references: &[u32]) -> Result<(), Refusal> {
        match references.first() {
            Some(reference) => Err(self.table.refuse_kind(*reference, asked)),
            None => Ok(()),
        }
    }

    #[inline]
    fn value(&self, reference: u32, kind: Type) -> Result<f64, Refusal> {
        if reference == TIME && kind == Type::Float64 {
            return Ok(self.run.time);
        }
        let variable = self.table.variable(reference, kind)?;
        self.model.get(reference).ok_or_else(|| Refusal::NoValue(variable.name.clone()))
    }

    #[inline]
    fn check(&self, reference: u32, kind: Type, value: f64) -> Result<(), Refusal> {
        let now = self.run.phase;
        if reference == TIME && kind == Type::Float64 {
            let (causality, variability) = (Causality::Local, Variability::Continuous);
            return Err(Refusal::NotSettable { name: "time".into(), causality, variability, now });
        }
        let variable = self.table.variable(reference, kind)?;
        let Variable { causality, variability, min, max, .. } = *variable;
        let name = || variable.name.clone();
        if permission(variable, now) == Permission::Denied {
            return Err(Refusal::NotSettable { name: name(), causality, variability, now });
        }
        if !value.is_finite() {
            return Err(Refusal::Value { what: format!("variable {}", name()), value });
        }
        if min.is_some_and(|min| value < min) || max.is_some_and(|max| value > max) {
            return Err(Refusal::Range { name: name(), value, min, max });
        }
        Ok(())
    }
}

fn permission(variable: &Variable, phase: Phase) -> Permission {
    use Permission::{Denied, Granted, Held};
    let Variable { causality, variability, .. } = *variable;
    let input = causality == Causality::Input;
    let changeable = variability != Variability::Constant;
    let tunable = causality == Causality::Parameter && variability == Variability::Tunable;
    let granted = |yes: bool| if yes { Granted } else { Denied };
    match phase {
        Phase::Instantiated => granted(changeable && variable.initial() != Initial::Calculated),
        Phase::Initialization => granted(changeable && variable.initial() == Initial::Exact),
        Phase::Event | Phase::Step => granted(input || tunable),
        Phase::Continuous if input && variability == Variability::Continuous => Granted,
        Phase::Continuous if input || tunable => Held,
        Phase::Continuous | Phase::Terminated | Phase::Failed | Phase::Lost => Denied,
    }
}
