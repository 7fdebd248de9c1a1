//! Proof of the integration core: accuracy, order, and the conformance of every effect.

mod battery;
mod conformance;
mod independent;
mod lanes;
mod oracle;
mod order;
mod support;
