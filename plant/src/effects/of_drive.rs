//! What an effect of a drive is, whether its law stands in the registry or in the drive file.

use super::custom::Law;
use super::info::Variable;
use super::registry::Entry;
use crate::drive::{EffectData, LawData};

impl EffectData {
    /// The typed law, ready to run; none of an effect of the library or a curve.
    ///
    /// # Panics
    /// Never for an effect that was read from a drive file: its law was parsed there.
    pub fn typed(&self) -> Option<Law> {
        let Some(LawData::Typed { target, text }) = &self.law else { return None };
        let names: Vec<String> = self.parameters.iter().map(|(name, _)| name.clone()).collect();
        Some(Law::parse(*target, text, &names).expect("the law was parsed with the drive file"))
    }

    /// The variables over which a model without the effect fails; none of a curve.
    pub fn fails_over(&self) -> Vec<Variable> {
        let of_library = || Entry::find(&self.kind).map(|entry| entry.info.fails_over.to_vec());
        self.typed().map(|law| law.fails_over()).or_else(of_library).unwrap_or_default()
    }
}
