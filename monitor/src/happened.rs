//! What happens while a machine is watched.

use crate::found::Fault;
use crate::method::Method;
use crate::of_bank::Decision;

/// What a row brought.
#[derive(Debug, Clone, PartialEq)]
pub enum Happened {
    /// A method of the residual declares a fault.
    Declared(Method),
    /// A window after the declaration, what the fault is.
    Named(Fault),
    /// The bank decides.
    Decision(Decision),
}
