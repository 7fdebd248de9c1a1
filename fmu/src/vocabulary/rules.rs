//! Which causality, variability and initial go together, and the defaults of those not stated
//! (FMI 2.0.4 section 2.2.7, FMI 3.0.2 sections 2.4.7.4 and 2.4.7.5).

use super::{Causality, Initial, Variability};

/// Whether the three may stand at one variable; the independent variable alone has no initial.
pub(crate) fn go_together(
    causality: Causality,
    variability: Variability,
    initial: Option<Initial>,
) -> bool {
    use Causality as C;
    use Variability as V;
    let exact = initial == Some(Initial::Exact);
    match (causality, variability) {
        (C::Independent, V::Continuous) => initial.is_none(),
        (C::StructuralParameter | C::Parameter, V::Fixed | V::Tunable) => exact,
        (C::CalculatedParameter, V::Fixed | V::Tunable) => !exact,
        (C::Input, V::Discrete | V::Continuous) => exact,
        (C::Output | C::Local, V::Constant) => exact,
        (C::Local, V::Fixed | V::Tunable) => !exact,
        (C::Output | C::Local, V::Discrete | V::Continuous) => true,
        _ => false,
    }
}

/// How a variable is initialized that does not say it; `None` for the independent variable.
pub(crate) fn default_initial(causality: Causality, variability: Variability) -> Option<Initial> {
    use Causality as C;
    match (causality, variability) {
        (C::Independent, _) => None,
        (C::StructuralParameter | C::Parameter | C::Input, _) => Some(Initial::Exact),
        (C::Output | C::Local, Variability::Constant) => Some(Initial::Exact),
        (C::CalculatedParameter | C::Output | C::Local, _) => Some(Initial::Calculated),
    }
}

/// When a variable may change that does not say it; `float`: its type is a floating-point one.
#[cfg(feature = "import")]
pub(crate) fn default_variability(causality: Causality, float: bool) -> Variability {
    match causality {
        Causality::StructuralParameter | Causality::Parameter | Causality::CalculatedParameter => {
            Variability::Fixed
        }
        _ if float => Variability::Continuous,
        _ => Variability::Discrete,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn defaults_of_initial_follow_the_standard() {
        use Causality as C;
        use Variability as V;
        assert_eq!(default_initial(C::Parameter, V::Tunable), Some(Initial::Exact));
        assert_eq!(default_initial(C::Input, V::Continuous), Some(Initial::Exact));
        assert_eq!(default_initial(C::Local, V::Constant), Some(Initial::Exact));
        assert_eq!(default_initial(C::Output, V::Continuous), Some(Initial::Calculated));
        assert_eq!(default_initial(C::CalculatedParameter, V::Fixed), Some(Initial::Calculated));
        assert_eq!(default_initial(C::Independent, V::Continuous), None);
    }

    #[test]
    fn what_the_standard_forbids_does_not_go_together() {
        use Causality as C;
        use Variability as V;
        assert!(go_together(C::Independent, V::Continuous, None));
        assert!(!go_together(C::Independent, V::Continuous, Some(Initial::Calculated)));
        assert!(!go_together(C::Parameter, V::Continuous, Some(Initial::Exact)));
        assert!(!go_together(C::CalculatedParameter, V::Fixed, Some(Initial::Exact)));
        assert!(go_together(C::Local, V::Tunable, Some(Initial::Approx)));
        assert!(!go_together(C::Output, V::Fixed, Some(Initial::Calculated)));
        assert!(!go_together(C::Output, V::Constant, Some(Initial::Calculated)));
    }
}
