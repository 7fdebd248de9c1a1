//! Generalised likelihood ratios over mechanism and onset, recursively.
//!
//! A fault of size s that begins at a sample shifts the whitened innovations by s w, where w is
//! what the filter makes of it: e, the derivative by s of what the filter's prediction lacks,
//! gives w = (H e + d) / sd, and goes on as e <- F (e - K (H e + d)) + b. The likelihood ratio of
//! the best size is (sum w nu)^2 / 2 sum w^2 (A. S. Willsky, H. L. Jones, IEEE Trans. Autom.
//! Control 21 (1976), 108-112). Onsets are kept at ages that grow by about a constant ratio, so
//! that the work a sample does not grow with the oldest.

use std::collections::VecDeque;

use drivescope_numerics::dispatch::{Work, widest};

use super::filter::Correction;
use super::process::{Advanced, MECHANISMS, Mechanism, SENSORS, Sensed};
use crate::memory::{Memory, MemoryError, Walk};

/// Onsets that are kept.
const KEPT: usize = 14;
/// Age at which an onset is given up, samples.
pub(crate) const OLDEST: usize = 256;
/// Lanes of a vector: eight single-precision numbers fit what most processors have.
const WIDE: usize = 8;
const VECTORS: usize = MECHANISMS / WIDE;
/// Keeps a quotient finite where a mechanism does not show.
const NO_INFORMATION: f32 = 1e-12;

/// A number for each mechanism. Single precision tells an alarm; sizes are estimated in double.
type Lanes = [[f32; WIDE]; VECTORS];
const ZERO: Lanes = [[0.0; WIDE]; VECTORS];

/// In single precision.
#[inline(always)]
fn lanes(of: &[f64; MECHANISMS]) -> Lanes {
    let mut lanes = ZERO;
    for (lanes, of) in lanes.iter_mut().zip(of.as_chunks().0) {
        *lanes = single(of);
    }
    lanes
}

/// In single precision; a loop becomes vector code where `map` does not.
#[inline(always)]
fn single<const K: usize>(of: &[f64; K]) -> [f32; K] {
    let mut made = [0.0; K];
    for k in 0..K {
        made[k] = of[k] as f32;
    }
    made
}

/// All mechanisms from one onset.
#[derive(Debug, Clone)]
#[repr(align(64))]
struct Onset<const N: usize> {
    sample: usize,
    e: [Lanes; N],
    score: Lanes,
    gram: Lanes,
}

/// The likelihood ratios of all mechanisms and onsets.
#[derive(Debug, Clone)]
pub(crate) struct Onsets<const N: usize> {
    /// The oldest first.
    kept: Vec<Onset<N>>,
    most: Lanes,
    vectors: usize,
    /// States that move; those after them are parameters of the machine, which a fault leaves.
    moving: usize,
}

/// The best explanation of what was seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Peak {
    /// Logarithm of the likelihood ratio.
    pub(crate) ratio: f64,
    pub(crate) mechanism: usize,
    pub(crate) onset: usize,
}

/// What a sample does to every onset, in single precision.
struct Step<const N: usize> {
    sensors: [Lanes; SENSORS],
    states: [Lanes; N],
    rows: [[f32; N]; SENSORS],
    gain: [[f32; N]; SENSORS],
    inverse_sd: [f32; SENSORS],
    innovation: [f32; SENSORS],
    transition: [[f32; N]; N],
}

impl<const N: usize> Step<N> {
    #[inline(always)]
    fn new(sensed: &Sensed<N>, correction: &Correction<N>, advanced: &Advanced<N>) -> Self {
        let mut step = Self {
            sensors: [ZERO; SENSORS],
            states: [ZERO; N],
            rows: [[0.0; N]; SENSORS],
            gain: [[0.0; N]; SENSORS],
            inverse_sd: single(&correction.inverse_sd),
            innovation: single(&correction.innovation),
            transition: [[0.0; N]; N],
        };
        for m in 0..SENSORS {
            step.sensors[m] = lanes(&sensed.columns[m]);
            step.rows[m] = single(&sensed.rows[m]);
            step.gain[m] = single(&correction.gain[m]);
        }
        for n in 0..N {
            step.states[n] = lanes(&advanced.columns[n]);
            step.transition[n] = single(&advanced.transition[n]);
        }
        step
    }
}

impl<const N: usize> Onsets<N> {
    pub(crate) fn new(mechanisms: &[Mechanism], moving: usize) -> Self {
        let most = |j: usize| mechanisms.get(j).map_or(0.0, |mechanism| mechanism.most);
        let most = lanes(&std::array::from_fn(most));
        let vectors = mechanisms.len().div_ceil(WIDE);
        Self { kept: Vec::with_capacity(KEPT), most, vectors, moving }
    }

    /// The latest onset that is kept.
    pub(crate) fn latest(&self) -> Option<usize> {
        self.kept.iter().map(|onset| onset.sample).max()
    }

    /// Forgets all onsets.
    pub(crate) fn clear(&mut self) {
        self.kept.clear();
    }

    /// Opens an onset at the sample `now`, whose sensors are still to be taken in.
    pub(crate) fn open(&mut self, now: usize) {
        if self.kept.first().is_some_and(|oldest| now - oldest.sample >= OLDEST) {
            self.kept.remove(0);
        } else if self.kept.len() == KEPT {
            self.kept.remove(self.closest(now));
        }
        self.kept.push(Onset::new(now));
    }

    /// The onset whose neighbours lie nearest to each other in the logarithm of their ages.
    fn closest(&self, now: usize) -> usize {
        let age = |k: usize| self.kept.get(k).map_or(1, |onset| now + 1 - onset.sample) as f32;
        let (mut least, mut at) = (f32::INFINITY, 1);
        for k in 1..self.kept.len() {
            let gap = age(k - 1) / age(k + 1);
            if gap < least {
                (least, at) = (gap, k);
            }
        }
        at
    }

