//! The last n values of a signal in every lane, newest first, as [`crate::history`] has them of one.

/// Fixed memory for the last rows of lanes; zeros before the first.
#[derive(Debug, Clone)]
pub(crate) struct HistoryLanes<const N: usize> {
    twice: Vec<[f64; N]>,
    newest: usize,
}

impl<const N: usize> HistoryLanes<N> {
    pub(crate) fn new(length: usize) -> Self {
        Self { twice: vec![[0.0; N]; 2 * length], newest: 0 }
    }

    #[inline(always)]
    pub(crate) fn push(&mut self, values: &[f64; N]) {
        let length = self.twice.len() / 2;
        if length == 0 {
            return;
        }
        self.newest = if self.newest == 0 { length - 1 } else { self.newest - 1 };
        self.twice[self.newest] = *values;
        self.twice[self.newest + length] = *values;
    }

    /// The last rows, newest first.
    #[inline(always)]
    pub(crate) fn window(&self) -> &[[f64; N]] {
        &self.twice[self.newest..][..self.twice.len() / 2]
    }
}

/// Scalar product of each lane, in the order of additions of [`crate::history::dot`].
#[inline(always)]
pub(crate) fn dot<const N: usize>(a: &[f64], b: &[[f64; N]]) -> [f64; N] {
    let mut partial = [[0.0; N]; 4];
    let (a_head, a_tail) = a.as_chunks::<4>();
    let (b_head, b_tail) = b.as_chunks::<4>();
    for (a, b) in a_head.iter().zip(b_head) {
        for part in 0..4 {
            for l in 0..N {
                partial[part][l] += a[part] * b[part][l];
            }
        }
    }
    let mut tail = [0.0; N];
    for (a, b) in a_tail.iter().zip(b_tail) {
        for l in 0..N {
            tail[l] += a * b[l];
        }
    }
    let mut sum = [0.0; N];
    for l in 0..N {
        sum[l] = (partial[0][l] + partial[1][l]) + (partial[2][l] + partial[3][l]) + tail[l];
    }
    sum
}
