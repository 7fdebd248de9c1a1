//! Times of pieces of work that run by turns in one process, so that their ratios hold where the
//! machine's own speed drifts.

use std::time::Instant;

/// Turns in which every piece of work runs once.
const TURNS: usize = 9;

/// Least seconds of a call of each: other work on the machine only adds.
pub(super) fn least<const K: usize>(mut works: [&mut dyn FnMut(); K]) -> [f64; K] {
    let mut least = [f64::INFINITY; K];
    for _ in 0..TURNS {
        for (least, work) in least.iter_mut().zip(&mut works) {
            let start = Instant::now();
            work();
            *least = least.min(start.elapsed().as_secs_f64());
        }
    }
    least
}

/// Least seconds of a call of one.
pub(super) fn least_of(work: &mut dyn FnMut()) -> f64 {
    let [seconds] = least([work]);
    seconds
}
