//! Whether an effect can stand in a drive: what it needs, and what it cannot stand beside.

use thiserror::Error;

use super::info::Info;
use super::registry::{Entry, Kind};
use crate::drive::{Drive, Input, Motion};

/// Why an effect cannot stand in a drive, and what to do instead.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum Refusal {
    /// It needs the armature circuit.
    #[error(
        "it needs the armature circuit, and a force-driven drive has none (`input = \"force\"`); \
         remove it, or set `input = \"voltage\"`"
    )]
    NoCircuit,
    /// It goes by the revolution.
    #[error(
        "it goes by the revolution, and a linear drive has none (`motion = \"linear\"`); remove \
         it, or take `cogging` with N = 2 pi over the spatial period in m"
    )]
    NoRevolution,
    /// It holds u back, and a continuous controller has no u that is held.
    #[error("the controller is continuous; remove it, or give the controller a `period`")]
    ContinuousControl,
    /// It is the same part of the drive as another effect.
    #[error("it and `{other}` are one part of the drive; remove one of them")]
    Excluded {
        /// Name of the other in the drive.
        other: String,
    },
}

impl Info {
    /// Why no drive of that motion and input can have the effect.
    pub fn impossible(&self, motion: Motion, input: Input) -> Option<Refusal> {
        if self.electrical && input == Input::Force {
            Some(Refusal::NoCircuit)
        } else if self.rotary && motion == Motion::Linear {
            Some(Refusal::NoRevolution)
        } else {
            None
        }
    }

    /// The first place among effects of those kinds that this one cannot stand beside.
    pub fn excluded_by<'a>(&self, mut kinds: impl Iterator<Item = &'a str>) -> Option<usize> {
        kinds.position(|kind| self.excludes.contains(&kind))
    }
}

impl Drive {
    /// Why the effect cannot be added to this drive (under a name of its own).
    pub fn refuses(&self, entry: &Entry) -> Option<Refusal> {
        let continuous = self.controller.is_some_and(|controller| controller.period.is_none());
        if entry.kind == Kind::Delay && continuous {
            return Some(Refusal::ContinuousControl);
        }
        entry.info.impossible(self.motion, self.motor.input).or_else(|| {
            let kinds = self.effects.iter().map(|effect| effect.kind.as_str());
            let other = entry.info.excluded_by(kinds)?;
            Some(Refusal::Excluded { other: self.effects[other].id.clone() })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{DR300, EMPS, drive};

    fn refused(text: &str, id: &str) -> Option<Refusal> {
        drive(text).refuses(Entry::find(id).expect("it is registered"))
    }

    #[test]
    fn a_drive_refuses_what_it_cannot_have() {
        for id in ["brush_drop", "unbalance", "cogging", "winding_heating"] {
            assert_eq!(refused(DR300, id), None, "{id}");
        }
        assert_eq!(refused(EMPS, "brush_drop"), Some(Refusal::NoCircuit));
        assert_eq!(refused(EMPS, "unbalance"), Some(Refusal::NoRevolution));
        assert_eq!(refused(EMPS, "cogging"), None);
        assert_eq!(refused(DR300, "delay"), None);
        let continuous = DR300.replace("period = 0.005", "").replace("\"controller.period\"", "#");
        assert_eq!(refused(&continuous, "delay"), Some(Refusal::ContinuousControl));
        let coupled = format!(
            "{DR300}\n[[effect]]\nkind = \"flexible_coupling\"\nid = \"belt\"\nk = 1\nd = 0\n\
             ratio = 0.5\n"
        );
        let other = "belt".to_owned();
        assert_eq!(refused(&coupled, "flexible_coupling"), Some(Refusal::Excluded { other }));
        // A law may well be there twice under two names.
        assert_eq!(refused(&coupled, "stribeck"), None);
    }
}
