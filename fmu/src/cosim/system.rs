//! A system: components, what connects them, what drives them and what is recorded.

use std::sync::Arc;

use drivescope_recording::Recording;

use crate::import::{
    Conversion, ExperimentProblem, Held, Unit, convert, from_recorded, nearest, steps,
};

use super::component::{Component, Port, PortKind, Ports, Window};
use super::error::Error;

/// How components exchange values within a step.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Algorithm {
    /// One after the other, each with the newest outputs; in the order of the connections.
    #[default]
    GaussSeidel,
    /// The same in an order of one's own, which names each component once.
    GaussSeidelIn(Vec<String>),
    /// All with the outputs at the start of the step.
    Jacobi,
}

/// What is to be run.
#[derive(Debug, Clone, PartialEq)]
pub struct Experiment {
    /// Start time, s.
    pub start: f64,
    /// Stop time, s.
    pub stop: f64,
    /// Communication step size, s.
    pub step: f64,
    /// Relative tolerance for what components solve themselves, if stated.
    pub tolerance: Option<f64>,
    /// How values are exchanged.
    pub algorithm: Algorithm,
    /// Save all components before each step, and go back when one discards its step. All must be
    /// able to.
    pub rollback: bool,
}

impl Experiment {
    /// From `start` to `stop` in steps of `step` (all s), by Gauss-Seidel.
    pub fn new(start: f64, stop: f64, step: f64) -> Experiment {
        let algorithm = Algorithm::default();
        Experiment { start, stop, step, tolerance: None, algorithm, rollback: false }
    }

    pub(super) fn window(&self) -> Window {
        Window { start: self.start, stop: self.stop, tolerance: self.tolerance }
    }

    /// The number of steps: the last one ends at or just before the stop time.
    pub(crate) fn steps(&self) -> Result<usize, ExperimentProblem> {
        steps(self.start, self.stop, self.step)
    }
}

/// Where the value of an input comes from.
#[derive(Debug, Clone)]
pub(super) enum Source {
    /// An output of a component.
    Output { component: usize, port: usize, conversion: Conversion },
    /// A recorded signal.
    Signal(Held),
}

pub(super) struct Member<'a> {
    pub(super) name: String,
    pub(super) component: Box<dyn Component + 'a>,
    pub(super) ports: Ports,
    /// The source of each input, if it has one, and how it was written.
    pub(super) sources: Vec<Option<(Source, String)>>,
}

/// What is recorded: a port, and for an input the signal that drives it.
pub(super) struct Recorded {
    pub(super) component: usize,
    pub(super) port: usize,
    pub(super) signal: Option<Held>,
}

/// Connected components, ready to be run.
pub struct System<'a> {
    pub(super) experiment: Experiment,
    pub(super) members: Vec<Member<'a>>,
    pub(super) recorded: Vec<Recorded>,
}

