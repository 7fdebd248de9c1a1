//! An effect that these recordings cannot judge.

use super::candidate::Candidate;

/// An effect that is not judged, and why.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct NotJudged {
    pub effect: String,
    /// Why, for a person.
    pub reason: String,
    /// Whether a person should hear of it unasked: other recordings could show it, or it is a law
    /// that the user typed.
    #[serde(skip)]
    pub worth_saying: bool,
}

impl NotJudged {
    /// The base parameters imitate it.
    pub(super) fn imitated(candidate: &Candidate) -> Self {
        Self {
            effect: candidate.name.clone(),
            reason: "on these recordings it equals other values of the base parameters".to_owned(),
            worth_saying: candidate.is_typed(),
        }
    }

    /// The torque of a known motion does not tell of it.
    pub(super) fn untold(candidate: &Candidate) -> Self {
        Self {
            effect: candidate.name.clone(),
            reason: "it shows in the motion, and here the torque is judged along the motion that \
                     was measured"
                .to_owned(),
            worth_saying: false,
        }
    }

    /// The model has no finite run or derivative with it.
    pub(super) fn overflowing(candidate: &Candidate) -> Self {
        Self {
            effect: candidate.name.clone(),
            reason: "it or its derivative divides by zero or overflows on these recordings"
                .to_owned(),
            worth_saying: true,
        }
    }
}
