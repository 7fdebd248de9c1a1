//! The way to the randomness with which recordings are most probable: far from it each number is moved to
//! the top of a parabola through three of its values, near it all of them to the top of one in all numbers,
//! which are far from independent.

use nalgebra::{DMatrix, DVector, SymmetricEigen};
use rayon::prelude::*;

use super::judge::{FINE, Judge, Number};
use super::randomness::Randomness;

/// Gain in ln of the likelihood that a step must promise.
const WORTH: f64 = 0.3;
/// Least and greatest distance of the values of a parabola, ln.
const DISTANCE: (f64, f64) = (0.1, 1.1);
/// Distances that a step goes at first: as far as its values nearly tell.
const FURTHEST: f64 = 2.5;
/// Share of a step that is tried where its end is no better.
const LESS: f64 = 0.3;
/// Bend, ln of the likelihood at a distance, below which a direction is not told.
const UNTOLD: f64 = 0.1;
/// Share of what a parabola promised by which it may be wrong where it is believed.
const WRONG: f64 = 0.1;

/// A randomness on the way.
pub(super) struct Climb<'a> {
    judge: &'a Judge<'a>,
    numbers: Vec<Number>,
    /// Between the values of the parabola of each number, ln.
    distances: Vec<f64>,
    pub(super) best: Randomness,
    /// ln of the probability of the recordings with it.
    most: f64,
}

impl<'a> Climb<'a> {
    /// From there; nothing where the drive overflows.
    pub(super) fn from(
        best: Randomness,
        judge: &'a Judge<'a>,
        numbers: Vec<Number>,
        distance: f64,
    ) -> Option<Self> {
        let most = judge.of_randomness(&best)?;
        let distances = numbers.iter().map(|number| match number {
            // Thousands of values tell the noise of a sensor, and far off no parabola holds.
            Number::Sensor(_) if distance <= FINE => DISTANCE.0,
            _ => distance,
        });
        Some(Self { judge, distances: distances.collect(), numbers, best, most })
    }

    /// With numbers moved by so many of their distances.
    fn moved(&self, moves: &[(usize, f64)]) -> Randomness {
        moves.iter().fold(self.best, |moved, (place, by)| {
            self.judge.moved(moved, self.numbers[*place], by * self.distances[*place])
        })
    }

    /// ln of the probability there; one that does not move tells nothing.
    fn probability(&self, moves: &[(usize, f64)]) -> f64 {
        let tried = self.moved(moves);
        if tried == self.best {
            return f64::NEG_INFINITY;
        }
        self.judge.of_randomness(&tried).unwrap_or(f64::NEG_INFINITY)
    }

    /// The distance at which the likelihood falls by one, where the bend is told.
    fn learn_distance(&mut self, place: usize, bend: f64) {
        if bend > 0.0 && bend.is_finite() {
            let distance = self.distances[place] * (2.0 / bend).sqrt();
            self.distances[place] = distance.clamp(DISTANCE.0, DISTANCE.1);
        }
    }

    /// Moves each number by itself; whether one of them moved.
    pub(super) fn one_by_one(&mut self) -> bool {
        let mut moves = false;
        for place in 0..self.numbers.len() {
            let at = |by: f64| self.probability(&[(place, by)]);
            let (up, down) = rayon::join(|| at(1.0), || at(-1.0));
            let (mut by, mut found) = if up > down { (1.0, up) } else { (-1.0, down) };
            let (slope, bend) = (0.5 * (up - down), 2.0 * self.most - up - down);
            let mut told = false;
            if bend > 0.0 && bend.is_finite() {
                let whole = slope / bend;
                let top = whole.clamp(-FURTHEST, FURTHEST);
                // Far from the top the parabola does not tell where the likelihood falls by one.
                told = whole == top;
                let promised = self.most + top * (slope - 0.5 * bend * top);
                if promised > found.max(self.most) + WORTH {
                    let at_top = at(top);
                    if at_top > found {
                        (by, found) = (top, at_top);
                    }
                }
            }
            if found > self.most + WORTH {
                (self.best, self.most) = (self.moved(&[(place, by)]), found);
                moves = true;
            }
            if told {
                self.learn_distance(place, bend);
            }
        }
        moves
    }

    /// Moves all numbers together; whether it is worth while to do it again.
    pub(super) fn together(&mut self) -> bool {
        let Some((parabola, mut tried)) = self.parabola() else { return false };
        let at_top = self.top(&parabola);
        let holds = at_top.as_ref().is_some_and(|(found, promised)| {
            let wrong = (found.probability - self.most - promised).abs();
            parabola.bends_down && found.is_whole && wrong < WORTH.max(WRONG * promised)
        });
        tried.extend(at_top.map(|(found, _)| found));
        let last = tried.len() - 1;
        let each = tried.iter().enumerate();
        let best = each.max_by(|a, b| a.1.probability.total_cmp(&b.1.probability));
        let gains = |it: &Tried| it.probability > self.most + WORTH;
        let Some((which, best)) = best.filter(|it| gains(it.1)) else { return false };
        (self.best, self.most) = (self.moved(&best.moves), best.probability);
        for (k, place) in parabola.free.iter().enumerate() {
            self.learn_distance(*place, parabola.bends[(k, k)]);
        }
        !(holds && which == last)
    }

    fn tried(&self, moves: Vec<(usize, f64)>) -> Tried {
        Tried { probability: self.probability(&moves), moves, is_whole: false }
    }

