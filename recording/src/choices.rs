//! What a column may be said to be, in words.

use drivescope_units::{Quantity, Unit};

use crate::canonical::{self, CANONICAL};

/// A signal that a column may be taken as.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// Its name in the program (`omega`).
    pub signal: &'static str,
    /// What it is (`speed of the shaft`).
    pub words: &'static str,
    /// Unit of a column that says none.
    pub bare_unit: &'static str,
    quantities: &'static [Quantity],
}

impl Choice {
    /// The units that its column may be in, in the order in which people think of them; those of
    /// an encoder stand for the pattern that they show.
    pub fn units(&self) -> Vec<&'static str> {
        let counts = |quantity: &Quantity| match quantity {
            Quantity::Angle => Some("counts/4096"),
            Quantity::Length => Some("counts*0.05um"),
            _ => None,
        };
        let all = self.quantities.iter().flat_map(|it| it.units().chain(counts(it)));
        all.collect()
    }

    /// Whether its column can be in that unit.
    pub fn accepts(&self, unit: &str) -> bool {
        Unit::parse(unit).is_some_and(|unit| self.quantities.contains(&unit.quantity))
    }
}

/// Everything that a column may be, `time` first.
pub fn choices() -> impl Iterator<Item = Choice> {
    CANONICAL.iter().map(|it| Choice {
        signal: it.name,
        words: it.words,
        bare_unit: it.bare_unit,
        quantities: it.quantities,
    })
}

/// What a signal is, in words; its own name where the program does not know it.
pub fn in_words(signal: &str) -> &str {
    canonical::exact(signal).map_or(signal, |it| it.words)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_choice_has_words_of_its_own_and_units_that_it_accepts() {
        let all: Vec<Choice> = choices().collect();
        for (k, choice) in all.iter().enumerate() {
            assert!(choice.words.len() > 3, "{}", choice.signal);
            assert!(all[..k].iter().all(|other| other.words != choice.words), "{}", choice.words);
            assert_eq!(in_words(choice.signal), choice.words);
            assert!(choice.accepts(choice.bare_unit));
            for unit in choice.units() {
                assert!(choice.accepts(unit), "{}: {unit}", choice.signal);
            }
        }
        assert_eq!(in_words("T"), "speed of the tachometer");
        assert_eq!(in_words("vibration"), "vibration");
    }
}
