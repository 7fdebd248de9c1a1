//! The initialisation of a connected system: values are passed along the connections until they
//! settle. Without an algebraic loop one pass in the order of the direct feed-through settles them
//! exactly; a loop is iterated as a fixed point `w = g(w)` and reported if it does not contract.

use super::component::Phase;
use super::error::Error;
use super::graph::strong_parts;
use super::run::Wiring;
use super::system::{Source, System};

/// Relative change below which values have settled.
const SETTLED: f64 = 1e-12;
/// Values below this count as large as this: a loop may settle at zero.
const SMALL: f64 = 1e-6;
/// Passes before a loop is given up. A contraction by 0.9 needs about 260 for [`SETTLED`].
const PASSES: usize = 500;

impl System<'_> {
    /// Initialises all components; the algebraic loops that were found, each as its ports.
    pub(super) fn initialize(&mut self, wiring: &mut Wiring) -> Result<Vec<Vec<String>>, Error> {
        let loops = self.algebraic_loops();
        let window = self.experiment.window();
        for component in 0..self.members.len() {
            self.phase(wiring, component, Phase::Enter(window))?;
        }
        // Each pass settles at least the next output of the longest chain without a loop.
        let outputs: usize = self.members.iter().map(|member| member.ports.outputs.len()).sum();
        let passes = if loops.is_empty() { outputs + 1 } else { PASSES };
        let mut change = 0.0;
        for _ in 0..passes {
            change = 0.0;
            for at in 0..wiring.order.len() {
                let component = wiring.order[at];
                let before = wiring.outputs_of(component).to_vec();
                self.gather(wiring, component, window.start);
                self.phase(wiring, component, Phase::Update)?;
                for (before, now) in before.iter().zip(wiring.outputs_of(component)) {
                    let relative = (before - now).abs() / before.abs().max(now.abs()).max(SMALL);
                    // Neither an infinity nor a NaN is a settled value.
                    change = if relative.is_nan() { f64::INFINITY } else { change.max(relative) };
                }
            }
            if change <= SETTLED {
                break;
            }
        }
        if let (Some(cycle), true) = (loops.first(), change > SETTLED) {
            return Err(Error::AlgebraicLoop { cycle: cycle.clone(), passes, change });
        }
        for at in 0..wiring.order.len() {
            let component = wiring.order[at];
            self.gather(wiring, component, window.start);
            self.phase(wiring, component, Phase::Exit)?;
        }
        Ok(loops)
    }

    fn phase(&mut self, wiring: &mut Wiring, component: usize, phase: Phase) -> Result<(), Error> {
        let time = self.experiment.start;
        let member = &mut self.members[component];
        let (inputs, outputs) = wiring.split(component);
        member.component.initialize(phase, inputs, outputs).map_err(|failure| Error::Component {
            component: member.name.clone(),
            time,
            failure,
        })
    }

    /// The loops of direct feed-through, each as the outputs it runs through.
    fn algebraic_loops(&self) -> Vec<Vec<String>> {
        // A node is an output; an edge leads from an output that drives an input to each output that
        // this input acts on at once.
        let first: Vec<usize> = self
            .members
            .iter()
            .scan(0, |sum, member| {
                *sum += member.ports.outputs.len();
                Some(*sum - member.ports.outputs.len())
            })
            .collect();
        let nodes: Vec<(usize, usize)> = self
            .members
            .iter()
            .enumerate()
            .flat_map(|(at, member)| (0..member.ports.outputs.len()).map(move |port| (at, port)))
            .collect();
        let mut edges = Vec::new();
        for (at, member) in self.members.iter().enumerate() {
            for (input, source) in member.sources.iter().enumerate() {
                let Some((Source::Output { component, port, .. }, _)) = source else { continue };
                for output in 0..member.ports.outputs.len() {
                    let acts = match member.ports.feedthrough.get(output) {
                        Some(Some(inputs)) => inputs.contains(&input),
                        _ => true,
                    };
                    if acts {
                        edges.push((first[*component] + port, first[at] + output));
                    }
                }
            }
        }
        let is_loop = |part: &Vec<usize>| part.len() > 1 || edges.contains(&(part[0], part[0]));
        let name = |node: usize| {
            let (component, port) = nodes[node];
            let member = &self.members[component];
            format!("{}.{}", member.name, member.ports.outputs[port].name)
        };
        let parts = strong_parts(nodes.len(), &edges).into_iter();
        parts.filter(is_loop).map(|part| part.into_iter().map(name).collect()).collect()
    }
}
