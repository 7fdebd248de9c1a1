//! The signals that say when rows were sampled: those that a file is read for.
//!
//! What stands beside them, such as a set point that a controller wrote evenly, is no sample of the
//! machine: another column in the file must not change when its speed was measured.

use std::ops::Range;

use super::instants::Instants;
use super::motion;
use super::slots::Slots;
use crate::canonical;
use crate::signal::Signal;

/// Speeds and their positions.
const MOTIONS: [(&str, &str); 4] =
    [("omega", "theta"), ("v", "x"), ("omega_load", "theta_load"), ("v_load", "x_load")];
/// What is written, not measured.
const WRITTEN: &str = "reference";

/// The signals that are asked.
pub(crate) struct Witnesses<'a> {
    signals: Vec<&'a [f64]>,
    /// Speeds, each beside the position of the same motion.
    motions: Vec<[&'a [f64]; 2]>,
}

impl<'a> Witnesses<'a> {
    /// Those with a meaning; where no signal has one, all.
    pub(crate) fn among(all: &'a [Signal]) -> Self {
        let of = |name: &str| Some(all.iter().find(|it| it.name == name)?.values.as_slice());
        let both = |(speed, position)| Some([of(speed)?, of(position)?]);
        let is_read = |it: &&Signal| it.name != WRITTEN && canonical::exact(&it.name).is_some();
        let any = all.iter().any(|it| is_read(&it));
        let asked = all.iter().filter(|it| !any || is_read(it));
        Self {
            signals: asked.map(|it| it.values.as_slice()).collect(),
            motions: MOTIONS.into_iter().filter_map(both).collect(),
        }
    }

    /// Whether rows were sampled at their stamps; none where nothing tells. A speed and its
    /// position, which one law binds from row to row, have the first word.
    pub(super) fn sampled_at_stamps(
        &self,
        time: &[f64],
        kept: Option<&[usize]>,
        segments: &[(Range<usize>, &Slots)],
    ) -> Option<bool> {
        let row = |k: usize| kept.map_or(k, |kept| kept[k]);
        let motions = self.motions.iter().filter_map(|[speed, position]| {
            motion::instants(time, |k| speed[row(k)], |k| position[row(k)], segments)
        });
        let by_motion = Instants::together(motions.map(|it| (it.by_stamps, it.error.powi(2))));
        by_motion
            .sampled_at_stamps()
            .or_else(|| Instants::of(time, &self.signals, kept, segments).sampled_at_stamps())
    }
}
