//! A new step: judged on every recording, and compared.

use drivescope_discovery::compare::{Options, compare};
use drivescope_discovery::{
    Discovery, Estimate, Evidence, Fitted, NotIdentifiable, Setting, evaluate, output_fits,
    unexplained,
};
use drivescope_plant::drive::Drive;

use super::basis::Basis;
use super::progress::Progress;
use super::session_step::SessionStep;
use crate::answer::compare::{OfStep, Setting as About};
use crate::evidence::Gathered;
use crate::failure::into_report;

/// What an estimate says of a drive.
pub(super) struct Drawn {
    pub(super) parameters: Vec<Estimate>,
    /// What the recordings do not tell.
    pub(super) not_identifiable: Vec<NotIdentifiable>,
    /// Whether they were estimated, or typed.
    pub(super) fitted: bool,
}

impl From<Fitted> for Drawn {
    fn from(fitted: Fitted) -> Self {
        let Fitted { parameters, not_identifiable, .. } = fitted;
        Self { parameters, not_identifiable, fitted: true }
    }
}

impl From<Discovery> for Drawn {
    fn from(found: Discovery) -> Self {
        let Discovery { parameters, .. } = found;
        Self { parameters, not_identifiable: Vec::new(), fitted: true }
    }
}

/// What is known of a step before it is judged.
pub(super) struct Fresh {
    /// The step that it is made from.
    pub(super) parent: Option<usize>,
    /// What is done.
    pub(super) label: String,
    /// The command line that does the same.
    pub(super) command: String,
    /// The drive file.
    pub(super) text: String,
}

impl Fresh {
    /// The step, judged and compared.
    ///
    /// # Errors
    /// The user cancelled it, the text is no drive file, or the model overflows.
    pub(super) fn step(
        self,
        drawn: Drawn,
        setting: Setting,
        basis: &Basis,
        progress: &Progress,
    ) -> miette::Result<SessionStep> {
        let Drawn { parameters, not_identifiable, fitted } = drawn;
        // What is shown is what the file holds, to its last digit.
        let drive = Drive::parse(&self.text, "the drive of this step").map_err(into_report)?;
        progress.doing("looking where the model fails")?;
        let error = |evidence: &Evidence| {
            let judged = evaluate(&drive, evidence, &setting, true).map_err(into_report)?;
            let fits = output_fits(&drive, evidence, &setting, &judged.recordings);
            Ok::<_, miette::Report>((judged.squares.error(), fits))
        };
        let (estimation, validation) = (&basis.gathered.estimation, &basis.gathered.validation);
        let ((error, _), (validation_error, fits)) = (error(estimation)?, error(validation)?);
        let options = Options { curves: true, seed: basis.seed, fit: true };
        let compared = compare(&drive, &basis.whole, &setting, &options).map_err(into_report)?;
        let Gathered { noise, doubts, .. } = &*basis.gathered;
        let judged = Some(validation_error);
        let mut about = About::new(&drive, &basis.whole, &noise[0], judged, doubts, basis.seed);
        about.step = Some(OfStep { estimation_error: error, fitted });
        let Self { parent, label, command, text } = self;
        Ok(SessionStep {
            unexplained: unexplained(&drive, validation).into(),
            fits,
            parent,
            label,
            command,
            drive,
            text,
            setting,
            parameters,
            not_identifiable,
            error,
            validation_error,
            compared,
            about,
        })
    }
}
