//! Innovations: what of a residual its own past does not predict.
//!
//! A random load makes the residual of a free run remember. The residual of every output is predicted
//! from exponential averages of the past of all outputs, over 1 to [`LONGEST`] samples (white noise
//! on top of a slow disturbance needs a long memory, which a few averages hold as well as hundreds of
//! lags), and the innovations are scaled to unit variance: what a filter with a load state would
//! leave, with that state taken from the data.

use drivescope_numerics::Regression;

use super::columns::Measurement;
use crate::measured::OUTPUTS;

/// Time constants of the averages, samples: 1, 2, 4 ... up to this.
const LONGEST: usize = 128;
const AVERAGES: usize = 8;

/// A filter to innovations.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Whitener {
    /// Weights of the averages of each output, for each output; averages vary fastest.
    weights: [Vec<f64>; OUTPUTS],
    /// Standard deviation of the innovations of each output.
    sd: [f64; OUTPUTS],
}

/// Averages of the past of the outputs; time constants vary fastest.
struct Past([f64; OUTPUTS * AVERAGES]);

impl Past {
    const NONE: Self = Self([0.0; OUTPUTS * AVERAGES]);

    #[inline]
    fn see(&mut self, output: usize, value: f64) {
        for (j, average) in self.0[output * AVERAGES..][..AVERAGES].iter_mut().enumerate() {
            *average += (value - *average) / (1usize << j) as f64;
        }
    }
}

/// Visits the values of each sample together.
fn samples(places: &[Measurement], mut visit: impl FnMut(std::ops::Range<usize>, bool)) {
    let mut from = 0;
    while from < places.len() {
        let first = places[from];
        let same = |place: &Measurement| {
            place.recording == first.recording && place.sample == first.sample
        };
        let to = from + places[from..].iter().take_while(|place| same(place)).count();
        let is_first = from == 0 || {
            let before = places[from - 1];
            before.recording != first.recording || before.sample + LONGEST < first.sample
        };
        visit(from..to, is_first);
        from = to;
    }
}

impl Whitener {
    /// The filter of this residual; the identity, scaled, where it is too short.
    pub(crate) fn of(places: &[Measurement], residual: &[f64]) -> Self {
        let seen: Vec<usize> = (0..OUTPUTS)
            .filter(|output| places.iter().any(|place| place.output == *output))
            .collect();
        let width = seen.last().map_or(0, |last| (last + 1) * AVERAGES);
        let mut regressions: [Regression; OUTPUTS] =
            std::array::from_fn(|_| Regression::new(width));
        let columns: Vec<usize> =
            seen.iter().flat_map(|output| output * AVERAGES..(output + 1) * AVERAGES).collect();
        let mut past = Past::NONE;
        samples(places, |range, is_first| {
            if is_first {
                past = Past::NONE;
            }
            for k in range.clone() {
                let averages = past.0[..width].iter().copied();
                regressions[places[k].output].push(averages, residual[k]);
            }
            for k in range {
                past.see(places[k].output, residual[k]);
            }
        });
        let mut weights: [Vec<f64>; OUTPUTS] = Default::default();
        for output in 0..OUTPUTS {
            let fit = regressions[output].solve_columns(&columns);
            weights[output] = vec![0.0; width];
            if let Ok(fit) = fit {
                for (column, weight) in columns.iter().zip(fit.parameters) {
                    weights[output][*column] = weight;
                }
            }
        }
        let mut filter = Self { weights, sd: [1.0; OUTPUTS] };
        let innovations = filter.applied(places, residual);
        for output in 0..OUTPUTS {
            let power = |values: &[f64]| {
                let own = places.iter().zip(values).filter(|(place, _)| place.output == output);
                let (sum, count) = own.fold((0.0, 0.0), |(sum, count), (_, value)| {
                    (sum + value * value, count + 1.0)
                });
                sum / count
            };
            let remainder = power(&innovations);
            if remainder > 0.0 {
                filter.sd[output] = remainder.sqrt();
            }
        }
        filter
    }

    /// ln of the probability of a residual, without its constant.
    pub(crate) fn ln_probability(&self, places: &[Measurement], residual: &[f64]) -> f64 {
        let innovations = self.applied(places, residual);
        let each = places.iter().zip(innovations);
        each.map(|(place, value)| -0.5 * value * value - self.sd[place.output].ln()).sum()
    }

    /// The innovations of a residual.
    fn applied(&self, places: &[Measurement], residual: &[f64]) -> Vec<f64> {
        let mut innovations = residual.to_vec();
        let mut past = Past::NONE;
        samples(places, |range, is_first| {
            if is_first {
                past = Past::NONE;
            }
            for k in range.clone() {
                let output = places[k].output;
                let predicted = past.0.iter().zip(&self.weights[output]);
                let predicted: f64 = predicted.map(|(average, weight)| weight * average).sum();
                innovations[k] = (residual[k] - predicted) / self.sd[output];
            }
            for k in range {
                past.see(places[k].output, residual[k]);
            }
        });
        innovations
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::gaussian;

    const SAMPLES: usize = 8000;

    fn places() -> Vec<Measurement> {
        let of = |k| [0, 1].map(|output| Measurement { recording: 0, sample: k, output });
        (0..SAMPLES).flat_map(of).collect()
    }

    /// Two outputs that a slow disturbance moves together, under white noise.
    fn disturbed() -> Vec<f64> {
        let (slow, white) = (gaussian(SAMPLES, 1), gaussian(2 * SAMPLES, 2));
        let mut state = 0.0;
        let mut both = Vec::new();
        for k in 0..SAMPLES {
            state = 0.99 * state + 0.2 * slow[k];
            both.extend([state + white[2 * k], -0.5 * state + white[2 * k + 1]]);
        }
        both
    }

    /// Autocorrelation at a lag of the first output's values.
    fn correlation(values: &[f64], lag: usize) -> f64 {
        let own: Vec<f64> = values.iter().step_by(2).copied().collect();
        let power: f64 = own.iter().map(|value| value * value).sum();
        own[lag..].iter().zip(&own).map(|(a, b)| a * b).sum::<f64>() / power
    }

    #[test]
    fn innovations_are_white_and_of_unit_variance() {
        let (places, residual) = (places(), disturbed());
        let whitener = Whitener::of(&places, &residual);
        let innovations = whitener.applied(&places, &residual);
        let power = innovations.iter().map(|value| value * value).sum::<f64>();
        assert!((power / innovations.len() as f64 - 1.0).abs() < 1e-9);
        assert!(correlation(&residual, 20) > 0.4);
        // Of white noise a correlation has a standard deviation of 0.011.
        for lag in [1, 5, 20, 80] {
            let rho = correlation(&innovations, lag);
            assert!(rho.abs() < 0.05, "{rho} at {lag}");
        }
    }

    #[test]
    fn the_filter_is_linear_and_forgets_between_recordings() {
        let (places, residual) = (places(), disturbed());
        let whitener = Whitener::of(&places, &residual);
        let twice: Vec<f64> = residual.iter().map(|value| 2.0 * value).collect();
        let [once, doubled] = [&residual, &twice].map(|it| whitener.applied(&places, it));
        for (once, doubled) in once.iter().zip(doubled) {
            assert!((doubled - 2.0 * once).abs() < 1e-9);
        }
        let mut apart = places.clone();
        apart[8000..].iter_mut().for_each(|place| place.recording = 1);
        let halves = whitener.applied(&apart, &residual);
        let second = whitener.applied(&places[8000..], &residual[8000..]);
        assert_eq!(halves[8000..], second);
    }
}
