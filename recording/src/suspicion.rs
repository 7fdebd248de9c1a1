//! Units and signs that contradict each other.
//!
//! Where two signals measure the same thing, their ratio should be 1: the increments of the angle
//! and the integral of the speed, the tachometer and the speed, the reference and the speed that
//! follows it. A ratio of 9.549 = 60 / 2 pi or 57.30 = 180 / pi names the unit that was meant.

use std::f64::consts::{PI, TAU};
use std::fmt;

use drivescope_units::Unit;
use serde::Serialize;

use crate::rounded::rounded;
use crate::signal::{Recording, Signal};
use crate::time::shortest;

/// Two ratios agree when they differ by less than this share: sensors are not better calibrated.
const SAME_RATIO: f64 = 0.04;
/// Below this correlation the two signals do not measure the same thing.
const SAME_THING: f64 = 0.95;
/// Share to which a sampling time that would make them agree is known.
const ROUNDED: f64 = 0.005;
/// Windows over which angles are differenced: long enough that quanta do not matter.
const WINDOWS: usize = 200;
/// One in so many samples may be a spike.
const SPIKES: usize = 200;
/// No small drive turns faster (rad/s, 19,000 rpm).
const FASTEST: f64 = 2000.0;
/// Sampling slower than this sees no drive: a counter or milliseconds taken for seconds (s).
const SLOWEST_SAMPLING: f64 = 0.5;

/// A doubt about a signal's unit or sign.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Suspicion {
    /// Two signals that measure the same thing differ by a constant factor.
    Ratio {
        /// The signal in doubt.
        signal: String,
        /// The one it was compared with.
        with: String,
        /// How many times larger it is than the other says.
        ratio: f64,
        /// What the factor is likely to mean.
        meaning: Option<String>,
        /// How far apart rows would have to lie for the two to agree, s, where no column tells.
        #[serde(skip_serializing_if = "Option::is_none")]
        rows_every_s: Option<f64>,
    },
    /// A speed that no drive reaches.
    TooFast {
        signal: String,
        /// Its largest magnitude, rad/s.
        largest: f64,
    },
    /// A sampling time that sees no drive.
    TooSlow {
        /// The sampling time, s.
        period_s: f64,
    },
}

impl fmt::Display for Suspicion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Suspicion::Ratio { signal, with, ratio, meaning, rows_every_s } => {
                write!(f, "{signal} is {ratio:.4} times what {with} says")?;
                let end = match (meaning, rows_every_s) {
                    (Some(meaning), _) => {
                        write!(f, ": {meaning}")?;
                        "."
                    }
                    (None, Some(every_s)) => {
                        write!(
                            f,
                            ": they agree with rows {every_s} s apart, say --rows-every {every_s}; \
                             or is it a gear, or a wrong unit or calibration"
                        )?;
                        "?"
                    }
                    (None, None) => {
                        write!(f, ": a gear, or a wrong unit or calibration")?;
                        "?"
                    }
                };
                // No unit turns a sign.
                match *ratio > 0.0 {
                    true => write!(f, "{end} If it is a unit, say --columns {signal}=COLUMN:UNIT"),
                    false => Ok(()),
                }
            }
            Suspicion::TooFast { signal, largest } => {
                let rpm = largest * 30.0 / PI;
                write!(
                    f,
                    "{signal} reaches {largest:.0} rad/s, which is {rpm:.0} rpm: is the column in \
                     rpm? Then say --columns {signal}=COLUMN:rpm"
                )
            }
            Suspicion::TooSlow { period_s } => write!(
                f,
                "a sample every {} s: is time in milliseconds, or a counter? Then say \
                 --columns time=COLUMN:ms",
                rounded(*period_s)
            ),
        }
    }
}

impl Suspicion {
    /// Where rows lie `period_s` apart only because somebody says so: how far apart they would
    /// have to lie for a speed and its position to agree.
    pub(crate) fn suggest_rows(&mut self, period_s: f64) {
        if let Self::Ratio { with, ratio, meaning: None, rows_every_s, .. } = self
            && *ratio > 0.0
            && matches!(with.as_str(), "theta" | "x")
        {
            let every_s = period_s / *ratio;
            *rows_every_s = Some(shortest(every_s, ROUNDED * every_s));
        }
    }

    /// Whether the units of two measured signals exclude each other: one of them is another.
    pub fn is_contradiction(&self) -> bool {
        matches!(self, Self::Ratio { with, ratio, meaning: Some(_), .. }
            if *ratio > 0.0 && with != "reference")
    }
}

