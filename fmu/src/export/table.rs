//! The description's variables by value reference.

use super::refusal::Refusal;
use crate::description::{ModelDescription, Type, Variable};

/// Variables sorted by value reference, and what the state machine needs of the structure.
#[derive(Debug)]
pub(super) struct Table {
    variables: Vec<Variable>,
    /// The description's token.
    pub(super) token: String,
    /// Nominal value of each continuous state.
    pub(super) nominals: Vec<f64>,
    /// Number of event indicators.
    pub(super) indicators: usize,
}

impl Table {
    /// # Errors
    ///
    /// A description that the standard does not allow.
    pub(super) fn new(description: ModelDescription) -> Result<Self, Refusal> {
        description.check()?;
        let nominal = |reference| description.variable(reference).and_then(|v| v.nominal);
        let nominals = description.states().into_iter().map(|r| nominal(r).unwrap_or(1.0));
        let nominals = nominals.collect();
        let token = description.token();
        let indicators = description.structure.event_indicators.len();
        let mut variables = description.variables;
        variables.sort_unstable_by_key(|variable| variable.reference);
        Ok(Self { variables, token, nominals, indicators })
    }

    /// The variable of a reference, which must be of the kind asked for.
    #[inline]
    pub(super) fn variable(&self, reference: u32, kind: Type) -> Result<&Variable, Refusal> {
        // Not `ok_or`: the drop of a refusal costs more than the search.
        let Some(variable) = self.find(reference) else {
            return Err(Refusal::UnknownReference(reference));
        };
        if variable.kind == kind {
            return Ok(variable);
        }
        Err(wrong_kind(variable, kind.name()))
    }

    /// Refuses a type of which this FMU has no variable.
    pub(super) fn refuse_kind(&self, reference: u32, asked: &'static str) -> Refusal {
        match self.find(reference) {
            Some(variable) => wrong_kind(variable, asked),
            None => Refusal::UnknownReference(reference),
        }
    }

    #[inline]
    fn find(&self, reference: u32) -> Option<&Variable> {
        // References mostly count from 1 without a gap; the search is for the others.
        let guess = (reference as usize).checked_sub(1)?;
        match self.variables.get(guess) {
            Some(variable) if variable.reference == reference => Some(variable),
            _ => {
                let at = self.variables.binary_search_by_key(&reference, |v| v.reference);
                at.ok().map(|index| &self.variables[index])
            }
        }
    }
}

fn wrong_kind(variable: &Variable, asked: &'static str) -> Refusal {
    let Variable { reference, kind, .. } = *variable;
    Refusal::WrongKind { reference, name: variable.name.clone(), kind, asked }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::tests::description;

    #[test]
    fn references_with_gaps_are_found() {
        let mut description = description();
        description.variables[8].reference = 4_000_000_000;
        let table = Table::new(description).unwrap();
        assert_eq!(table.variable(4_000_000_000, Type::Float64).unwrap().name, "g");
        assert_eq!(table.variable(5, Type::Float64).unwrap().name, "y");
        for reference in [0, 9, 10, u32::MAX] {
            let refused = table.variable(reference, Type::Float64);
            assert!(matches!(refused, Err(Refusal::UnknownReference(r)) if r == reference));
        }
        assert_eq!(table.nominals, [5.0]);
    }
}
