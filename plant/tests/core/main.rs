//! Proof of the integration core: accuracy, order, and the conformance of every effect.

mod independent;
mod oracle;
mod support;
