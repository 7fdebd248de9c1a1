//! The run: links the system, initialises it and steps it, by Gauss-Seidel or Jacobi.

use drivescope_recording::{Recording, Signal};

use crate::import::{self, Conversion, Held, Progress, recordable};

use super::component::Failure;
use super::error::Error;
use super::graph::strong_parts;
use super::system::{Algorithm, Recorded, Source, System};

/// Why a run ended.
#[derive(Debug, Clone, PartialEq)]
pub enum End {
    /// The stop time was reached.
    Stop,
    /// A component asked to end the simulation.
    Terminated {
        component: String,
        /// When, s.
        time: f64,
    },
    /// A component could not complete a step; the recording ends where the step began.
    Discarded {
        component: String,
        /// Start of the step, s.
        time: f64,
        /// The time that the component reached, s.
        reached: f64,
        /// Whether all components were taken back to the start of the step.
        rolled_back: bool,
    },
}

/// What a run gives.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// What was recorded, named `component.port`: sample `k` lies at `start + k h`.
    pub recording: Recording,
    /// Why it ended.
    pub end: End,
    /// The algebraic loops that were iterated in the initialisation, each as its outputs.
    pub algebraic_loops: Vec<Vec<String>>,
}

/// The values of a linked system: one flat vector of selected inputs and one of outputs.
pub(super) struct Wiring {
    pub(super) order: Vec<usize>,
    jacobi: bool,
    inputs: Vec<f64>,
    outputs: Vec<f64>,
    parts: Vec<Part>,
}

/// One component's share of the vectors.
struct Part {
    inputs: std::ops::Range<usize>,
    outputs: std::ops::Range<usize>,
    /// The source of each of its inputs.
    sources: Vec<Wire>,
    /// Selected outputs, by port.
    ports: Vec<usize>,
}

enum Wire {
    Output(usize, Conversion),
    Signal(Held),
}

impl Wiring {
    pub(super) fn outputs_of(&self, component: usize) -> &[f64] {
        &self.outputs[self.parts[component].outputs.clone()]
    }

    /// The inputs and outputs of one component.
    pub(super) fn split(&mut self, component: usize) -> (&[f64], &mut [f64]) {
        let part = &self.parts[component];
        (&self.inputs[part.inputs.clone()], &mut self.outputs[part.outputs.clone()])
    }
}

