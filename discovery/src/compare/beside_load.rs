//! What a shape explains beside a random load: the ratio of likelihoods in the filter.
//!
//! A random load that passes through a loop or an observer leaves an error that an autoregression
//! makes white in the mean only; where the shaft stands or turns round it does not. The filter knows
//! when the load is seen and when it is not.

use drivescope_plant::drive::Drive;
use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::drive_motion::{DriveMotion, Scales};
use super::series;
use super::shape::Shape;
use crate::case::Setting;
use crate::estimate::{Evidence, Fit};
use crate::likelihood::{Alongside, Filtered, Inverse, Scene, Series};

/// Whether the drive has been brought to its best beside a random load.
#[derive(Clone, Copy)]
pub(crate) enum Load<'a> {
    Sought,
    /// With the recordings that are compared as those of its fit; nothing where it overflows, or along a
    /// known motion.
    Known(Option<&'a Filtered>),
}

/// A drive filtered along its recordings.
pub(super) struct BesideLoad {
    alongside: Alongside,
    motions: Vec<DriveMotion>,
    scales: Scales,
    limit: Option<f64>,
}

impl BesideLoad {
    /// Nothing where the drive overflows, or along a known motion, whose input answers the load.
    pub(super) fn of(
        drive: &Drive,
        setting: &Setting,
        (evidence, fits): (&Evidence, &[Fit]),
        (load, limit): (Load<'_>, Option<f64>),
    ) -> Option<Self> {
        let at = (evidence, fits);
        let sought;
        let filtered = match load {
            Load::Known(filtered) => filtered?,
            Load::Sought if Inverse::of(Scene::whole_at(drive, setting, at)).is_some() => {
                return None;
            }
            Load::Sought => {
                sought = Filtered::of(Scene::at(drive, setting, at), None)?;
                &sought
            }
        };
        let alongside = Alongside::fitted(filtered)?;
        let along = alongside.recordings();
        let motions: Vec<DriveMotion> = along
            .map(|(it, ticks)| DriveMotion::filtered(it, ticks, &evidence.recordings[it.place]))
            .collect();
        let scales = Scales::new(&motions, drive.motor.j);
        Some(Self { alongside, motions, scales, limit })
    }

    /// Probability by chance of as much as that shape explains beside those that are known.
    pub(super) fn p_value(&self, known: &[Shape], shape: Shape) -> Option<f64> {
        let all: Vec<Shape> = known.iter().copied().chain([shape]).collect();
        let columns = |shapes: &[Shape]| shapes.iter().map(|it| it.columns()).sum::<usize>();
        let before = columns(known);
        let groups = [before, columns(&all)];
        let groups = if before == 0 { &groups[1..] } else { &groups[..] };
        let series = |recording: usize| {
            let sets = [known, &all];
            let sets = &sets[sets.len() - groups.len()..];
            sets.iter().flat_map(|shapes| self.series(shapes, recording)).collect()
        };
        let ratios = self.alongside.log_ratios(series, groups)?;
        let after = ratios.last()?;
        let gain = after - if before == 0 { 0.0 } else { ratios[0] };
        let law = ChiSquared::new(shape.columns() as f64).ok()?;
        Some(law.sf(2.0 * gain.max(0.0)))
    }

    fn series(&self, shapes: &[Shape], recording: usize) -> Vec<Series> {
        let motion = &self.motions[recording];
        let of = |shape: &Shape, column: usize| match shape.series(
            column,
            motion,
            &self.scales,
            self.limit,
        ) {
            series::Series::Balance(forcing) => {
                Series { torque: forcing.torque, voltage: forcing.voltage, ..Series::default() }
            }
            series::Series::Shown(output, values) => {
                let mut shown = Series::default().shown;
                if let Some(of_sensor) = shown.get_mut(output as usize) {
                    *of_sensor = values;
                }
                Series { shown, ..Series::default() }
            }
        };
        let all = shapes.iter().flat_map(|it| (0..it.columns()).map(move |column| (it, column)));
        all.map(|(shape, column)| of(shape, column)).collect()
    }
}