/// Factors by which a rotary signal is too large, and what each means. The angle's factors are
/// the inverse ones.
const ROTARY: &[(f64, &str)] = &[
    (60.0 / TAU, "it looks like rpm, not rad/s"),
    (180.0 / PI, "it looks like degrees, not radians"),
    (1.0 / TAU, "it looks like revolutions, not radians"),
    (60.0, "it looks like rpm beside an angle in revolutions"),
    (PI / 180.0, "the other looks like degrees, not radians"),
    (TAU, "the other looks like revolutions, not radians"),
    (TAU / 60.0, "the other looks like rpm, not rad/s"),
    (-1.0, "their signs are opposite"),
];

const LINEAR: &[(f64, &str)] = &[
    (1e3, "one is in thousandths (mm)"),
    (1e-3, "the other is in thousandths (mm)"),
    (60.0, "it looks like metres a minute"),
    (-1.0, "their signs are opposite"),
];

/// Doubts about a recording whose signals are under their canonical names.
pub fn suspicions(recording: &Recording) -> Vec<Suspicion> {
    let mut found = Vec::new();
    let signal = |name: &str| recording.signal(name);
    for (speed, position, factors) in [("omega", "theta", ROTARY), ("v", "x", LINEAR)] {
        if let (Some(speed), Some(position)) = (signal(speed), signal(position)) {
            let pairs = travelled(speed, position, recording.period_s);
            found.extend(compare(speed, position, &pairs, factors));
        }
    }
    let speed = signal("omega").or_else(|| signal("v"));
    for other in ["T", "reference"].into_iter().filter_map(signal) {
        if let Some(speed) = speed
            && let (Some(a), Some(b)) = (Unit::parse(&other.unit), Unit::parse(&speed.unit))
            && a.quantity == b.quantity
        {
            let pairs = speed.values.iter().zip(&other.values);
            let pairs: Vec<_> = pairs.map(|(x, y)| (b.to_si(*x), a.to_si(*y))).collect();
            found.extend(compare(speed, other, &pairs, ROTARY));
        }
    }
    if let Some(omega) = signal("omega") {
        let finite = omega.values.iter().filter(|it| it.is_finite());
        let mut all: Vec<f64> = finite.map(|it| it.abs()).collect();
        let at = all.len().saturating_sub(1 + all.len() / SPIKES);
        let largest = match all.is_empty() {
            true => 0.0,
            false => *all.select_nth_unstable_by(at, f64::total_cmp).1,
        };
        if largest > FASTEST {
            found.push(Suspicion::TooFast { signal: "omega".into(), largest });
        }
    }
    if recording.period_s > SLOWEST_SAMPLING {
        found.push(Suspicion::TooSlow { period_s: recording.period_s });
    }
    found
}

/// Integral of the speed and increment of the position over windows of equal length.
///
/// Steps of more than half the position's range are the wrapping of an angle: these windows are
/// left out, as are those with holes.
fn travelled(speed: &Signal, position: &Signal, period_s: f64) -> Vec<(f64, f64)> {
    let (v, x) = (&speed.values, &position.values);
    let finite = || x.iter().copied().filter(|it| it.is_finite());
    let range = finite().fold(f64::NEG_INFINITY, f64::max) - finite().fold(f64::INFINITY, f64::min);
    let width = (v.len() / WINDOWS).max(1);
    let windows = (0..v.len().saturating_sub(1)).step_by(width).map(|from| {
        let to = (from + width).min(v.len() - 1);
        let wraps = x[from..=to].windows(2).any(|pair| (pair[1] - pair[0]).abs() > 0.5 * range);
        // The trapezium rule; a held speed differs by half a sample, which the ratio forgives.
        let inside: f64 = v[from..=to].windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).sum();
        (!wraps).then_some((inside * period_s, x[to] - x[from]))
    });
    windows.flatten().filter(|(a, b)| a.is_finite() && b.is_finite()).collect()
}

