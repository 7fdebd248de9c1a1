//! Axes: a linear scale from data to pixels, ticks at round numbers, numbers as text.

/// What an axis shows.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Axis {
    /// The quantity.
    pub label: String,
    /// Its unit, empty for none; shown in brackets behind the label.
    pub unit: String,
    /// The ends of the axis; without them it spans the data.
    pub range: Option<(f64, f64)>,
}

impl Axis {
    /// An axis that spans its data.
    pub fn new(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { label: label.into(), unit: unit.into(), range: None }
    }

    /// The same from `low` to `high`.
    pub fn from_to(self, low: f64, high: f64) -> Self {
        Self { range: Some((low, high)), ..self }
    }

    /// `residual r [rpm]`.
    pub fn heading(&self) -> String {
        if self.unit.is_empty() {
            self.label.clone()
        } else {
            format!("{} [{}]", self.label, self.unit)
        }
    }
}

/// Share of the span that is left free on both sides of the data.
const MARGIN: f64 = 0.06;

/// The ends of an axis for these values, with a margin: of no finite values 0 to 1.
pub fn span(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values
        .into_iter()
        .filter(|v| v.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
    if low > high {
        return (0.0, 1.0);
    }
    // A signal that does not move gets an axis around its value, not of no length; and one whose
    // span is far below its size must not fall below the resolution of the numbers.
    let least = (low.abs().max(high.abs()) * 1e-9).max(1e-300);
    let margin =
        if high - low > least { MARGIN * (high - low) } else { (low.abs() * 0.05).max(1.0) };
    (low - margin, high + margin)
}

/// A linear map of `from` onto `to`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    from: (f64, f64),
    to: (f64, f64),
}

impl Scale {
    /// Maps `from.0` to `to.0` and `from.1` to `to.1`. A `from` of no length is widened by 1.
    pub fn new(from: (f64, f64), to: (f64, f64)) -> Self {
        let from = if from.1 > from.0 { from } else { (from.0, from.0 + 1.0) };
        Self { from, to }
    }

    /// The pixel of a value.
    pub fn at(&self, value: f64) -> f64 {
        let share = (value - self.from.0) / (self.from.1 - self.from.0);
        self.to.0 + share * (self.to.1 - self.to.0)
    }

    /// The pixel at which the axis ends.
    pub fn end(&self) -> f64 {
        self.to.1
    }

    /// Whether the axis shows this value.
    pub fn shows(&self, value: f64) -> bool {
        self.from.0 <= value && value <= self.from.1
    }

    /// Ticks at round values, about `wanted` of them, each with its text.
    pub fn ticks(&self, wanted: usize) -> Vec<(f64, String)> {
        let (low, high) = self.from;
        let step = round_step((high - low) / wanted.max(1) as f64);
        let first = (low / step).ceil();
        // Counted, not summed, so that a tick at 0 is 0.
        (0..)
            .map(|k| (first + f64::from(k)) * step)
            .take_while(|value| *value <= high + 1e-9 * step)
            .map(|value| (value, tick_text(value, step)))
            .collect()
    }
}

/// The least of 1, 2, 5 times a power of ten that is no less than `step`.
fn round_step(step: f64) -> f64 {
    let power = 10f64.powf(step.log10().floor());
    // A little less than the round number, lest 2.0000000001 become 5.
    let times = step / power * (1.0 - 1e-9);
    power * [1.0, 2.0, 5.0].into_iter().find(|round| times <= *round).unwrap_or(10.0)
}

/// As many decimals as the step has; beyond what fits an axis, powers of ten.
fn tick_text(value: f64, step: f64) -> String {
    const MOST_DIGITS: f64 = 1e6;
    const LEAST_STEP: f64 = 1e-4;
    let value = if value.abs() < 1e-9 * step { 0.0 } else { value };
    let text = if value == 0.0 && step < LEAST_STEP {
        "0".into()
    } else if value != 0.0 && (value.abs() >= MOST_DIGITS || step < LEAST_STEP) {
        let digits = (value.abs().log10().floor() - step.log10().floor()).clamp(0.0, 6.0) as usize;
        format!("{value:.digits$e}")
    } else {
        let decimals = (-step.log10().floor()).clamp(0.0, 9.0) as usize;
        format!("{value:.decimals$}")
    };
    text.replace('-', "\u{2212}")
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn texts(low: f64, high: f64, wanted: usize) -> Vec<String> {
        Scale::new((low, high), (0.0, 1.0)).ticks(wanted).into_iter().map(|t| t.1).collect()
    }

    #[test]
    fn ticks_are_round_and_their_texts_say_them_in_full() {
        assert_eq!(texts(3500.0, 5500.0, 4), ["3500", "4000", "4500", "5000", "5500"]);
        assert_eq!(texts(-0.11, 0.12, 4), ["\u{2212}0.1", "0.0", "0.1"]);
        assert_eq!(texts(-30.0, 410.0, 5), ["0", "100", "200", "300", "400"]);
        assert_eq!(texts(0.0, 2e-6, 2), ["0", "1e\u{2212}6", "2e\u{2212}6"]);
        assert_eq!(texts(0.0, 4e7, 4), ["0", "1e7", "2e7", "3e7", "4e7"]);
    }

    #[test]
    fn an_axis_of_equal_or_no_values_has_a_length() {
        assert_eq!(span([7.0, 7.0]), (6.0, 8.0));
        assert_eq!(span([f64::NAN]), (0.0, 1.0));
        assert_eq!(span([0.0, 100.0]), (-6.0, 106.0));
    }

    proptest! {
        #[test]
        fn ticks_lie_on_the_axis_and_are_neither_few_nor_many(
            low in -1e6..1e6, length in 1e-3..1e6, wanted in 2_usize..12,
        ) {
            let ticks = Scale::new((low, low + length), (0.0, 1.0)).ticks(wanted);
            // A step is rounded up by 2.5 at most; where the axis begins costs one more.
            prop_assert!((wanted as f64 / 2.5).floor() as usize <= ticks.len() + 1);
            prop_assert!(ticks.len() <= wanted + 1);
            for (value, _) in ticks {
                prop_assert!(value >= low - 1e-6 * length && value <= low + length * (1.0 + 1e-6));
            }
        }
    }
}
