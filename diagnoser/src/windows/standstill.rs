//! Whether a drive rests, or runs down to rest.

use super::Lag;
use crate::memory::{Memory, MemoryError, Walk};

/// Windows for which a drive may run down.
const RUNNING_DOWN: usize = 2;
/// Share of what the width of the dead zone would drive, below which the output stands.
const STANDS: f64 = 0.1;

/// A drive whose inputs overcome no friction: it runs down for a while, then it stands. Neither says
/// anything of the machine that a baseline in motion could be held against. An output that does not
/// fall to rest is judged all the same: a sensor may be stuck.
#[derive(Debug, Clone, Default)]
pub struct Standstill {
    /// Samples since the inputs overcome no friction.
    inside: usize,
}

impl Standstill {
    /// Takes a sample; whether it is one at rest. `window` is the length of a window, samples.
    pub fn step(
        &mut self,
        model: &Lag,
        u: impl Iterator<Item = f64>,
        y: f64,
        window: usize,
    ) -> bool {
        if !model.is_at_rest(u) {
            self.inside = 0;
            return false;
        }
        self.inside = self.inside.saturating_add(1);
        self.inside <= RUNNING_DOWN * window || y.abs() <= STANDS * model.over_dead_zones()
    }
}

impl Memory for Standstill {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        self.inside.walk(walk)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drive_runs_down_and_stands_and_a_stuck_sensor_does_not() {
        let model = Lag { pole: 0.9, constant: 0.0, gains: vec![10.0], zones: vec![2.0] };
        let mut rest = Standstill::default();
        assert!(!rest.step(&model, [3.0].into_iter(), 10.0, 50));
        let run_down = |k: usize| 10.0 * 0.9_f64.powi(k as i32);
        assert!((0..500).all(|k| rest.step(&model, [0.0].into_iter(), run_down(k), 50)));
        assert!(!rest.step(&model, [3.0].into_iter(), 10.0, 50));
        let stuck = (0..500).filter(|_| rest.step(&model, [0.0].into_iter(), 10.0, 50)).count();
        assert_eq!(stuck, 100);
        // Without a dead zone nothing rests.
        let free = Lag { zones: vec![0.0], ..model };
        assert!(!rest.step(&free, [0.0].into_iter(), 0.0, 50));
    }
}
