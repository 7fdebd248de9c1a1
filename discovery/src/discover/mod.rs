//! Which physical effect is missing.
//!
//! ```text
//!  base drive, fitted ──> screen: gain of every effect of the library, one linear step
//!         ^                 └─> refit: the best five, everything free
//!         │                       └─> gates: BIC, validation data, block-robust test, shape
//!         └──── added <── named ──────┘└─> nothing passes: a learned curve (unknown), or none
//! ```
//!
//! Ranks and tests are made in innovations ([`whiten`]): what of a residual its own past does not
//! foretell, so that a random load does not count as many independent values.
//!
//! The other rule ([`Rule::Evidence`], [`weighed`]) decides by the evidence of one model of what is
//! missing ([`crate::likelihood`]) in the place of screen and gates.

mod candidates;
mod columns;
mod curves;
mod decision;
mod experiment;
mod gates;
mod inverse;
mod inverse_plant;
mod judge;
mod knocking;
mod ladder;
mod learned;
mod left;
mod other_machine;
mod phase;
mod projection;
mod refined;
mod refit;
mod report;
mod ripple;
mod round;
mod scales;
mod screen;
mod sight;
mod smooth;
mod taken_back;
mod typed;
mod unusable;
mod weighed;
mod whiten;

pub use candidates::NotJudged;
pub use curves::Balance;
pub use experiment::NextExperiment;
pub use inverse::SecondOpinion;
pub use ladder::{Rule, add, bic_of, discover, discover_by};
pub use learned::LearnedCurve;
pub use report::{Coefficient, Discovery, Ranked, Rung, Step, Unwatched, Verdict, Watch};

pub(crate) use candidates::Candidate;
pub(crate) use curves::{Curve, curves};
pub(crate) use refit::Model;
pub(crate) use ripple::Trajectory;
pub(crate) use scales::Scales;