/// Compares `pairs` of (`signal`, `with`): the ratio by total least squares through the origin.
fn compare(
    signal: &Signal,
    with: &Signal,
    pairs: &[(f64, f64)],
    factors: &[(f64, &str)],
) -> Option<Suspicion> {
    let finite = || pairs.iter().filter(|(a, b)| a.is_finite() && b.is_finite());
    let (aa, bb, ab) =
        finite().fold((0.0, 0.0, 0.0), |(aa, bb, ab), (a, b)| (aa + a * a, bb + b * b, ab + a * b));
    let correlation = ab / (aa * bb).sqrt();
    // Not a number where one of them does not move at all.
    if correlation.is_nan() || correlation.abs() < SAME_THING {
        return None;
    }
    let ratio = (aa / bb).sqrt().copysign(correlation);
    let near = |factor: f64| (ratio / factor - 1.0).abs() < SAME_RATIO;
    if near(1.0) {
        return None;
    }
    let meaning = factors.iter().find(|(factor, _)| near(*factor));
    Some(Suspicion::Ratio {
        signal: signal.name.clone(),
        with: with.name.clone(),
        ratio,
        meaning: meaning.map(|(_, meaning)| (*meaning).to_owned()),
        rows_every_s: None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A drive that swings: speed `scale` times, angle `turns` times the true one.
    fn swinging(scale: f64, turns: f64) -> Recording {
        let period_s = 1e-3;
        let time = |k: i32| f64::from(k) * period_s;
        let made = |name: &str, unit: &str, of: &dyn Fn(f64) -> f64| Signal {
            name: name.into(),
            unit: unit.into(),
            values: (0..4000).map(|k| of(time(k))).collect(),
        };
        let signals = vec![
            made("omega", "rad/s", &|t| scale * (20.0 + 80.0 * (7.0 * t).sin())),
            made("theta", "rad", &|t| turns * (20.0 * t - 80.0 / 7.0 * (7.0 * t).cos())),
        ];
        Recording::new("a", 0.0, period_s, signals)
    }

    fn only(recording: &Recording) -> (f64, Option<String>) {
        match suspicions(recording).as_slice() {
            [Suspicion::Ratio { ratio, meaning, .. }, ..] => (*ratio, meaning.clone()),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn right_units_raise_no_doubt() {
        assert_eq!(suspicions(&swinging(1.0, 1.0)), []);
        // An angle that wraps at every revolution, too.
        let mut wrapped = swinging(1.0, 1.0);
        wrapped.signals[1].values.iter_mut().for_each(|it| *it = it.rem_euclid(TAU));
        assert_eq!(suspicions(&wrapped), []);
    }

    #[test]
    fn each_wrong_unit_is_named() {
        for (scale, turns, words) in [
            (60.0 / TAU, 1.0, "rpm, not rad/s"),
            (180.0 / PI, 1.0, "degrees, not radians"),
            (1.0, 180.0 / PI, "the other looks like degrees"),
            (1.0, 1.0 / TAU, "the other looks like revolutions"),
            (-1.0, 1.0, "opposite"),
        ] {
            let (_, meaning) = only(&swinging(scale, turns));
            assert!(
                meaning.as_deref().is_some_and(|it| it.contains(words)),
                "{words}: {meaning:?}"
            );
        }
        let stated = suspicions(&swinging(60.0 / TAU, 1.0))[0].to_string();
        assert!(stated.contains("say --columns omega=COLUMN:UNIT"), "{stated}");
        let (ratio, meaning) = only(&swinging(14.0, 1.0));
        assert!((ratio - 14.0).abs() < 0.1 && meaning.is_none(), "a gear");
        let contradicts = |scale| suspicions(&swinging(scale, 1.0))[0].is_contradiction();
        assert_eq!([60.0 / TAU, 60.0, 14.0, -1.0].map(contradicts), [true, true, false, false]);
    }

    #[test]
    fn rows_that_somebody_put_too_close_are_moved_apart() {
        // True steps of 1 ms, read as 0.4 ms.
        let mut recording = swinging(1.0, 1.0);
        recording.period_s = 0.4e-3;
        let mut found = suspicions(&recording);
        found[0].suggest_rows(0.4e-3);
        let stated = found[0].to_string();
        assert!(stated.contains("rows 0.001 s apart, say --rows-every 0.001;"), "{stated}");
        assert!(!found[0].is_contradiction());
        // A unit that explains the factor comes first.
        let mut rpm = suspicions(&swinging(60.0 / TAU, 1.0));
        rpm[0].suggest_rows(1e-3);
        assert!(!rpm[0].to_string().contains("--rows-every"), "{}", rpm[0]);
    }

    #[test]
    fn without_an_angle_the_tachometer_the_range_and_the_clock_tell() {
        let mut recording = swinging(60.0 / TAU, 1.0);
        recording.signals[1] = Signal {
            name: "T".into(),
            unit: "rpm".into(),
            values: recording.signals[0].values.clone(),
        };
        assert!(only(&recording).1.unwrap().contains("rpm, not rad/s"));
        recording.signals.truncate(1);
        assert_eq!(suspicions(&recording), []);
        recording.signals[0].values[7] = 3000.0;
        assert_eq!(suspicions(&recording), [], "a spike is no unit");
        recording.signals[0].values[7..47].fill(3000.0);
        recording.period_s = 1.0;
        let stated: Vec<String> = suspicions(&recording).iter().map(Suspicion::to_string).collect();
        assert!(
            stated[0].contains("28648 rpm") && stated[1].contains("milliseconds"),
            "{stated:?}"
        );
    }
}