impl<'a> System<'a> {
    /// An empty system.
    pub fn new(experiment: Experiment) -> System<'a> {
        System { experiment, members: Vec::new(), recorded: Vec::new() }
    }

    /// The experiment.
    pub fn experiment(&self) -> &Experiment {
        &self.experiment
    }

    /// Adds a component. A component that is borrowed (`&mut`) can be looked into after the run.
    ///
    /// # Errors
    /// The name is taken.
    pub fn add(&mut self, name: &str, component: impl Component + 'a) -> Result<(), Error> {
        if self.members.iter().any(|member| member.name == name) {
            return Err(Error::Twice { name: name.to_owned() });
        }
        let component = Box::new(component);
        let ports = component.ports();
        let sources = vec![const { None }; ports.inputs.len()];
        self.members.push(Member { name: name.to_owned(), component, ports, sources });
        Ok(())
    }

    /// Connects an output to an input, both written `component.port`. Units are converted.
    ///
    /// # Errors
    /// Ports that do not exist, of different types, or with units that do not convert; an input that
    /// has a source.
    pub fn connect(&mut self, from: &str, to: &str) -> Result<(), Error> {
        self.connect_scaled(from, to, Conversion::IDENTITY)
    }

    /// As [`connect`](System::connect), with a scaling of one's own after the conversion of units.
    ///
    /// # Errors
    /// As [`connect`](System::connect).
    pub fn connect_scaled(
        &mut self,
        from: &str,
        to: &str,
        scaling: Conversion,
    ) -> Result<(), Error> {
        self.connect_as(from, to, scaling, true)
    }

    /// As [`connect_scaled`](System::connect_scaled) without a conversion of units: the scaling is all.
    pub(super) fn connect_unconverted(
        &mut self,
        from: &str,
        to: &str,
        scaling: Conversion,
    ) -> Result<(), Error> {
        self.connect_as(from, to, scaling, false)
    }

    fn connect_as(
        &mut self,
        from: &str,
        to: &str,
        scaling: Conversion,
        converts: bool,
    ) -> Result<(), Error> {
        let (component, port) = self.output(from)?;
        let (target, input) = self.input_port(to)?;
        let source = &self.members[component].ports.outputs[port];
        let sink = &self.members[target].ports.inputs[input];
        if source.kind != sink.kind {
            let (from, to) = (from.to_owned(), to.to_owned());
            return Err(Error::Kind { from, from_kind: source.kind, to, to_kind: sink.kind });
        }
        let conversion = if converts {
            convert(source.unit.as_ref(), sink.unit.as_ref())
                .ok_or_else(|| unit_error(from, source.unit.as_ref(), to, sink))?
        } else {
            Conversion::IDENTITY
        };
        let conversion = conversion.then(scaling);
        self.drive(target, input, Source::Output { component, port, conversion }, from, to)
    }

    /// Drives an input with a signal of a recording, held between its samples. A unit that the
    /// component defines is converted; a signal without unit (`1`) is taken as it is.
    ///
    /// # Errors
    /// No such signal or input, no sample, units that do not convert, an input that has a source.
    pub fn input(
        &mut self,
        recording: &Arc<Recording>,
        signal: &str,
        to: &str,
    ) -> Result<(), Error> {
        let (target, input) = self.input_port(to)?;
        let at = recording.signals.iter().position(|other| other.name == signal);
        let at = at.ok_or_else(|| Error::NoSignal {
            recording: recording.name.clone(),
            signal: signal.to_owned(),
            there: recording.signals.iter().map(|signal| signal.name.clone()).collect(),
        })?;
        if recording.is_empty() {
            return Err(Error::EmptyRecording { recording: recording.name.clone() });
        }
        let member = &self.members[target];
        let sink = &member.ports.inputs[input];
        let unit = &recording.signals[at].unit;
        let conversion = from_recorded(unit, sink.unit.as_ref(), &member.ports.units);
        let from = format!("{}: {signal}", recording.name);
        let conversion = conversion.ok_or_else(|| {
            unit_error(&from, Some(&Unit { name: unit.clone(), base: None }), to, sink)
        })?;
        let held = Held::new(Arc::clone(recording), at, conversion);
        self.drive(target, input, Source::Signal(held), &from, to)
    }

    /// Records an output, or an input that a recording drives. Written `component.port`.
    ///
    /// # Errors
    /// No such port, or an input that another component drives.
    pub fn record(&mut self, path: &str) -> Result<(), Error> {
        let recorded = match self.output(path) {
            Ok((component, port)) => Recorded { component, port, signal: None },
            Err(no_output) => {
                let Ok((component, port)) = self.input_port(path) else { return Err(no_output) };
                match &self.members[component].sources[port] {
                    Some((Source::Signal(held), _)) => {
                        Recorded { component, port, signal: Some(held.clone()) }
                    }
                    Some((Source::Output { .. }, source)) => {
                        let (path, source_path) = (path.to_owned(), source.clone());
                        return Err(Error::RecordInput { path, source_path });
                    }
                    None => return Err(no_output),
                }
            }
        };
        self.record_once(recorded);
        Ok(())
    }

    /// Records all outputs of all components.
    pub fn record_all(&mut self) {
        for component in 0..self.members.len() {
            for port in 0..self.members[component].ports.outputs.len() {
                self.record_once(Recorded { component, port, signal: None });
            }
        }
    }

    /// Inputs and outputs that are no scalar numbers, written `component.port`, each with what it is.
    pub fn left_out(&self) -> Vec<String> {
        let of = |member: &Member| {
            let name = |(port, what): &(String, String)| format!("{}.{port} ({what})", member.name);
            member.ports.others.iter().map(name).collect::<Vec<_>>()
        };
        self.members.iter().flat_map(of).collect()
    }

    fn record_once(&mut self, new: Recorded) {
        let key = |r: &Recorded| (r.component, r.port, r.signal.is_some());
        if !self.recorded.iter().any(|recorded| key(recorded) == key(&new)) {
            self.recorded.push(new);
        }
    }

    fn drive(
        &mut self,
        target: usize,
        input: usize,
        source: Source,
        from: &str,
        to: &str,
    ) -> Result<(), Error> {
        let place = &mut self.members[target].sources[input];
        if let Some((_, first)) = place {
            let (input, second) = (to.to_owned(), from.to_owned());
            return Err(Error::TwoSources { input, first: first.clone(), second });
        }
        *place = Some((source, from.to_owned()));
        Ok(())
    }

    fn output(&self, path: &str) -> Result<(usize, usize), Error> {
        self.port(path, "output", |ports| &ports.outputs)
    }

    fn input_port(&self, path: &str) -> Result<(usize, usize), Error> {
        self.port(path, "input", |ports| &ports.inputs)
    }

    /// The component is what stands before the first dot that ends a component's name: names of FMU
    /// variables have dots of their own.
    fn port(
        &self,
        path: &str,
        what: &'static str,
        of: impl Fn(&Ports) -> &[Port],
    ) -> Result<(usize, usize), Error> {
        let (name, _) =
            path.split_once('.').ok_or_else(|| Error::NoPath { path: path.to_owned() })?;
        let split =
            |member: &Member| Some(path.strip_prefix(&member.name)?.strip_prefix('.')?.to_owned());
        let found =
            self.members.iter().enumerate().find_map(|(at, member)| Some((at, split(member)?)));
        let (component, port) = found.ok_or_else(|| Error::NoComponent {
            name: name.to_owned(),
            path: path.to_owned(),
            there: self.members.iter().map(|member| member.name.clone()).collect(),
        })?;
        let ports = of(&self.members[component].ports);
        let at = ports.iter().position(|other| other.name == port);
        let others = &self.members[component].ports.others;
        if let (None, Some((_, what))) = (at, others.iter().find(|(name, _)| *name == port)) {
            let component = self.members[component].name.clone();
            return Err(Error::NotScalar { component, port, what: what.clone() });
        }
        let at = at.ok_or_else(|| Error::NoPort {
            component: self.members[component].name.clone(),
            what,
            near: nearest(&port, ports.iter().map(|port| port.name.as_str())).map(str::to_owned),
            port,
        })?;
        Ok((component, at))
    }
}

fn unit_error(from: &str, from_unit: Option<&Unit>, to: &str, sink: &Port) -> Error {
    let name = |unit: Option<&Unit>| unit.map_or("1".to_owned(), |unit| unit.name.clone());
    Error::Unit {
        from: from.to_owned(),
        from_unit: name(from_unit),
        to: to.to_owned(),
        to_unit: name(sink.unit.as_ref()),
    }
}

impl Port {
    /// A floating-point port without unit.
    pub fn float(name: &str) -> Port {
        Port { name: name.to_owned(), kind: PortKind::Float, unit: None }
    }
}
