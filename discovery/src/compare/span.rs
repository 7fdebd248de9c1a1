//! Spans of time in which the model fails, each with a sentence.
//!
//! The squared error, smoothed over [`WINDOW_S`], is above what noise allows: the chi-square
//! quantile that the whole recording exceeds with probability [`CHANCE`], and several times what
//! is usual in this recording, so that an error which is everywhere is no span. What happens in a
//! span more often than elsewhere makes its sentence.

use drivescope_recording::Clock;
use serde::Serialize;
use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::drive_motion::{DriveMotion, Scales, quantile};

/// Length of the smoothing, s.
const WINDOW_S: f64 = 0.05;
/// Probability that a recording without fault has a span.
const CHANCE: f64 = 0.01;
/// A noise estimate is up to a tenth too small.
const NOISE_KNOWN: f64 = 1.21;
/// Times the median of the smoothed error: where a cause was found, and where none was (the peaks
/// of a random load reach 24 times its median in one sample of a thousand).
const ABOVE_USUAL: [f64; 2] = [3.0, 24.0];
/// Spans that are closer are one, s.
const APART_S: f64 = 0.1;
/// Spans that are told: those with the largest error.
const MOST: usize = 12;
/// A condition is told if it holds in that much more of the span than of the recording.
const MORE_OFTEN: f64 = 0.35;
/// Shares of the usual top beyond which a signal is large, and below which a speed is small.
const LARGE: f64 = 0.6;
const SLOW: f64 = 0.05;
/// Share of the largest input by which it steps from one sample to the next.
const STEP: f64 = 0.25;
/// Share of the samples in which it may do so and still be told.
const RARELY: f64 = 0.01;
/// Change of the speed over a span, as a share of its usual top, that is no steady motion.
const CHANGES: f64 = 0.1;

/// A stretch of time in which the model fails.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Span {
    /// Its begin, s.
    pub from: f64,
    /// Its end, s.
    pub to: f64,
    /// What happens there, in words.
    pub sentence: String,
    /// Root of the mean squared error in it, in units of the noise.
    pub error: f64,
}

/// What a recording looks like to [`spans`].
pub(super) struct View<'a> {
    pub(super) path: &'a DriveMotion,
    pub(super) scales: &'a Scales,
    /// Squared error of each sample over its outputs, in units of the noise, and how many values
    /// it is of.
    pub(super) squares: &'a [(f64, usize)],
    pub(super) clock: Clock,
    /// Squared error of a perfect model, per value.
    pub(super) floor: f64,
    /// Whether a cause was found.
    pub(super) explained: bool,
    /// The largest input there can be, if it is known.
    pub(super) limit: Option<f64>,
    /// Units of speed and current.
    pub(super) units: [&'a str; 2],
}

/// The spans in the order of time.
pub(super) fn spans(view: &View<'_>) -> Vec<Span> {
    let h = view.path.period_s;
    let half = ((0.5 * WINDOW_S / h) as usize).max(1);
    let smoothed = smooth(view.squares, half);
    let width = 2 * half + 1;
    let values = view.squares.iter().map(|it| it.1).max().unwrap_or(1).max(1) * width;
    let windows = (smoothed.len() / width).max(1);
    let law = ChiSquared::new(values as f64).expect("positive");
    let by_noise = law.inverse_cdf(1.0 - CHANCE / windows as f64) / values as f64;
    let usual = quantile(smoothed.iter().copied().filter(|v| v.is_finite()), 0.5);
    let above = ABOVE_USUAL[usize::from(!view.explained)];
    let limit = (NOISE_KNOWN * view.floor * by_noise).max(above * usual);
    let apart = (APART_S / h) as usize;
    let mut found: Vec<(usize, usize)> = Vec::new();
    for k in (0..smoothed.len()).filter(|k| smoothed[*k] > limit) {
        match found.last_mut() {
            Some(last) if k - last.1 <= apart => last.1 = k + 1,
            _ => found.push((k, k + 1)),
        }
    }
    let content =
        |span: &(usize, usize)| -> f64 { view.squares[span.0..span.1].iter().map(|it| it.0).sum() };
    found.sort_by(|a, b| content(b).total_cmp(&content(a)));
    found.truncate(MOST);
    found.sort_unstable();
    found.iter().map(|span| view.span(*span)).collect()
}

