//! The communication points of a run: `t_k = start + k h`.

use super::problem::ExperimentProblem;

/// Steps that fit between two times.
pub(crate) fn steps(start: f64, stop: f64, step: f64) -> Result<usize, ExperimentProblem> {
    /// More than any recording can hold.
    const MOST: f64 = 1e9;
    /// A span of a whole number of steps may be rounded to a little less.
    const SLACK: f64 = 1e-6;
    if !(step.is_finite() && step > 0.0) {
        return Err(ExperimentProblem::Step(step));
    }
    if !(start.is_finite() && stop.is_finite() && stop > start) {
        return Err(ExperimentProblem::Empty { start, stop });
    }
    let count = (stop - start) / step + SLACK;
    if count > MOST { Err(ExperimentProblem::TooLong(count)) } else { Ok(count as usize) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_counted_in_spite_of_rounding() {
        assert_eq!(steps(0.0, 1.0, 0.1), Ok(10));
        assert_eq!(steps(0.1, 0.7, 0.2), Ok(3));
        assert_eq!(steps(0.0, 1.0, 0.3), Ok(3));
        assert_eq!(steps(0.0, 1.0, -0.3), Err(ExperimentProblem::Step(-0.3)));
        assert!(matches!(steps(1.0, 1.0, 0.3), Err(ExperimentProblem::Empty { .. })));
        assert!(matches!(steps(0.0, 1.0, 1e-12), Err(ExperimentProblem::TooLong(_))));
        assert!(matches!(steps(0.0, f64::NAN, 0.1), Err(ExperimentProblem::Empty { .. })));
    }
}
