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

mod candidates;
mod columns;
mod curves;
mod experiment;
mod gates;
mod inverse;
mod inverse_plant;
mod judge;
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
mod whiten;

pub use candidates::NotJudged;
pub use curves::Balance;
pub use experiment::NextExperiment;
pub use inverse::SecondOpinion;
pub use ladder::{add, bic_of, discover};
pub use learned::LearnedCurve;
pub use report::{Coefficient, Discovery, Ranked, Rung, Step, Unwatched, Verdict, Watch};