/// Mean square over a window around each sample; NaN where nothing was measured.
fn smooth(squares: &[(f64, usize)], half: usize) -> Vec<f64> {
    let mut sums = vec![(0.0, 0usize)];
    for (square, count) in squares {
        let last = sums[sums.len() - 1];
        sums.push((last.0 + square, last.1 + count));
    }
    let at = |k: usize| {
        let (from, to) = (sums[k.saturating_sub(half)], sums[(k + half + 1).min(squares.len())]);
        (to.0 - from.0) / (to.1 - from.1) as f64
    };
    (0..squares.len()).map(at).collect()
}

impl View<'_> {
    fn begin_s(&self, from: usize) -> f64 {
        self.clock.time(from)
    }

    /// End of the sample before that one, which may begin another segment.
    fn end_s(&self, to: usize) -> f64 {
        self.clock.time(to - 1) + self.clock.period_s
    }

    fn span(&self, (from, to): (usize, usize)) -> Span {
        let inside = &self.squares[from..to];
        let (sum, count) = inside.iter().fold((0.0, 0), |(s, n), it| (s + it.0, n + it.1));
        Span {
            from: self.begin_s(from),
            to: self.end_s(to),
            sentence: self.sentence(from, to),
            error: (sum / count.max(1) as f64).sqrt(),
        }
    }

    fn sentence(&self, from: usize, to: usize) -> String {
        let (path, scales) = (self.path, self.scales);
        let [speed_unit, current_unit] = self.units;
        let mut said = self.events(from, to);
        let stands = |k: usize| path.direction[k] == 0.0;
        let fast = LARGE * scales.omega;
        let much = LARGE * scales.i;
        let quick = 0.3 * LARGE * scales.alpha;
        let alpha = |k: usize| path.alpha[k] * path.omega[k].signum();
        let limited = |k: usize| self.limit.is_some_and(|limit| path.u[k].abs() >= 0.995 * limit);
        let conditions: [(String, &dyn Fn(usize) -> bool); 8] = [
            ("at the voltage limit".to_owned(), &limited),
            ("at rest".to_owned(), &stands),
            ("accelerating".to_owned(), &|k| alpha(k) > quick),
            ("braking".to_owned(), &|k| alpha(k) < -quick),
            (format!("current above {} {current_unit}", short(much)), &|k| path.i[k].abs() > much),
            (format!("speed above {} {speed_unit}", short(fast)), &|k| path.omega[k].abs() > fast),
            ("forward".to_owned(), &|k| path.omega[k] > SLOW * scales.omega),
            ("backward".to_owned(), &|k| path.omega[k] < -SLOW * scales.omega),
        ];
        let share = |range: std::ops::Range<usize>, holds: &dyn Fn(usize) -> bool| {
            let length = range.len().max(1) as f64;
            range.filter(|k| holds(*k)).count() as f64 / length
        };
        let mut more: Vec<(f64, String)> = conditions
            .into_iter()
            .map(|(words, holds)| (share(from..to, holds) - share(0..path.len(), holds), words))
            .filter(|(more, _)| *more > MORE_OFTEN)
            .collect();
        more.sort_by(|a, b| b.0.total_cmp(&a.0));
        said.extend(more.into_iter().take(2 - said.len().min(1)).map(|(_, words)| words));
        if said.len() < 2 {
            said.extend(self.motion(from, to));
        }
        let (from, to) = (self.begin_s(from), self.end_s(to));
        format!("fails at {from:.2} to {to:.2} s: {}", said.join(", "))
    }
}

