//! The communication points of a run: `t_k = start + k h`.

use drivescope_recording::MOST_NUMBERS;

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

/// Refuses a run before it begins whose recording would hold more numbers than memory is given for.
pub(crate) fn recordable(steps: usize, columns: usize) -> Result<(), ExperimentProblem> {
    match (steps + 1).checked_mul(columns).is_some_and(|numbers| numbers <= MOST_NUMBERS) {
        true => Ok(()),
        false => Err(ExperimentProblem::TooLong(steps as f64)),
    }
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

    #[test]
    fn a_recording_that_no_memory_holds_is_refused_before_it_is_made() {
        assert_eq!(recordable(0, 0), Ok(()));
        assert_eq!(recordable(MOST_NUMBERS / 7 - 1, 7), Ok(()));
        let refused = recordable(MOST_NUMBERS / 7 + 1, 7).expect_err("too many").to_string();
        assert!(refused.starts_with("28571429 steps are more than can be recorded"), "{refused}");
        assert!(recordable(usize::MAX - 1, 2).is_err());
        assert!(ExperimentProblem::TooLong(2e302).to_string().starts_with("2e302 steps"));
    }
}
