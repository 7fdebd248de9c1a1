//! Published figures that anyone can measure again.

pub(crate) mod discovery;
mod rate;
pub(crate) mod speed;