impl View<'_> {
    /// What begins or ends in the span: at most one thing of the motion, and a step of the input.
    fn events(&self, from: usize, to: usize) -> Vec<String> {
        let path = self.path;
        let turns = |k: &usize| path.direction[*k] * path.direction[k.saturating_sub(1)] < 0.0;
        let stands = |k: usize| path.direction[k] == 0.0;
        let is_start = |k: &usize| *k > 0 && stands(*k) != stands(k - 1);
        let mut said = Vec::new();
        match (from..to).filter(turns).count() {
            0 if (from..to).any(|k| is_start(&k)) => {
                let moved = |range: &mut dyn Iterator<Item = usize>| {
                    range.map(|k| path.direction[k]).find(|direction| *direction != 0.0)
                };
                let (before, after) = (moved(&mut (from..to)), moved(&mut (from..to).rev()));
                said.push(match (stands(from), stands(to - 1)) {
                    (true, false) => "the shaft sets off".to_owned(),
                    (false, true) => "the shaft comes to rest".to_owned(),
                    (false, false) if before != after => "the shaft stops and turns back".into(),
                    (false, false) => "the shaft stops and goes on".to_owned(),
                    (true, true) => "the shaft moves and stops".to_owned(),
                });
            }
            0 => {}
            1 => said.push("speed crosses zero".to_owned()),
            times => said.push(format!("speed crosses zero {times} times")),
        }
        let largest = path.u.iter().fold(0.0_f64, |most, u| most.max(u.abs()));
        let change = |k: usize| (path.u[k] - path.u[k.saturating_sub(1)]).abs();
        // A controller that differentiates noise changes its output as much in every sample.
        let often = (0..path.len()).filter(|k| change(*k) > STEP * largest).count();
        let rare = often as f64 <= RARELY * path.len() as f64;
        if rare && (from..to).any(|k| change(k) > STEP * largest) {
            said.push("the input steps".to_owned());
        }
        said
    }

    /// The motion in the span, where it has one direction.
    fn motion(&self, from: usize, to: usize) -> Option<String> {
        let (path, unit) = (self.path, self.units[0]);
        let direction = path.direction[from];
        if direction == 0.0 || (from..to).any(|k| path.direction[k] != direction) {
            return None;
        }
        let way = if direction > 0.0 { "forward" } else { "backward" };
        let size = |k: usize| path.omega[k].abs();
        let (first, last) = (size(from), size(to - 1));
        let sizes = || (from..to).map(size);
        let (least, most) = (sizes().fold(first, f64::min), sizes().fold(first, f64::max));
        let changed = CHANGES * self.scales.omega;
        let speeds = |a: f64, b: f64| format!("{} to {} {unit}", short(a), short(b));
        Some(if most - least <= changed {
            format!("running {way} at {} {unit}", short(0.5 * (most + least)))
        } else if last - first > 0.7 * (most - least) {
            format!("running up {way} from {}", speeds(first, last))
        } else if first - last > 0.7 * (most - least) {
            format!("slowing down {way} from {}", speeds(first, last))
        } else {
            format!("running {way} at {}", speeds(least, most))
        })
    }
}

/// Two significant digits.
fn short(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let digits = (1 - value.abs().log10().floor() as i32).clamp(0, 9) as usize;
    let scale = 10f64.powi(1 - value.abs().log10().floor() as i32);
    let rounded = (value * scale).round() / scale;
    format!("{rounded:.digits$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path(samples: usize) -> DriveMotion {
        // A speed that crosses zero once, at half the time.
        let omega: Vec<f64> =
            (0..samples).map(|k| 100.0 - 200.0 * k as f64 / samples as f64).collect();
        let direction = omega.iter().map(|w: &f64| w.signum()).collect();
        DriveMotion {
            i: vec![1.0; samples],
            theta: vec![0.0; samples],
            direction,
            alpha: vec![0.0; samples],
            u: vec![1.0; samples],
            share: vec![0.0; samples],
            since: vec![1.0; samples],
            period_s: 1e-3,
            place: 0,
            force: false,
            omega,
        }
    }

    #[test]
    fn a_span_says_where_and_what_happens() {
        let path = path(4000);
        let scales = Scales { i: 2.0, omega: 100.0, alpha: 50.0, inertia: 1.0 };
        let mut squares = vec![(2.0, 2usize); 4000];
        squares[1950..2060].fill((60.0, 2));
        let mut view = View {
            path: &path,
            scales: &scales,
            squares: &squares,
            clock: Clock { start_s: 0.5, period_s: 1e-3, breaks: Vec::new() },
            floor: 1.0,
            explained: true,
            limit: None,
            units: ["rad/s", "A"],
        };
        let found = spans(&view);
        assert_eq!(found.len(), 1, "{found:?}");
        assert!((found[0].from - 2.45).abs() < 0.05 && (found[0].to - 2.56).abs() < 0.05);
        assert!(found[0].sentence.ends_with("speed crosses zero"), "{}", found[0].sentence);
        // A quarter of the time before, it only slows down; and a step of the input is told.
        let mut stepped = super::tests::path(4000);
        stepped.u[1000..].fill(-1.0);
        assert_eq!(
            view.motion(500, 1000).expect("one direction"),
            "slowing down forward from 75 to 50 rad/s"
        );
        assert_eq!(view.motion(1900, 2100), None, "it turns");
        view.path = &stepped;
        assert_eq!(view.events(900, 1100), ["the input steps"]);
        view.path = &path;
        let quiet = vec![(2.0, 2usize); 4000];
        view.squares = &quiet;
        assert_eq!(spans(&view), []);
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!([1.5432, 0.01234, 187.0, 0.0].map(short), ["1.5", "0.012", "190", "0"]);
    }
}
