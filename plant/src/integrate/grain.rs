//! Strides over a law that bends within a small change of speed, such as Stribeck's.
//!
//! How fast the shaft crosses that zone follows from what pulls at it, not from any rate of the
//! drive, so a sub-step that turned out to be too long there is made again in parts.

use drivescope_numerics::Real;

use crate::model::Model;

/// Change of speed in a step over the grain of the law: 0.25 leaves 1e-7 of a variable's range
/// where the shaft reverses (the error falls with its fourth power).
const STRIDE: f64 = 0.25;
/// Beyond this many grains the law is flat: exp(-4^2) is 1e-7.
const ZONE: f64 = 4.0;
/// Parts that a sub-step is split into at most.
const MOST_PARTS: f64 = 256.0;

/// The grain of each lane's laws, rad/s.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grain<const N: usize>(pub(super) [f64; N]);

impl<const N: usize> Grain<N> {
    pub(super) fn new<R: Real>(model: &Model<R, N>) -> Self {
        Self(std::array::from_fn(|l| model.grain(l)))
    }

    /// That of one lane.
    pub(super) fn lane(&self, l: usize) -> Grain<1> {
        Grain([self.0[l]])
    }

    /// Into how many parts a step of lane `l` from speed `first` to `last` should be split.
    #[inline(always)]
    pub(super) fn parts(&self, l: usize, first: f64, last: f64) -> f64 {
        if self.too_coarse(l, first, last) {
            let parts = ((last - first).abs() / (STRIDE * self.0[l])).ceil();
            if parts < MOST_PARTS { parts } else { MOST_PARTS }
        } else {
            1.0
        }
    }

    /// Whether that is more than one.
    #[inline(always)]
    pub(super) fn too_coarse(&self, l: usize, first: f64, last: f64) -> bool {
        let grain = self.0[l];
        let (a, b) = (first.abs(), last.abs());
        let nearest = if a < b { a } else { b };
        let inside = (nearest < ZONE * grain) | (first * last < 0.0);
        inside & ((last - first).abs() > STRIDE * grain)
    }
}
