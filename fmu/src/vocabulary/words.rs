//! Causality, variability and initial, each with its one table of spellings.

/// A choice of the standard with a fixed spelling in XML.
pub(crate) trait Word: Copy + PartialEq + 'static {
    /// Every choice with its spelling, in the order of the standard.
    const WORDS: &'static [(&'static str, Self)];

    /// The choice of that spelling; case counts.
    #[cfg(feature = "import")]
    fn read(text: &str) -> Option<Self> {
        Self::WORDS.iter().find(|(word, _)| *word == text).map(|(_, choice)| *choice)
    }

    /// Its spelling.
    #[cfg(any(test, feature = "export"))]
    fn word(self) -> &'static str {
        let found = Self::WORDS.iter().find(|(_, choice)| *choice == self);
        found.expect("the table is made with the choices").0
    }
}

/// Declares a choice together with its spellings, so that none can lack one.
macro_rules! words {
    ($(#[$about:meta])* $name:ident { $($(#[$what:meta])* $choice:ident = $word:literal,)+ }) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum $name {
            $($(#[$what])* $choice,)+
        }

        impl Word for $name {
            const WORDS: &'static [(&'static str, Self)] = &[$(($word, Self::$choice),)+];
        }
    };
}

words! {
    /// Who gives the variable its value.
    Causality {
        /// The user, before the start; sizes of arrays follow from it (FMI 3.0).
        StructuralParameter = "structuralParameter",
        /// The user.
        Parameter = "parameter",
        /// The model, from parameters.
        CalculatedParameter = "calculatedParameter",
        /// Another model.
        Input = "input",
        /// The model, for other models.
        Output = "output",
        /// The model, to be looked at.
        Local = "local",
        /// The simulator: time.
        Independent = "independent",
    }
}

words! {
    /// When the value may change.
    Variability {
        /// Never.
        Constant = "constant",
        /// Not after initialization.
        Fixed = "fixed",
        /// When the importer changes a tunable parameter.
        Tunable = "tunable",
        /// At events.
        Discrete = "discrete",
        /// Always.
        Continuous = "continuous",
    }
}

words! {
    /// How the value is found in initialization.
    Initial {
        /// It is the start value.
        Exact = "exact",
        /// The start value is a first guess.
        Approx = "approx",
        /// It is calculated; there is no start value.
        Calculated = "calculated",
    }
}

#[cfg(all(test, feature = "import"))]
mod tests {
    use super::*;

    #[test]
    fn every_spelling_is_read_back_and_no_other() {
        fn both_ways<T: Word + std::fmt::Debug>(count: usize) {
            assert_eq!(T::WORDS.len(), count);
            for (word, choice) in T::WORDS {
                assert_eq!((T::read(word), choice.word()), (Some(*choice), *word));
                assert_eq!(T::read(&word.to_uppercase()), None);
            }
        }
        both_ways::<Causality>(7);
        both_ways::<Variability>(5);
        both_ways::<Initial>(3);
    }
}
