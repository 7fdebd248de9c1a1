//! What the standard demands of a model description before it is written.

use std::collections::HashSet;

use super::{
    Causality, DefaultExperiment, Initial, ModelDescription, TIME, Type, Unknown, Variability,
    Variable,
};
use crate::vocabulary::go_together;

/// A model description that the standard does not allow.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DescriptionError {
    /// The identifier names a file and a C prefix.
    #[error("model identifier `{0}` is not a C identifier (letters, digits, `_`)")]
    Identifier(String),
    /// A text cannot stand in the file.
    #[error("`{field}` is empty or holds a control character: {text:?}")]
    Text {
        /// Which text.
        field: String,
        text: String,
    },
    /// Two variables of one name.
    #[error("two variables are named `{0}`; names must be unique")]
    DuplicateName(String),
    /// Two variables of one value reference, or the reference of time.
    #[error("variable `{name}`: value reference {reference} is taken (0 is time)")]
    DuplicateReference {
        /// The second variable.
        name: String,
        reference: u32,
    },
    /// Causality, variability, initial and type do not go together.
    #[error(
        "variable `{name}`: {causality:?}, {variability:?}, {initial:?} and {kind:?} do not go together"
    )]
    Combination {
        name: String,
        causality: Causality,
        variability: Variability,
        /// Its initial, default included.
        initial: Initial,
        kind: Type,
    },
    /// A type that a model of ours cannot answer in.
    #[error("variable `{name}` is a {kind:?}; make it a Float64, an Int32 or a Boolean")]
    Type { name: String, kind: Type },
    /// A start value is missing, superfluous, or of the wrong type.
    #[error(
        "variable `{name}`: start value {start:?} does not fit initial {initial:?} of a {kind:?}"
    )]
    Start {
        name: String,
        /// Its start value.
        start: Option<f64>,
        /// Its initial, default included.
        initial: Initial,
        kind: Type,
    },
    /// min <= start <= max or 0 < nominal is broken, or one is not finite.
    #[error(
        "variable `{name}`: min {min:?} <= start {start:?} <= max {max:?}, nominal {nominal:?} > 0 must hold"
    )]
    Range {
        name: String,
        /// Its least value.
        min: Option<f64>,
        /// Its start value.
        start: Option<f64>,
        /// Its greatest value.
        max: Option<f64>,
        /// Its nominal value.
        nominal: Option<f64>,
    },
    /// The state of a derivative is missing or not a continuous real variable.
    #[error(
        "variable `{name}` is the derivative of reference {state}, which is no continuous real variable"
    )]
    State {
        name: String,
        /// The missing state.
        state: u32,
    },
    /// The model structure names a variable that does not exist.
    #[error("model structure: value reference {0} does not exist")]
    Unknown(u32),
    /// A list of the model structure is not the set that the standard demands.
    #[error("model structure: {list} must be {expected:?} and is {found:?}")]
    Structure {
        list: &'static str,
        /// Names that the standard demands.
        expected: Vec<String>,
        /// Names found.
        found: Vec<String>,
    },
    /// The default experiment is not one, or not all of it is stated.
    #[error(
        "default experiment: start {:?} < stop {:?}, step {:?} > 0 and tolerance {:?} > 0 must hold",
        .0.start, .0.stop, .0.step, .0.tolerance
    )]
    Experiment(DefaultExperiment),
    /// Neither interface is offered.
    #[error("an FMU needs Co-Simulation or Model Exchange; switch one on in `capabilities`")]
    NoInterface,
}

impl ModelDescription {
    /// Checks what the standard demands.
    ///
    /// # Errors
    ///
    /// The first demand that is not met, with the variable's name.
    pub fn check(&self) -> Result<(), DescriptionError> {
        self.check_head()?;
        let (mut names, mut references) = (HashSet::from(["time"]), HashSet::from([TIME]));
        for variable in &self.variables {
            if !names.insert(variable.name.as_str()) {
                return Err(DescriptionError::DuplicateName(variable.name.clone()));
            }
            if !references.insert(variable.reference) {
                let (name, reference) = (variable.name.clone(), variable.reference);
                return Err(DescriptionError::DuplicateReference { name, reference });
            }
            check_variable(variable)?;
            self.check_derivative(variable)?;
        }
        self.check_structure(&references)
    }

