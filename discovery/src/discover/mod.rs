//! Which physical effect is missing.
//!
//! ```text
//!  base drive, fitted ──> weigh: evidence of every effect of the library and of free curves
//!         ^                 └─> at their best: those that are promising, fitted in the filter
//!         │                       └─> named by evidence and size; the free run has the last word
//!         └──── added <── named ──────┘└─> nothing is named: a learned curve (unknown), or none
//! ```
//!
//! Evidence is that of one model of what is missing, a random load in it ([`crate::likelihood`]).

mod account;
mod at_best;
mod by_free_run;
mod by_torque;
mod candidate;
mod candidates;
mod chosen;
mod columns;
mod curves;
mod decision;
mod experiment;
mod form;
mod free_run;
mod ground;
mod judged;
mod knocking;
mod ladder;
mod learned;
mod naming;
mod needless;
mod not_judged;
mod other_machine;
mod probability;
mod refit;
mod report;
mod round;
mod spans;
mod two_masses;
mod typed;
mod unusable;
mod whiten;
mod withdrawn;

pub use chosen::{add, bic_of};
pub use curves::Balance;
pub use decision::{Rule, RuleNumber};
pub use experiment::NextExperiment;
pub use ladder::{discover, discover_by};
pub use learned::LearnedCurve;
pub use not_judged::NotJudged;
pub use report::{
    Coefficient, Discovery, LadderStep, Oscillation, RandomLoad, Ranked, Step, Unfitted, Unwatched,
    Verdict, Watch,
};

pub(crate) use candidate::Candidate;
pub(crate) use curves::{Curve, Trajectory, curves};
pub(crate) use refit::Model;
