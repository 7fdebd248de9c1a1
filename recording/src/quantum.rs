//! The grid that a converter or an encoder puts on a signal.

use serde::Serialize;

/// Steps up to so many quanta tell the quantum; longer ones carry its error too often.
const SHORT_STEPS: f64 = 50.0;
/// Fewer short steps than these tell nothing.
const ENOUGH: usize = 20;
/// Distance from a multiple, in quanta, that printed digits may leave ...
const OFF_GRID: f64 = 0.1;
/// ... for all but this share of the short steps. Steps of any size would hit with 0.2.
const ON_GRID: f64 = 0.95;
/// Differences below this share of the range are rounding.
const ROUNDING: f64 = 1e-9;
/// Quantisation noise is q / sqrt(12); from this share of all noise on, it matters.
const COARSE: f64 = 0.5;

/// The smallest step of a signal.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Quantum {
    /// The step, in the signal's unit.
    pub step: f64,
    /// Whether quantisation is a good part of the signal's noise.
    pub coarse: bool,
}

impl Quantum {
    /// The quantum of a signal, if its steps are multiples of one; what is not finite is skipped.
    pub fn of(values: &[f64]) -> Option<Self> {
        let finite = || values.iter().copied().filter(|value| value.is_finite());
        let (min, max) = finite().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            (low.min(value), high.max(value))
        });
        quantum(values, max - min)
    }
}

/// The quantum of a signal, if its steps are multiples of one.
pub(crate) fn quantum(values: &[f64], range: f64) -> Option<Quantum> {
    let steps = || {
        let steps = values.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        steps.filter(move |step| step.is_finite() && *step > ROUNDING * range)
    };
    let least = steps().fold(f64::INFINITY, f64::min);
    let (mut sum, mut multiples) = (0.0, 0.0);
    for step in steps().filter(|step| *step <= SHORT_STEPS * least) {
        sum += step;
        multiples += (step / least).round();
    }
    let step = sum / multiples;
    let (mut short, mut on_grid) = (0, 0);
    for ratio in steps().map(|it| it / step).filter(|ratio| *ratio <= SHORT_STEPS + 0.5) {
        short += 1;
        on_grid += usize::from((ratio - ratio.round()).abs() <= OFF_GRID);
    }
    let found = short >= ENOUGH && on_grid as f64 >= ON_GRID * short as f64;
    found.then(|| Quantum { step, coarse: step / 12_f64.sqrt() >= COARSE * noise(values) })
}

/// Standard deviation of white noise on a smooth signal, from third differences (1, -3, 3, -1),
/// whose variance is 20 times that of the noise.
fn noise(values: &[f64]) -> f64 {
    let third = values.windows(4).map(|x| x[3] - 3.0 * x[2] + 3.0 * x[1] - x[0]);
    let (sum, count) = third
        .filter(|it| it.is_finite())
        .fold((0.0, 0), |(sum, count), it| (sum + it * it, count + 1));
    (sum / (20 * count.max(1)) as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Deterministic noise of about unit variance: sums of a linear congruential generator.
    fn noisy(samples: usize) -> Vec<f64> {
        let mut state = 1_u64;
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        (0..samples).map(|_| (0..12).map(|_| uniform()).sum()).collect()
    }

    fn encoder(q: f64, digits: usize) -> Vec<f64> {
        let exact = (0..5000).map(|k| q * (300.0 * (0.002 * f64::from(k)).sin()).round());
        exact.map(|value| format!("{value:.digits$}").parse().unwrap()).collect()
    }

    #[test]
    fn an_encoder_s_step_is_found_through_printed_digits() {
        let q = std::f64::consts::TAU / 4096.0;
        for (digits, allowed) in [(15, 1e-9), (6, 1e-3)] {
            let found = quantum(&encoder(q, digits), 600.0 * q).unwrap();
            assert!((found.step / q - 1.0).abs() < allowed, "{digits} digits: {found:?}");
            assert!(found.coarse);
            assert_eq!(Quantum::of(&encoder(q, digits)).map(|it| it.coarse), Some(true));
        }
    }

    #[test]
    fn noise_has_no_grid_and_printed_noise_only_that_of_its_digits() {
        assert_eq!(quantum(&noisy(100_000), 10.0), None);
        assert_eq!(Quantum::of(&[f64::NAN; 50]), None);
        let printed: Vec<f64> = noisy(100_000).iter().map(|x| (x * 1e3).round() / 1e3).collect();
        let found = quantum(&printed, 10.0).unwrap();
        assert!((found.step - 1e-3).abs() < 1e-6 && !found.coarse, "{found:?}");
    }
}