    fn check_head(&self) -> Result<(), DescriptionError> {
        let identifier = &self.identifier;
        let letters = |c: char| c.is_ascii_alphanumeric() || c == '_';
        if !identifier.chars().all(letters)
            || !identifier.starts_with(|c: char| letters(c) && !c.is_ascii_digit())
        {
            return Err(DescriptionError::Identifier(identifier.clone()));
        }
        check_text("name", &self.name, false)?;
        check_text("description", &self.description, true)?;
        check_text("version", &self.version, true)?;
        check_text("generation tool", &self.generation_tool, true)?;
        let experiment = self.default_experiment;
        let DefaultExperiment { start, stop, tolerance, step } = experiment;
        let stated = [start, stop, tolerance, step].map(|value| value.unwrap_or(f64::NAN));
        let [start, stop, tolerance, step] = stated;
        let finite = stated.iter().all(|value| value.is_finite());
        if !(finite && start < stop && tolerance > 0.0 && step > 0.0) {
            return Err(DescriptionError::Experiment(experiment));
        }
        if !self.capabilities.co_simulation && !self.capabilities.model_exchange {
            return Err(DescriptionError::NoInterface);
        }
        Ok(())
    }

    fn check_derivative(&self, variable: &Variable) -> Result<(), DescriptionError> {
        let Some(state) = variable.derivative_of else { return Ok(()) };
        let continuous =
            |v: &Variable| v.kind == Type::Float64 && v.variability == Variability::Continuous;
        if continuous(variable) && self.variable(state).is_some_and(continuous) {
            return Ok(());
        }
        Err(DescriptionError::State { name: variable.name.clone(), state })
    }

    fn check_structure(&self, references: &HashSet<u32>) -> Result<(), DescriptionError> {
        let structure = &self.structure;
        let lists = [
            &structure.outputs,
            &structure.derivatives,
            &structure.event_indicators,
            &structure.initial_unknowns,
        ];
        for unknown in lists.into_iter().flatten() {
            for reference in unknown.dependencies.iter().chain([&unknown.reference]) {
                if !references.contains(reference) {
                    return Err(DescriptionError::Unknown(*reference));
                }
            }
        }
        let outputs = self.select(|v| v.causality == Causality::Output);
        self.same("outputs", outputs, &structure.outputs)?;
        let derivatives = self.select(|v| v.derivative_of.is_some());
        self.same("derivatives", derivatives, &structure.derivatives)?;
        let states: HashSet<u32> = self.states().into_iter().collect();
        let initial = self.select(|v| {
            v.initial() != Initial::Exact
                && (matches!(v.causality, Causality::Output | Causality::CalculatedParameter)
                    || v.derivative_of.is_some()
                    || states.contains(&v.reference))
        });
        self.same("initial unknowns", initial, &structure.initial_unknowns)
    }

    fn select(&self, keep: impl Fn(&Variable) -> bool) -> Vec<&Variable> {
        self.variables.iter().filter(|variable| keep(variable)).collect()
    }

    fn same(
        &self,
        list: &'static str,
        expected: Vec<&Variable>,
        found: &[Unknown],
    ) -> Result<(), DescriptionError> {
        let mut wanted: Vec<u32> = expected.iter().map(|variable| variable.reference).collect();
        let mut listed: Vec<u32> = found.iter().map(|unknown| unknown.reference).collect();
        wanted.sort_unstable();
        listed.sort_unstable();
        if wanted == listed {
            return Ok(());
        }
        let names = |references: Vec<u32>| {
            let variables = references.into_iter().filter_map(|reference| self.variable(reference));
            variables.map(|variable| variable.name.clone()).collect()
        };
        Err(DescriptionError::Structure { list, expected: names(wanted), found: names(listed) })
    }
}

fn check_text(field: &str, text: &str, may_be_empty: bool) -> Result<(), DescriptionError> {
    if (text.is_empty() && !may_be_empty) || text.chars().any(char::is_control) {
        return Err(DescriptionError::Text { field: field.to_owned(), text: text.to_owned() });
    }
    Ok(())
}

