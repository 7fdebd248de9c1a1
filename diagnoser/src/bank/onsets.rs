//! Generalised likelihood ratios over mechanism and onset, recursively.
//!
//! A fault of size s that begins at a sample shifts the whitened innovations by s w, where w is
//! what the filter makes of it: e, the derivative by s of what the filter's prediction lacks,
//! gives w = (H e + d) / sd, and goes on as e <- F (e - K (H e + d)) + b. The likelihood ratio of
//! the best size is (sum w nu)^2 / 2 sum w^2 (A. S. Willsky, H. L. Jones, IEEE Trans. Autom.
//! Control 21 (1976), 108-112). Onsets are kept at ages that grow by about a constant ratio, so
//! that the work a sample does not grow with the oldest.

use std::collections::VecDeque;

use super::filter::Correction;
use super::process::{Advanced, MECHANISMS, Mechanism, SENSORS, Sensed};
use crate::memory::{Memory, MemoryError, Walk};

/// Onsets that are kept.
const KEPT: usize = 14;
/// Age at which an onset is given up, samples.
pub(crate) const OLDEST: usize = 256;
/// Lanes of a vector: four single-precision numbers fit the least that a 64-bit processor has.
const WIDE: usize = 4;
const VECTORS: usize = MECHANISMS / WIDE;
/// Keeps a quotient finite where a mechanism does not show.
const NO_INFORMATION: f32 = 1e-12;

/// A number for each mechanism. Single precision tells an alarm; sizes are estimated in double.
type Lanes = [[f32; WIDE]; VECTORS];
const ZERO: Lanes = [[0.0; WIDE]; VECTORS];

fn lanes(of: impl Fn(usize) -> f64) -> Lanes {
    std::array::from_fn(|v| std::array::from_fn(|j| of(WIDE * v + j) as f32))
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
    fn new(sensed: &Sensed<N>, correction: &Correction<N>, advanced: &Advanced<N>) -> Self {
        let small = |columns: &[f64; MECHANISMS]| lanes(|j| columns[j]);
        let row = |row: &[f64; N]| row.map(|x| x as f32);
        Self {
            sensors: sensed.columns.each_ref().map(small),
            states: advanced.columns.each_ref().map(small),
            rows: sensed.rows.each_ref().map(row),
            gain: correction.gain.each_ref().map(row),
            inverse_sd: correction.inverse_sd.map(|x| x as f32),
            innovation: correction.innovation.map(|x| x as f32),
            transition: advanced.transition.each_ref().map(row),
        }
    }
}

impl<const N: usize> Onsets<N> {
    pub(crate) fn new(mechanisms: &[Mechanism], moving: usize) -> Self {
        let most = lanes(|j| mechanisms.get(j).map_or(0.0, |mechanism| mechanism.most));
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
        let step = Step::new(sensed, correction, advanced);
        for onset in &mut self.kept {
            for v in 0..self.vectors {
                // A count that the compiler knows keeps e in registers.
                match self.moving {
                    2 => onset.step::<2>(v, &step),
                    3 => onset.step::<3>(v, &step),
                    4 => onset.step::<4>(v, &step),
                    _ => onset.step::<N>(v, &step),
                }
            }
        }
    }

    /// The best explanation; nothing before the first sample.
    #[inline]
    pub(crate) fn peak(&self) -> Option<Peak> {
        let (mut top, mut best) = (f32::NEG_INFINITY, None);
        for onset in &self.kept {
            for v in 0..self.vectors {
                let ratio = onset.ratio(v, &self.most[v]);
                for (j, ratio) in ratio.into_iter().enumerate() {
                    if ratio > top {
                        top = ratio;
                        best = Some((WIDE * v + j, onset.sample));
                    }
                }
            }
        }
        best.map(|(mechanism, onset)| Peak { ratio: top.into(), mechanism, onset })
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
