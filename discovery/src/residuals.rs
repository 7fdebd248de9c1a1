//! What the sensors show of a model along a recording, and how far that is from what was measured.

use crate::case::{Case, Squares};
use crate::measured::{Channel, OUTPUTS};
use crate::run::Runner;

impl Case<'_> {
    /// What sensors show of the model before the correction, in the order of [`crate::Output`],
    /// current, speed and position measured or not, one value a sample; NaN between the pieces and
    /// from an overflow on.
    pub fn trajectory(&self) -> [Vec<f64>; OUTPUTS] {
        let mut shown = [(); OUTPUTS].map(|()| vec![f64::NAN; self.measured.len()]);
        let mut runner = Runner::of_values(self);
        for k in self.measured.pieces.iter().cloned().flatten() {
            let now = runner.sample(k, [0.0; 2]);
            if !now.iter().all(|value| value.is_finite()) {
                break;
            }
            for (column, value) in shown.iter_mut().zip(now) {
                column[k] = value;
            }
        }
        shown
    }

    /// (y - y_model) / sd, one list an output, one value a sample; NaN where nothing was measured.
    pub fn residuals(&self) -> Vec<Vec<f64>> {
        let shown = self.trajectory();
        let of = |(channel, sd): (&Channel, &f64)| {
            let model = &shown[channel.output as usize];
            channel.values.iter().zip(model).map(|(y, model)| (y - model) / sd).collect()
        };
        self.measured.outputs.iter().zip(self.noise).map(of).collect()
    }

    /// The sum of the squared residuals.
    pub fn squares(&self) -> Squares {
        let mut squares = Squares::default();
        let mut runner = Runner::of_values(self);
        for piece in &self.measured.pieces {
            for k in piece.clone() {
                let now = runner.sample(k, [0.0; 2]);
                for (channel, sd) in self.measured.outputs.iter().zip(self.noise) {
                    let error = (channel.values[k] - now[channel.output as usize]) / sd;
                    if channel.values[k].is_finite() {
                        squares.sum += error * error;
                        squares.values += 1;
                    }
                }
            }
            if !runner.is_finite() {
                return Squares { sum: f64::INFINITY, values: self.measured.values() };
            }
        }
        squares
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::{PACE, Setting};
    use crate::measured::Measured;
    use crate::observer::Observer;
    use crate::start::Start;
    use crate::testing::{bench, dr300};
    use drivescope_plant::drive::EffectData;
    use drivescope_plant::integrate::longest_substep;
    use drivescope_plant::sampled::speed_bound;

    #[test]
    fn the_longer_pace_keeps_its_promise() {
        let mut drive = dr300();
        // The file's K_m is not its K_e, to which a fit ties it.
        drive.motor.tie_k = false;
        let measured = Measured::new(&drive, &bench(&drive, 6.0, 0.001)).expect("it can be used");
        // Noise of 1e-5 of the range: the promised error is one unit.
        let starts = vec![Start::REST; measured.pieces.len()];
        for hz in [0.0, 10.0] {
            let setting = Setting::new(&drive, Observer { hz });
            let noise = [4e-5, 4e-3];
            let (drive, measured, starts, setting) = (&drive, &measured, &starts, &setting);
            let case = Case { drive, measured, noise: &noise, starts, setting };
            let error = case.squares().error();
            assert!(error < 1.0, "{error} at {hz} Hz");
            let residuals = case.residuals();
            let sum: f64 = residuals.iter().flatten().map(|r| r * r).sum();
            assert!((sum / case.squares().sum - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn a_ripple_passed_fast_is_followed() {
        let mut drive = dr300();
        drive.motor.tie_k = false;
        let parameters = [("N", 24.0), ("a", 0.004), ("b", 0.003)].map(|(n, v)| (n.into(), v));
        let (kind, id) = ("cogging".into(), "cogging".into());
        drive.effects.push(EffectData { kind, id, parameters: parameters.into(), law: None });
        let measured = Measured::new(&drive, &bench(&drive, 6.0, 0.001)).expect("it can be used");
        let starts = vec![Start::REST; measured.pieces.len()];
        let setting = Setting::new(&drive, Observer::NONE);
        let plain = longest_substep(&drive.model(), speed_bound(&drive));
        assert!(setting.longest_s > 3.0 * PACE * plain, "{} {plain}", setting.longest_s);
        // A tenth of a usual noise.
        let noise = [1e-3, 0.03];
        let (drive, measured, starts, setting) = (&drive, &measured, &starts, &setting);
        let error = Case { drive, measured, noise: &noise, starts, setting }.squares().error();
        assert!(error < 1.0, "{error}");
    }

    #[test]
    fn an_overflow_is_infinite_and_not_hidden() {
        let mut drive = dr300();
        let measured = Measured::new(&drive, &bench(&drive, 1.0, 0.001)).expect("it can be used");
        let (starts, noise) = (vec![Start::REST; measured.pieces.len()], [0.01, 0.3]);
        let setting = Setting::new(&drive, Observer::NONE);
        drive.motor.b_m = -1.0;
        let (drive, measured, starts, setting) = (&drive, &measured, &starts, &setting);
        let case = Case { drive, measured, noise: &noise, starts, setting };
        assert_eq!(case.squares().sum, f64::INFINITY);
        assert!(case.trajectory()[1].last().is_some_and(|omega| omega.is_nan()));
    }
}
