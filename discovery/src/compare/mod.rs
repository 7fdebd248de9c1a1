//! Where, and in what way, a model fails.

mod along;

pub use along::Along;