fn check_variable(variable: &Variable) -> Result<(), DescriptionError> {
    use Causality as C;
    use Initial as I;
    use Variability as V;

    check_text("variable name", &variable.name, false)?;
    check_text(&format!("description of {}", variable.name), &variable.description, true)?;
    let name = || variable.name.clone();
    let Variable { causality, variability, kind, start, min, max, nominal, .. } = *variable;
    if !matches!(kind, Type::Float64 | Type::Int32 | Type::Boolean) {
        return Err(DescriptionError::Type { name: name(), kind });
    }
    let initial = variable.initial();
    // A structural parameter needs Configuration Mode, which our FMUs do not have.
    let together =
        causality != C::StructuralParameter && go_together(causality, variability, Some(initial));
    if !together || (kind != Type::Float64 && variability == V::Continuous) {
        let name = name();
        return Err(DescriptionError::Combination { name, causality, variability, initial, kind });
    }
    let typed = start.is_none_or(|value| match kind {
        Type::Float64 => value.is_finite(),
        Type::Int32 => value.fract() == 0.0 && value.abs() <= f64::from(i32::MAX),
        _ => value == 0.0 || value == 1.0,
    });
    if start.is_some() == (initial == I::Calculated) || !typed {
        return Err(DescriptionError::Start { name: name(), start, initial, kind });
    }
    let finite = [min, max, nominal].iter().flatten().all(|value| value.is_finite());
    let lowest = min.unwrap_or(f64::NEG_INFINITY);
    let highest = max.unwrap_or(f64::INFINITY);
    let inside = start.is_none_or(|value| lowest <= value && value <= highest);
    if !finite || lowest > highest || !inside || nominal.is_some_and(|value| value <= 0.0) {
        return Err(DescriptionError::Range { name: name(), min, start, max, nominal });
    }
    Ok(())
}

#[cfg(all(test, feature = "export"))]
mod tests {
    use super::super::tests::description;
    use super::*;

    #[test]
    fn a_sound_description_passes() {
        assert_eq!(description().check(), Ok(()));
    }

    #[test]
    fn each_demand_is_noticed_when_broken() {
        let broken = |change: fn(&mut ModelDescription)| {
            let mut description = description();
            change(&mut description);
            description.check().unwrap_err()
        };
        use DescriptionError as E;
        assert!(matches!(broken(|d| d.identifier = "a b".into()), E::Identifier(_)));
        assert!(matches!(broken(|d| d.name = String::new()), E::Text { .. }));
        assert!(matches!(broken(|d| d.variables[0].description = "\n".into()), E::Text { .. }));
        assert!(matches!(broken(|d| d.variables[1].name = "k".into()), E::DuplicateName(_)));
        assert!(matches!(broken(|d| d.variables[1].name = "time".into()), E::DuplicateName(_)));
        assert!(matches!(broken(|d| d.variables[0].reference = 0), E::DuplicateReference { .. }));
        assert!(matches!(
            broken(|d| d.variables[0].variability = Variability::Continuous),
            E::Combination { .. }
        ));
        assert!(matches!(broken(|d| d.variables[0].kind = Type::String), E::Type { .. }));
        assert!(matches!(broken(|d| d.variables[0].start = None), E::Start { .. }));
        assert!(matches!(broken(|d| d.variables[0].start = Some(f64::NAN)), E::Start { .. }));
        assert!(matches!(broken(|d| d.variables[0].max = Some(0.0)), E::Range { .. }));
        assert!(matches!(broken(|d| d.variables[3].derivative_of = Some(1)), E::State { .. }));
        assert!(matches!(broken(|d| d.structure.outputs[0].dependencies.push(99)), E::Unknown(99)));
        assert!(matches!(broken(|d| d.structure.outputs.clear()), E::Structure { .. }));
        assert!(matches!(broken(|d| d.structure.initial_unknowns.clear()), E::Structure { .. }));
        assert!(matches!(broken(|d| d.default_experiment.step = Some(0.0)), E::Experiment(_)));
        assert!(matches!(
            broken(
                |d| (d.capabilities.co_simulation, d.capabilities.model_exchange) = (false, false)
            ),
            E::NoInterface
        ));
    }
}