impl System<'_> {
    /// Runs the system over its experiment.
    ///
    /// # Errors
    /// An experiment that cannot be run, a component that fails, an algebraic loop that does not
    /// settle. A step that is discarded ends the run, but is no error.
    pub fn run(&mut self) -> Result<Outcome, Error> {
        let wrong = |problem| Error::Experiment { problem };
        let steps = self.experiment.steps().map_err(wrong)?;
        recordable(steps, self.recorded.len()).map_err(wrong)?;
        let mut wiring = self.link()?;
        let algebraic_loops = self.initialize(&mut wiring)?;
        let (start, h) = (self.experiment.start, self.experiment.step);
        let mut rows: Vec<Vec<f64>> =
            self.recorded.iter().map(|_| Vec::with_capacity(steps + 1)).collect();
        let slots = self.slots(&wiring);
        let mut end = End::Stop;
        record(&mut rows, &slots, &wiring, start);
        for k in 0..steps {
            let time = start + k as f64 * h;
            if self.experiment.rollback {
                self.save(time)?;
            }
            match self.step(&mut wiring, time)? {
                None => record(&mut rows, &slots, &wiring, start + (k + 1) as f64 * h),
                Some(last @ End::Terminated { .. }) => {
                    record(&mut rows, &slots, &wiring, start + (k + 1) as f64 * h);
                    end = last;
                    break;
                }
                Some(last) => {
                    end = last;
                    break;
                }
            }
        }
        let signals =
            self.recorded.iter().zip(rows).map(|(recorded, values)| self.signal(recorded, values));
        let recording = Recording::new("co-simulation", start, h, signals.collect());
        Ok(Outcome { recording, end, algebraic_loops })
    }

    /// One communication step; why the run ends with it, if it does.
    fn step(&mut self, wiring: &mut Wiring, time: f64) -> Result<Option<End>, Error> {
        let h = self.experiment.step;
        if wiring.jacobi {
            for component in 0..self.members.len() {
                self.gather(wiring, component, time);
            }
        }
        let mut end = None;
        for at in 0..wiring.order.len() {
            let component = wiring.order[at];
            if !wiring.jacobi {
                self.gather(wiring, component, time);
            }
            let member = &mut self.members[component];
            let (inputs, outputs) = wiring.split(component);
            match member.component.step(time, h, inputs, outputs) {
                Ok(Progress::Continue) => {}
                Ok(Progress::Terminate) => {
                    let component = member.name.clone();
                    end.get_or_insert(End::Terminated { component, time: time + h });
                }
                Err(failure) => {
                    let component = member.name.clone();
                    let Some(reached) = discarded(&failure) else {
                        return Err(Error::Component { component, time, failure });
                    };
                    let rolled_back = self.experiment.rollback;
                    if rolled_back {
                        self.restore(time)?;
                    }
                    return Ok(Some(End::Discarded { component, time, reached, rolled_back }));
                }
            }
        }
        Ok(end)
    }

    /// Fetches the inputs of one component from what drives them.
    pub(super) fn gather(&self, wiring: &mut Wiring, component: usize, time: f64) {
        let Wiring { inputs, outputs, parts, .. } = wiring;
        let part = &parts[component];
        for (input, wire) in inputs[part.inputs.clone()].iter_mut().zip(&part.sources) {
            *input = match wire {
                Wire::Output(from, conversion) => conversion.apply(outputs[*from]),
                Wire::Signal(held) => held.at(time),
            };
        }
    }

    fn save(&mut self, time: f64) -> Result<(), Error> {
        for member in &mut self.members {
            let component = || member.name.clone();
            match member.component.save() {
                Ok(true) => {}
                Ok(false) => return Err(Error::NoRollback { component: component() }),
                Err(failure) => {
                    return Err(Error::Component { component: component(), time, failure });
                }
            }
        }
        Ok(())
    }

    fn restore(&mut self, time: f64) -> Result<(), Error> {
        for member in &mut self.members {
            let restored = member.component.restore();
            restored.map_err(|failure| Error::Component {
                component: member.name.clone(),
                time,
                failure,
            })?;
        }
        Ok(())
    }

    /// Selects the ports that are used and lays out their values.
    fn link(&mut self) -> Result<Wiring, Error> {
        let mut used: Vec<Vec<usize>> = vec![Vec::new(); self.members.len()];
        for recorded in &self.recorded {
            if recorded.signal.is_none() {
                used[recorded.component].push(recorded.port);
            }
        }
        for source in self.members.iter().flat_map(|member| &member.sources).flatten() {
            if let (Source::Output { component, port, .. }, _) = source {
                used[*component].push(*port);
            }
        }
        let mut first = 0;
        let mut outputs = Vec::new();
        for ports in &mut used {
            ports.sort_unstable();
            ports.dedup();
            outputs.push(first..first + ports.len());
            first += ports.len();
        }
        let slot = |component: usize, port: usize| {
            outputs[component].start + used[component].partition_point(|other| *other < port)
        };
        let mut parts = Vec::new();
        let mut input = 0;
        for (member, (ports, outputs)) in self.members.iter().zip(used.iter().zip(&outputs)) {
            let sources = member.sources.iter().flatten().map(|(source, _)| match source {
                Source::Output { component, port, conversion } => {
                    Wire::Output(slot(*component, *port), *conversion)
                }
                Source::Signal(held) => Wire::Signal(held.clone()),
            });
            let sources: Vec<Wire> = sources.collect();
            let inputs = input..input + sources.len();
            input = inputs.end;
            parts.push(Part { inputs, outputs: outputs.clone(), sources, ports: ports.clone() });
        }
        let time = self.experiment.start;
        for (member, ports) in self.members.iter_mut().zip(&used) {
            let driven = (0..member.sources.len()).filter(|input| member.sources[*input].is_some());
            let driven: Vec<usize> = driven.collect();
            let selected = member.component.select(&driven, ports);
            selected.map_err(|failure| Error::Component {
                component: member.name.clone(),
                time,
                failure,
            })?;
        }
        let (order, jacobi) = (self.order()?, self.experiment.algorithm == Algorithm::Jacobi);
        Ok(Wiring { order, jacobi, inputs: vec![0.0; input], outputs: vec![0.0; first], parts })
    }

    /// The order in which components step.
    fn order(&self) -> Result<Vec<usize>, Error> {
        if let Algorithm::GaussSeidelIn(names) = &self.experiment.algorithm {
            let wrong = |name: &str, problem| Error::Order { name: name.to_owned(), problem };
            let mut order = Vec::new();
            for name in names {
                let at = self.members.iter().position(|member| member.name == *name);
                let at = at.ok_or_else(|| wrong(name, "unknown"))?;
                if order.contains(&at) {
                    return Err(wrong(name, "named twice"));
                }
                order.push(at);
            }
            let missing = (0..self.members.len()).find(|at| !order.contains(at));
            return missing.map_or(Ok(order), |at| Err(wrong(&self.members[at].name, "missing")));
        }
        let mut edges = Vec::new();
        for (at, member) in self.members.iter().enumerate() {
            for source in member.sources.iter().flatten() {
                if let (Source::Output { component, .. }, _) = source {
                    edges.push((*component, at));
                }
            }
        }
        Ok(strong_parts(self.members.len(), &edges).concat())
    }

    fn slots(&self, wiring: &Wiring) -> Vec<Slot> {
        let of = |recorded: &Recorded| match &recorded.signal {
            Some(held) => Slot::Signal(held.clone()),
            None => {
                let part = &wiring.parts[recorded.component];
                let at = part.ports.partition_point(|port| *port < recorded.port);
                Slot::Output(part.outputs.start + at)
            }
        };
        self.recorded.iter().map(of).collect()
    }

    fn signal(&self, recorded: &Recorded, values: Vec<f64>) -> Signal {
        let member = &self.members[recorded.component];
        let port = match recorded.signal {
            None => &member.ports.outputs[recorded.port],
            Some(_) => &member.ports.inputs[recorded.port],
        };
        let unit = port.unit.as_ref().map_or("1".to_owned(), |unit| unit.name.clone());
        Signal { name: format!("{}.{}", member.name, port.name), unit, values }
    }
}

/// The time that a component reached in a step that it discarded, s.
fn discarded(failure: &Failure) -> Option<f64> {
    match failure {
        Failure::Fmu(error) => match **error {
            import::Error::Discard { reached, .. } => Some(reached),
            _ => None,
        },
        Failure::Participant(_) => None,
    }
}

/// Where a recorded value is found.
enum Slot {
    Output(usize),
    Signal(Held),
}

fn record(rows: &mut [Vec<f64>], slots: &[Slot], wiring: &Wiring, time: f64) {
    for (row, slot) in rows.iter_mut().zip(slots) {
        row.push(match slot {
            Slot::Output(at) => wiring.outputs[*at],
            Slot::Signal(held) => held.at(time),
        });
    }
}
