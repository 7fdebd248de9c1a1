//! Published figures that anyone can measure again.

pub(crate) mod discovery;
mod rate;
