//! Path data of SVG in few bytes: relative steps in tenths of a pixel.
//!
//! Steps are taken between rounded positions, so that rounding does not add up.

use std::fmt::Write;

use super::decimate::Point;

/// A polyline through pixel positions; a NaN lifts the pen. A point on its own is a dot, which
/// round line caps make visible.
pub(super) fn polyline(points: impl IntoIterator<Item = Point>) -> String {
    let mut path = String::new();
    let mut pen = Pen::Up;
    for (x, y) in points {
        if !(x.is_finite() && y.is_finite()) {
            pen.lift(&mut path);
            continue;
        }
        let (x, y) = (tenths(x), tenths(y));
        match &mut pen {
            Pen::Up => {
                path.push('M');
                number(&mut path, x);
                number(&mut path, y);
                pen = Pen::Down { x, y, moved: false };
            }
            Pen::Down { x: from_x, y: from_y, moved } => {
                if (x, y) == (*from_x, *from_y) {
                    continue;
                }
                if !*moved {
                    path.push('l');
                }
                number(&mut path, x - *from_x);
                number(&mut path, y - *from_y);
                pen = Pen::Down { x, y, moved: true };
            }
        }
    }
    pen.lift(&mut path);
    path
}

/// The area between two polylines, one closed shape a stretch without gaps; they have their
/// points at the same places.
pub(super) fn area(lower: &[Point], upper: &[Point]) -> String {
    let gap = |k: usize| !(lower[k].1.is_finite() && upper[k].1.is_finite());
    let count = lower.len().min(upper.len());
    let mut path = String::new();
    let mut from = 0;
    while from < count {
        let to = (from..count).find(|k| gap(*k)).unwrap_or(count);
        if to > from {
            let there = upper[from..to].iter();
            let back = lower[from..to].iter().rev();
            path += &polyline(there.chain(back).copied());
            path.push('z');
        }
        from = to + 1;
    }
    path
}

enum Pen {
    Up,
    Down { x: i64, y: i64, moved: bool },
}

impl Pen {
    fn lift(&mut self, path: &mut String) {
        if let Self::Down { moved: false, .. } = self {
            path.push_str("h0");
        }
        *self = Self::Up;
    }
}

fn tenths(value: f64) -> i64 {
    (value * 10.0).round() as i64
}

/// Appends a number of tenths; a sign or a letter before it stands for a space.
fn number(path: &mut String, tenths: i64) {
    let (whole, part) = (tenths.unsigned_abs() / 10, tenths.unsigned_abs() % 10);
    if tenths < 0 {
        path.push('-');
    } else if path.ends_with(|c: char| c.is_ascii_digit()) {
        path.push(' ');
    }
    // Writing to a string cannot fail.
    let _ = match (whole, part) {
        (whole, 0) => write!(path, "{whole}"),
        (0, part) => write!(path, ".{part}"),
        (whole, part) => write!(path, "{whole}.{part}"),
    };
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Reads such a path back.
    fn positions(path: &str) -> Vec<Point> {
        let mut at = (0.0, 0.0);
        let mut all = Vec::new();
        let mut rest = path;
        while let Some(command) = rest.chars().next() {
            rest = &rest[1..];
            let end = rest.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(rest.len());
            let spaced = rest[..end].replace('-', " -");
            let numbers: Vec<f64> =
                spaced.split_ascii_whitespace().map(|n| n.parse().unwrap()).collect();
            rest = &rest[end..];
            for pair in numbers.chunks_exact(2) {
                at = match command {
                    'M' => (pair[0], pair[1]),
                    'l' => (at.0 + pair[0], at.1 + pair[1]),
                    other => panic!("command {other}"),
                };
                all.push(at);
            }
        }
        all
    }

    #[test]
    fn paths_are_short() {
        let points = [(0.0, 1.0), (0.5, 1.0), (1.0, 0.04), (2.0, -3.25)];
        assert_eq!(polyline(points), "M0 1l.5 0 .5-1 1-3.3");
    }

    #[test]
    fn a_gap_lifts_the_pen_and_a_lone_point_is_a_dot() {
        let points = [(0.0, 1.0), (1.0, f64::NAN), (2.0, 1.0), (3.0, 2.0)];
        assert_eq!(polyline(points), "M0 1h0M2 1l1 1");
    }

    #[test]
    fn an_area_closes_each_stretch() {
        let lower = [(0.0, 0.0), (1.0, 0.0), (2.0, f64::NAN), (3.0, 0.0), (4.0, 0.0)];
        let upper = [(0.0, 2.0), (1.0, 2.0), (2.0, 2.0), (3.0, 1.0), (4.0, 1.0)];
        assert_eq!(area(&lower, &upper), "M0 2l1 0 0-2-1 0zM3 1l1 0 0-1-1 0z");
    }

    proptest! {
        #[test]
        fn rounding_does_not_add_up(steps in prop::collection::vec(0.0..3.0_f64, 2..300)) {
            let mut x = 0.0;
            let points: Vec<Point> = steps
                .iter()
                .map(|step| { x += 0.2 + step; (x, 100.0 * step.sin()) })
                .collect();
            let drawn = positions(&polyline(points.iter().copied()));
            prop_assert_eq!(drawn.len(), points.len());
            // Half a tenth, and the sums of the reader in binary.
            let tolerance = 0.05 + 1e-6;
            for (a, b) in drawn.iter().zip(&points) {
                prop_assert!((a.0 - b.0).abs() <= tolerance && (a.1 - b.1).abs() <= tolerance);
            }
        }
    }
}
