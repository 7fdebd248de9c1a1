//! The methods of a diagnosis: the bank, the windows, and every detector of the residual.

use drivescope_diagnoser::{DetectorKind, Diagnoser};
use serde::{Serialize, Serializer};

const OF_BANK: &str = "The bank of hypotheses over the drive's equations; the default where the \
                       diagnoser has one";
const OF_WINDOWS: &str = "Windows of the residual against a baseline; the default where one is given \
                          and there is no bank";

/// A method of a diagnosis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// The bank of hypotheses over the drive's equations; the default where the diagnoser has one.
    Bank,
    /// Windows of the residual against a baseline; the default where one is given and there is no
    /// bank.
    Windows,
    /// A detector of the residual; else the default is model error modelling.
    Residual(DetectorKind),
}

impl Method {
    /// The detector that is the default where there is neither bank nor windows.
    const DEFAULT: DetectorKind = DetectorKind::Mem;

    /// All of them, in the order in which they are shown.
    pub fn all() -> impl Iterator<Item = Self> {
        let of_residual = DetectorKind::ALL.into_iter().map(Self::Residual);
        [Self::Bank, Self::Windows].into_iter().chain(of_residual)
    }

    /// Name in files and options.
    pub fn id(self) -> &'static str {
        match self {
            Self::Bank => "bank",
            Self::Windows => "windows",
            Self::Residual(kind) => kind.id(),
        }
    }

    /// Name for people.
    pub fn label(self) -> &'static str {
        match self {
            Self::Bank => "bank of hypotheses",
            Self::Windows => "windows against the baseline",
            Self::Residual(kind) => kind.label(),
        }
    }

    /// What it is, for the help.
    pub fn about(self) -> String {
        match self {
            Self::Bank => OF_BANK.to_owned(),
            Self::Windows => OF_WINDOWS.to_owned(),
            Self::Residual(Self::DEFAULT) => {
                format!("{}; else the default", Self::DEFAULT.info().about)
            }
            Self::Residual(kind) => kind.info().about.to_owned(),
        }
    }

    /// The method of that name.
    pub fn find(id: &str) -> Option<Self> {
        Self::all().find(|method| method.id() == id)
    }

    /// Whether the diagnoser holds it, with or without a baseline of the machine.
    pub fn is_held(self, diagnoser: &Diagnoser, baseline: bool) -> bool {
        match self {
            Self::Bank => diagnoser.bank.is_some(),
            Self::Windows => diagnoser.windows.is_some() && baseline,
            Self::Residual(kind) => diagnoser.holds(kind),
        }
    }

    /// The best that a diagnoser has, with or without a baseline of the machine.
    pub fn best(diagnoser: &Diagnoser, baseline: bool) -> Self {
        let best =
            [Self::Bank, Self::Windows].into_iter().find(|it| it.is_held(diagnoser, baseline));
        best.unwrap_or(match diagnoser.explains(Self::DEFAULT) {
            true => Self::Residual(Self::DEFAULT),
            false => Self::Residual(DetectorKind::Constant),
        })
    }
}

/// Its id.
impl Serialize for Method {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.id())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_detector_is_a_method_and_each_is_found_by_its_name() {
        assert_eq!(Method::all().count(), 2 + DetectorKind::ALL.len());
        for (k, method) in Method::all().enumerate() {
            assert!(Method::all().take(k).all(|it| it.label() != method.label()), "{method:?}");
            assert_eq!(Method::find(method.id()), Some(method));
        }
        assert_eq!(Method::find("constant"), Some(Method::Residual(DetectorKind::Constant)));
        assert_eq!(Method::find("cusum"), None);
    }
}
