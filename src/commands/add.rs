//! `add`: one effect that the user chooses, fitted; the error before and after.

use std::path::PathBuf;

use clap::Args;
use drivescope_discovery::add;
use drivescope_plant::effects::registry::REGISTRY;
use drivescope_plant::file::{CUSTOM, LEARNED};

use super::Run;
use super::discover::Search;
use crate::drive_source;
use crate::evidence::EvidenceOptions;
use crate::failure::{Ending, Failure};
use crate::formula_text::{self, PREFIX};
use crate::session::Session;

/// Add one effect to a drive, fit everything, and print the error before and after.
#[derive(Debug, Args)]
pub(crate) struct Add {
    /// Drive file, or a built-in drive (`dr300`, `emps`).
    drive: String,
    /// The effect (`drivescope effects` lists them), `learned`: the curve that describes best
    /// what the drive lacks, the id of a law that you typed in the drive file with its
    /// coefficients at 0, or a formula: `"formula:torque = c * omega^3"`.
    effect: String,
    /// Drive file to write (.toml): the given one with the effect, its comments kept.
    #[arg(short, long, value_name = "DRIVE")]
    output: PathBuf,
    /// Report to write (.html): the ladder, parameters, and where the model fails then.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    #[command(flatten)]
    evidence: EvidenceOptions,
}

impl Run for Add {
    fn run(self, session: &Session) -> miette::Result<Ending> {
        let base = drive_source::drive(&self.drive)?;
        if self.effect == CUSTOM {
            return Err(Failure::Usage {
                what: format!("`{CUSTOM}` is a law that you type in the drive file"),
                instead: "write it there with its coefficients at 0 and add it by its id; \
                          `drivescope effects custom` shows how"
                    .to_owned(),
            }
            .into());
        }
        let mut with = base.clone();
        if let Some(text) = self.effect.strip_prefix(PREFIX) {
            with.effects.push(formula_text::effect(text, &base)?);
        }
        let typed = base.effects.iter().any(|it| it.law.is_some() && it.id == self.effect);
        let registered = REGISTRY.iter().any(|it| it.info.id == self.effect);
        let proposed = with.effects.get(base.effects.len()).map(|it| it.id.clone());
        let effect = proposed.as_ref().unwrap_or(&self.effect);
        if effect != LEARNED && !registered && !typed && proposed.is_none() {
            let known: Vec<&str> = REGISTRY.iter().map(|it| it.info.id).chain([LEARNED]).collect();
            let (id, known) = (effect.clone(), known.join(", "));
            return Err(Failure::UnknownEffect { id, known }.into());
        }
        let search = Search {
            added: true,
            given: &self.drive,
            base: &base,
            output: Some(&self.output),
            report: self.out.as_ref(),
            evidence: &self.evidence,
        };
        search.run(session, |_, estimation, validation, watch| {
            add(&with, effect, estimation, validation, watch)
        })
    }
}
