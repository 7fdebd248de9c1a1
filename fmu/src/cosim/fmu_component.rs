//! An FMU instance as a component.

use crate::import::{Causality, Description, Group, Instance, Progress, State, Type, Variable};

use super::component::{Component, Failure, Phase, Port, PortKind, Ports};

/// An FMU instance as a component: its scalar numeric inputs and outputs are its ports. Parameters are
/// set on the instance before it goes in.
#[derive(Debug)]
pub struct FmuComponent {
    instance: Instance,
    inputs: Option<Group>,
    outputs: Option<Group>,
    saved: Option<State>,
}

impl FmuComponent {
    /// Wraps an instance that has not been initialised yet.
    pub fn new(instance: Instance) -> FmuComponent {
        FmuComponent { instance, inputs: None, outputs: None, saved: None }
    }

    /// The instance.
    pub fn instance(&mut self) -> &mut Instance {
        &mut self.instance
    }

    fn group(&self, causality: Causality, selected: &[usize]) -> Result<Group, Failure> {
        let variables: Vec<&Variable> =
            self.instance.fmu().description().scalars(causality).collect();
        let names: Vec<&str> = selected.iter().map(|port| variables[*port].name.as_str()).collect();
        Ok(self.instance.group(&names)?)
    }

    fn write(&mut self, inputs: &[f64]) -> Result<(), Failure> {
        match &self.inputs {
            Some(group) if !group.is_empty() => Ok(self.instance.write(group, inputs)?),
            _ => Ok(()),
        }
    }

    fn read(&mut self, outputs: &mut [f64]) -> Result<(), Failure> {
        match &self.outputs {
            Some(group) if !group.is_empty() => Ok(self.instance.read(group, outputs)?),
            _ => Ok(()),
        }
    }
}

impl Component for FmuComponent {
    fn ports(&self) -> Ports {
        let description = self.instance.fmu().description();
        let ports =
            |causality| description.scalars(causality).map(|v| port(description, v)).collect();
        Ports {
            inputs: ports(Causality::Input),
            outputs: ports(Causality::Output),
            others: others(description),
            feedthrough: description
                .scalars(Causality::Output)
                .map(|output| feedthrough(description, output))
                .collect(),
            units: description.units.clone(),
        }
    }

    fn select(&mut self, inputs: &[usize], outputs: &[usize]) -> Result<(), Failure> {
        self.inputs = Some(self.group(Causality::Input, inputs)?);
        self.outputs = Some(self.group(Causality::Output, outputs)?);
        Ok(())
    }

    fn initialize(
        &mut self,
        phase: Phase,
        inputs: &[f64],
        outputs: &mut [f64],
    ) -> Result<(), Failure> {
        match phase {
            Phase::Enter(window) => {
                self.instance.enter_initialization(
                    window.start,
                    Some(window.stop),
                    window.tolerance,
                )?;
                self.read(outputs)
            }
            Phase::Update => {
                self.write(inputs)?;
                self.read(outputs)
            }
            Phase::Exit => {
                self.write(inputs)?;
                self.instance.exit_initialization()?;
                self.read(outputs)
            }
        }
    }

    fn step(
        &mut self,
        time: f64,
        step: f64,
        inputs: &[f64],
        outputs: &mut [f64],
    ) -> Result<Progress, Failure> {
        self.write(inputs)?;
        let progress = self.instance.step(time, step)?;
        self.read(outputs)?;
        Ok(progress)
    }

    fn save(&mut self) -> Result<bool, Failure> {
        let kind = self.instance.interface();
        if !self.instance.fmu().description().capabilities(kind).is_some_and(|c| c.state) {
            return Ok(false);
        }
        match &mut self.saved {
            Some(state) => self.instance.save_into(state)?,
            None => self.saved = Some(self.instance.state()?),
        }
        Ok(true)
    }

    fn restore(&mut self) -> Result<(), Failure> {
        if let Some(state) = &self.saved {
            self.instance.restore(state)?;
        }
        Ok(())
    }
}

fn port(description: &Description, variable: &Variable) -> Port {
    let kind = match variable.kind {
        Type::Boolean => PortKind::Boolean,
        Type::Enumeration => PortKind::Enumeration,
        kind if kind.is_float() => PortKind::Float,
        _ => PortKind::Integer,
    };
    let unit = variable.unit.as_ref().map(|name| description.unit_of_name(name));
    Port { name: variable.name.clone(), kind, unit }
}

/// Inputs and outputs that are no scalar numbers.
fn others(description: &Description) -> Vec<(String, String)> {
    let of = |v: &&Variable| matches!(v.causality, Causality::Input | Causality::Output);
    let scalar = |v: &&Variable| v.kind.is_numeric() && v.dimensions.is_empty();
    let what = |v: &Variable| match v.dimensions.is_empty() {
        true => format!("of type {}", v.kind.name()),
        false => format!("an array of {} elements", description.elements(v)),
    };
    let others = description.variables.iter().filter(of).filter(|v| !scalar(v));
    others.map(|v| (v.name.clone(), what(v))).collect()
}

/// Which inputs, by their position among the inputs, act on an output at once.
fn feedthrough(description: &Description, output: &Variable) -> Option<Vec<usize>> {
    let same = |unknown: &&crate::import::Unknown| {
        unknown.variable.is_some_and(|at| description.variables[at].name == output.name)
    };
    let unknown = description.structure.outputs.iter().find(same)?;
    let dependencies = unknown.dependencies.as_ref()?;
    let names: Vec<&str> =
        dependencies.iter().flatten().map(|at| description.variables[*at].name.as_str()).collect();
    let inputs = description.scalars(Causality::Input).enumerate();
    Some(
        inputs
            .filter(|(_, input)| names.contains(&input.name.as_str()))
            .map(|(at, _)| at)
            .collect(),
    )
}
