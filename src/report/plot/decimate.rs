//! Fewer points, the same picture: of each pixel column the least and the greatest value stay.
//!
//! A line through all samples of a column covers the span from its least to its greatest value;
//! so does a line through these two, whatever the number of samples was. An outlier of one sample
//! among millions stays visible. (Kept in the order in which they occurred; a column with two
//! samples or fewer is kept whole.)

/// A point of a series.
pub type Point = (f64, f64);

/// The points that a plot needs whose pixel columns are `column` wide, in units of x: a
/// subsequence of `points`, at most two a column. A value that is not finite is a gap, and a
/// stretch of gaps stays as one point with a NaN.
pub fn extremes(points: impl IntoIterator<Item = Point>, column: f64) -> Vec<Point> {
    let mut kept = Vec::new();
    let mut open: Option<Column> = None;
    for (x, y) in points {
        if !(x.is_finite() && y.is_finite()) {
            if let Some(column) = open.take() {
                column.close(&mut kept);
            }
            if kept.last().is_some_and(|(_, last)| !last.is_nan()) {
                kept.push((x, f64::NAN));
            }
            continue;
        }
        let index = (x / column).floor();
        match &mut open {
            Some(column) if column.index == index => column.take((x, y)),
            _ => {
                if let Some(column) = open.replace(Column::new(index, (x, y))) {
                    column.close(&mut kept);
                }
            }
        }
    }
    if let Some(column) = open {
        column.close(&mut kept);
    }
    kept
}

/// The outline of a band `(x, lower, upper)` for pixel columns `column` wide: of each column the
/// least lower and the greatest upper value, at the place of its first sample, so that nothing
/// that lay in the band falls out of it. Gaps as in [`extremes`].
pub fn envelope(
    band: impl IntoIterator<Item = (f64, f64, f64)>,
    column: f64,
) -> (Vec<Point>, Vec<Point>) {
    let (mut lower, mut upper): (Vec<Point>, Vec<Point>) = (Vec::new(), Vec::new());
    let mut open = None;
    for (x, low, high) in band {
        if !(x.is_finite() && low.is_finite() && high.is_finite()) {
            if open.take().is_some() {
                lower.push((x, f64::NAN));
                upper.push((x, f64::NAN));
            }
            continue;
        }
        let index = (x / column).floor();
        match (lower.last_mut(), upper.last_mut()) {
            (Some(least), Some(greatest)) if open == Some(index) => {
                least.1 = least.1.min(low);
                greatest.1 = greatest.1.max(high);
            }
            _ => {
                lower.push((x, low));
                upper.push((x, high));
            }
        }
        open = Some(index);
    }
    (lower, upper)
}

/// The samples of one pixel column.
struct Column {
    index: f64,
    count: usize,
    least: (usize, Point),
    greatest: (usize, Point),
}

impl Column {
    fn new(index: f64, first: Point) -> Self {
        Self { index, count: 1, least: (0, first), greatest: (0, first) }
    }

    fn take(&mut self, point: Point) {
        let place = self.count;
        self.count += 1;
        if point.1 < self.least.1.1 {
            self.least = (place, point);
        }
        // Of equal values the last: a level stretch reaches as far as it was.
        if point.1 >= self.greatest.1.1 {
            self.greatest = (place, point);
        }
    }

    fn close(self, kept: &mut Vec<Point>) {
        let (first, second) = if self.least.0 <= self.greatest.0 {
            (self.least, self.greatest)
        } else {
            (self.greatest, self.least)
        };
        kept.push(first.1);
        if first.0 != second.0 {
            kept.push(second.1);
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn bounds(points: &[Point], column: f64, index: f64) -> (f64, f64) {
        points
            .iter()
            .filter(|(x, y)| (x / column).floor() == index && y.is_finite())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), (_, y)| (lo.min(*y), hi.max(*y)))
    }

    proptest! {
        #[test]
        fn every_column_keeps_its_extremes_and_nothing_is_invented(
            ys in prop::collection::vec(prop_oneof![9 => -1e3..1e3, 1 => Just(f64::NAN)], 1..400),
            column in 0.5..40.0,
        ) {
            let points: Vec<Point> = ys.iter().enumerate().map(|(k, y)| (k as f64, *y)).collect();
            let kept = extremes(points.iter().copied(), column);
            for k in 0..points.len() {
                let index = (k as f64 / column).floor();
                prop_assert_eq!(bounds(&points, column, index), bounds(&kept, column, index));
            }
            // A subsequence, in order.
            let mut rest = points.iter();
            for (x, y) in kept.iter().filter(|(_, y)| y.is_finite()) {
                prop_assert!(rest.any(|(px, py)| px == x && py == y));
            }
        }

        #[test]
        fn no_column_keeps_more_than_two(count in 1_usize..5000, columns in 1_usize..50) {
            let points = (0..count).map(|k| (k as f64, ((k * 7919) % 1013) as f64));
            let kept = extremes(points, count as f64 / columns as f64);
            // One column more where the division rounds.
            prop_assert!(kept.len() <= 2 * (columns + 1), "{} points", kept.len());
        }
    }

    #[test]
    fn an_envelope_holds_every_sample_of_the_band() {
        let band = |k: usize| (k as f64, (k as f64).sin() - 1.0, (k as f64).sin() + 1.0);
        let (lower, upper) = envelope((0..100).map(band), 8.0);
        assert_eq!((lower.len(), upper.len()), (13, 13));
        for k in 0..100 {
            let (_, low, high) = band(k);
            assert!(lower[k / 8].1 <= low && high <= upper[k / 8].1, "sample {k}");
        }
        let gap = [(0.0, 0.0, 1.0), (1.0, f64::NAN, 1.0), (2.0, 0.0, 1.0)];
        assert!(envelope(gap, 10.0).0[1].1.is_nan());
    }

    #[test]
    fn a_gap_stays_a_gap_and_is_kept_once() {
        let y = [1.0, f64::NAN, f64::INFINITY, 2.0, 3.0];
        let kept = extremes(y.iter().enumerate().map(|(k, y)| (k as f64, *y)), 1.0);
        assert_eq!(kept.len(), 4);
        assert!(kept[1].1.is_nan());
        assert_eq!(kept[3], (4.0, 3.0));
    }
}
