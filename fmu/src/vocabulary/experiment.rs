//! The experiment that an FMU proposes.

#[cfg(feature = "import")]
use roxmltree::Node;

#[cfg(feature = "import")]
use crate::position::DocumentProblem;
#[cfg(feature = "export")]
use crate::xml::element::{Element, number};
#[cfg(feature = "import")]
use crate::xml::read::value;

/// The default experiment: what an importer simulates when it is told nothing. All of it may go
/// unsaid; times in s.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DefaultExperiment {
    /// Start time.
    pub start: Option<f64>,
    /// Stop time, after the start.
    pub stop: Option<f64>,
    /// Relative tolerance, > 0.
    pub tolerance: Option<f64>,
    /// Communication step size, > 0.
    pub step: Option<f64>,
}

impl DefaultExperiment {
    /// The `<DefaultExperiment>` of a model description.
    #[cfg(feature = "export")]
    pub(crate) fn element(&self) -> Element {
        Element::new("DefaultExperiment")
            .maybe("startTime", self.start.map(number))
            .maybe("stopTime", self.stop.map(number))
            .maybe("tolerance", self.tolerance.map(number))
            .maybe("stepSize", self.step.map(number))
    }

    /// A `<DefaultExperiment>`.
    #[cfg(feature = "import")]
    pub(crate) fn read(node: Node) -> Result<Self, DocumentProblem> {
        Ok(Self {
            start: value(node, "startTime")?,
            stop: value(node, "stopTime")?,
            tolerance: value(node, "tolerance")?,
            step: value(node, "stepSize")?,
        })
    }
}