    /// The parabola in all numbers around the best, with the values that tell it; nothing where no number can
    /// be moved both ways.
    fn parabola(&self) -> Option<(Parabola, Vec<Tried>)> {
        let sides = (0..2 * self.numbers.len()).into_par_iter();
        let side = |it: usize| self.tried(vec![(it / 2, [1.0, -1.0][it % 2])]);
        let mut tried: Vec<Tried> = sides.map(side).collect();
        let up = |place: usize| tried[2 * place].probability;
        let down = |place: usize| tried[2 * place + 1].probability;
        let told = |place: &usize| (up(*place) + down(*place)).is_finite();
        let free: Vec<usize> = (0..self.numbers.len()).filter(told).collect();
        if free.is_empty() {
            return None;
        }
        let slopes = free.iter().map(|place| 0.5 * (up(*place) - down(*place)));
        let slopes = DVector::from_iterator(free.len(), slopes);
        let bends = free.iter().map(|place| 2.0 * self.most - up(*place) - down(*place));
        let mut bends = DMatrix::from_diagonal(&DVector::from_iterator(free.len(), bends));
        // The noise of a sensor hardly depends on more than how large the load is.
        let number = |k: usize| self.numbers[free[k]];
        let depend = |(a, b): &(usize, usize)| {
            number(*a) == Number::LoadSize || !matches!(number(*b), Number::Sensor(_))
        };
        let pairs = (1..free.len()).flat_map(|b| (0..b).map(move |a| (a, b)));
        let pairs: Vec<(usize, usize)> = pairs.filter(depend).collect();
        let both = |(a, b): &(usize, usize)| self.tried(vec![(free[*a], 1.0), (free[*b], 1.0)]);
        let both: Vec<Tried> = pairs.par_iter().map(both).collect();
        for ((a, b), both) in pairs.iter().zip(&both) {
            let bend = up(free[*a]) + up(free[*b]) - self.most - both.probability;
            let bend = if bend.is_finite() { bend } else { 0.0 };
            (bends[(*a, *b)], bends[(*b, *a)]) = (bend, bend);
        }
        tried.extend(both);
        Some((Parabola::of(free, slopes, bends), tried))
    }

    /// As far towards the top of the parabola as the probability rises, with what was promised there;
    /// nothing where that is too little.
    fn top(&self, parabola: &Parabola) -> Option<(Tried, f64)> {
        let mut share = (FURTHEST / parabola.step.amax()).min(1.0);
        if parabola.promised(share) <= WORTH {
            return None;
        }
        let at = |share: f64| self.probability(&parabola.moves(share));
        let mut found = at(share);
        if found <= self.most {
            share *= LESS;
            found = at(share);
        }
        while share < 1.0 && found > self.most {
            let further = (2.0 * share).min(1.0);
            let there = at(further);
            if there <= found {
                break;
            }
            (share, found) = (further, there);
        }
        let moves = parabola.moves(share);
        let tried = Tried { moves, probability: found, is_whole: share == 1.0 };
        Some((tried, parabola.promised(share)))
    }
}

/// Numbers that were moved by so many of their distances, and ln of the probability there.
struct Tried {
    moves: Vec<(usize, f64)>,
    probability: f64,
    /// Whether it is the whole way to the top of a parabola.
    is_whole: bool,
}

/// A parabola in the numbers that are free, in units of their distances.
struct Parabola {
    free: Vec<usize>,
    slopes: DVector<f64>,
    bends: DMatrix<f64>,
    /// To its top; where it does not bend down, upwards.
    step: DVector<f64>,
    bends_down: bool,
}

impl Parabola {
    fn of(free: Vec<usize>, slopes: DVector<f64>, bends: DMatrix<f64>) -> Self {
        let eigen = SymmetricEigen::new(bends.clone());
        let bends_down = eigen.eigenvalues.iter().all(|bend| *bend > 0.0);
        let mut along = eigen.eigenvectors.tr_mul(&slopes);
        for (along, bend) in along.iter_mut().zip(&eigen.eigenvalues) {
            *along /= bend.abs().max(UNTOLD);
        }
        let step = &eigen.eigenvectors * along;
        Self { free, slopes, bends, step, bends_down }
    }

    /// That share of the step.
    fn moves(&self, share: f64) -> Vec<(usize, f64)> {
        self.free.iter().zip(&self.step).map(|(place, by)| (*place, share * by)).collect()
    }

    /// What that share of the step promises.
    fn promised(&self, share: f64) -> f64 {
        let step = share * &self.step;
        step.dot(&self.slopes) - 0.5 * step.dot(&(&self.bends * &step))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_top_of_numbers_that_depend_on_each_other_is_one_step_away() {
        let bends = DMatrix::from_row_slice(2, 2, &[2.0, 1.9, 1.9, 2.0]);
        let at = DVector::from_column_slice(&[0.7, -0.4]);
        let found = Parabola::of(vec![0, 1], &bends * &at, bends);
        assert!((&found.step - at).amax() < 1e-9 && found.bends_down);
        // On a saddle it goes up both ways.
        let saddle = DMatrix::from_row_slice(2, 2, &[2.0, 0.0, 0.0, -1.0]);
        let slopes = DVector::from_column_slice(&[0.5, 0.5]);
        let found = Parabola::of(vec![0, 1], slopes, saddle);
        assert!(found.step[0] > 0.0 && found.step[1] > 0.0 && !found.bends_down);
    }
}
