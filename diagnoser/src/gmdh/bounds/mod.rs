//! Feasible parameter sets of bounded-error estimation, and what they say about outputs.
//!
//! The parameters that the data allow form a polytope, or, with errors in the regressors, one
//! polytope in every orthant of p: within an orthant, p_i e_i is extreme at a known end of e_i's
//! bounds, and (15) is linear. An interval is conditional on the orthants that were asked for:
//! that of the least-squares estimate, or all of them, which is exact. The extremes (12) of
//! r^T p over a set are found at its vertices, here by walking along edges from the last one, or
//! by a linear program over its facets; both agree.

mod corners;
mod equations;
mod frame;
mod inequalities;
mod lp;
mod polytope;
mod regressor;
mod set;

pub(super) use self::corners::Corners;
pub(super) use self::equations::Equations;
pub use self::regressor::{BoundError, Regressor};
pub use self::set::{ParameterSet, Part};
