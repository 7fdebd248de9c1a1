//! Akaike's information criterion: AIC = N ln(SSE / N) + 2 K.
//!
//! Source: L. Ljung, "System Identification", 2nd ed., Section 16.4, for Gaussian errors of
//! unknown variance, without the terms that are equal for all models of the same data.

/// AIC of a model with `parameters` free parameters whose squared errors over `samples`
/// samples sum to `sse`; smaller is better. Only values over the same samples compare.
///
/// The unit of the error only shifts all values alike. A perfect fit gives minus infinity.
pub fn aic(sse: f64, samples: usize, parameters: usize) -> f64 {
    let n = samples as f64;
    n * (sse / n).ln() + 2.0 * parameters as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding of a logarithm times a hundred.
    const ROUNDING: f64 = 1e-12;

    #[test]
    fn one_parameter_must_pay_for_itself() {
        // 100 samples: a parameter pays when it lowers SSE by more than 1 - e^(-2/100).
        let base = aic(50.0, 100, 3);
        let break_even = 50.0 * (-0.02_f64).exp();
        assert!((aic(break_even, 100, 4) - base).abs() < ROUNDING);
        assert!(aic(break_even * 0.999, 100, 4) < base);
        assert!(aic(break_even * 1.001, 100, 4) > base);
    }
}