    /// Takes in a sample.
    #[inline]
    pub(crate) fn step(
        &mut self,
        sensed: &Sensed<N>,
        correction: &Correction<N>,
        advanced: &Advanced<N>,
    ) {
        widest(Stepping { onsets: self, sensed, correction, advanced });
    }

    /// The best explanation; nothing before the first sample.
    #[inline]
    pub(crate) fn peak(&self) -> Option<Peak> {
        let mut best = [[(f32::NEG_INFINITY, 0); WIDE]; VECTORS];
        widest(Comparing { onsets: self, best: &mut best });
        let mut top = (f32::NEG_INFINITY, 0, 0);
        for (mechanism, (ratio, k)) in best.into_iter().flatten().enumerate() {
            // Of equal ones the oldest onset.
            if ratio > top.0 || (ratio == top.0 && k < top.1) {
                top = (ratio, k, mechanism);
            }
        }
        let (ratio, k, mechanism) = top;
        let onset = self.kept.get(k)?.sample;
        (ratio > f32::NEG_INFINITY).then(|| Peak { ratio: ratio.into(), mechanism, onset })
    }
}

/// A sample taken in by every onset.
struct Stepping<'a, const N: usize> {
    onsets: &'a mut Onsets<N>,
    sensed: &'a Sensed<N>,
    correction: &'a Correction<N>,
    advanced: &'a Advanced<N>,
}

impl<const N: usize> Work for Stepping<'_, N> {
    #[inline(always)]
    fn run(self) {
        let step = Step::new(self.sensed, self.correction, self.advanced);
        for onset in &mut self.onsets.kept {
            for v in 0..self.onsets.vectors {
                // A count that the compiler knows keeps e in registers.
                match self.onsets.moving {
                    2 => onset.step::<2>(v, &step),
                    3 => onset.step::<3>(v, &step),
                    4 => onset.step::<4>(v, &step),
                    _ => onset.step::<N>(v, &step),
                }
            }
        }
    }
}

/// The greatest ratio of every mechanism, and the place of its onset.
struct Comparing<'a, const N: usize> {
    onsets: &'a Onsets<N>,
    best: &'a mut [[(f32, usize); WIDE]; VECTORS],
}

impl<const N: usize> Work for Comparing<'_, N> {
    #[inline(always)]
    fn run(self) {
        for v in 0..self.onsets.vectors {
            let (mut top, mut at) = ([f32::NEG_INFINITY; WIDE], [0_u32; WIDE]);
            for (onset, k) in self.onsets.kept.iter().zip(0..) {
                let ratio = onset.ratio(v, &self.onsets.most[v]);
                for j in 0..WIDE {
                    let is_greater = ratio[j] > top[j];
                    top[j] = if is_greater { ratio[j] } else { top[j] };
                    at[j] = if is_greater { k } else { at[j] };
                }
            }
            self.best[v] = std::array::from_fn(|j| (top[j], at[j] as usize));
        }
    }
}

impl<const N: usize> Onset<N> {
    /// Nothing seen of it yet.
    fn new(sample: usize) -> Self {
        Self { sample, e: [ZERO; N], score: ZERO, gram: ZERO }
    }

    /// Likelihood ratios of the best sizes, none beyond what is looked for.
    #[inline(always)]
    fn ratio(&self, v: usize, most: &[f32; WIDE]) -> [f32; WIDE] {
        let mut ratio = [0.0; WIDE];
        for j in 0..WIDE {
            let (score, gram) = (self.score[v][j], self.gram[v][j] + NO_INFORMATION);
            let free = score / gram;
            let size = if free > most[j] { most[j] } else { free };
            let size = if size < -most[j] { -most[j] } else { size };
            ratio[j] = size * (score - 0.5 * size * gram);
        }
        ratio
    }

    /// The first `D` states move.
    #[inline(always)]
    fn step<const D: usize>(&mut self, v: usize, step: &Step<N>) {
        let mut e: [[f32; WIDE]; D] = std::array::from_fn(|n| self.e[n][v]);
        let (mut score, mut gram) = (self.score[v], self.gram[v]);
        for m in 0..SENSORS {
            let (inverse_sd, innovation) = (step.inverse_sd[m], step.innovation[m]);
            if inverse_sd == 0.0 {
                continue;
            }
            let mut lacking = step.sensors[m][v];
            for n in 0..D {
                for j in 0..WIDE {
                    lacking[j] += step.rows[m][n] * e[n][j];
                }
            }
            for j in 0..WIDE {
                let w = lacking[j] * inverse_sd;
                score[j] += w * innovation;
                gram[j] += w * w;
            }
            for n in 0..D {
                for j in 0..WIDE {
                    e[n][j] -= step.gain[m][n] * lacking[j];
                }
            }
        }
        (self.score[v], self.gram[v]) = (score, gram);
        for r in 0..D {
            let mut next = step.states[r][v];
            for n in 0..D {
                for j in 0..WIDE {
                    next[j] += step.transition[r][n] * e[n][j];
                }
            }
            self.e[r][v] = next;
        }
    }
}

impl<const N: usize> Memory for Onset<N> {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        self.sample.walk(walk)?;
        self.e.walk(walk)?;
        walk.each([&mut self.score, &mut self.gram])
    }
}

impl<const N: usize> Memory for Onsets<N> {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        let mut kept: VecDeque<Onset<N>> = std::mem::take(&mut self.kept).into();
        walk.list(&mut kept, KEPT, || Onset::new(0))?;
        self.kept.extend(kept);
        Ok(())
    }
}
