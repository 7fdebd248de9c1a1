//! Relative force error of a force-driven drive, the figure that is usual in robotics:
//!
//! |K_m u - inverse dynamics(x)| / |K_m u|, both low-pass filtered at a stated band.
//!
//! x (or v) and u pass a Butterworth filter of order four forwards and backwards, so that nothing
//! is delayed; speed and acceleration are central differences. The inverse dynamics is the
//! drive's own right-hand side: J (a - a_model) is what it lacks.

use std::f64::consts::PI;

use drivescope_plant::drive::{Drive, Input};
use drivescope_plant::model::{Applied, POSITION, SPEED, field};

use crate::measured::{Measured, Output};

/// The band that is used where none is asked for, Hz.
pub const USUAL_BAND_HZ: f64 = 100.0;
/// Cut-off times at either end that the filter needs to settle.
const SETTLING: f64 = 5.0;
/// Dampings of the two sections of a Butterworth filter of order four.
const DAMPINGS: [f64; 2] = [0.382_683_432_365_089_8, 0.923_879_532_511_286_7];

/// The relative force error in a band of `band_hz`; nothing if the drive is not force-driven, has
/// states besides speed and position, or the recording shows no motion or is too short or too
/// slow for the band.
pub fn relative_force_error(drive: &Drive, measured: &Measured, band_hz: f64) -> Option<f64> {
    let model = drive.model();
    let h = measured.period_s;
    if drive.motor.input != Input::Force || model.states() > POSITION + 1 || band_hz * h > 0.4 {
        return None;
    }
    let channel = measured.output(Output::Speed).or(measured.output(Output::Position))?;
    let margin = (SETTLING / (band_hz * h)).ceil() as usize + 1;
    let (mut missing, mut all) = (0.0, 0.0);
    for piece in &measured.pieces {
        let shown = &channel.values[piece.clone()];
        if piece.len() <= 2 * margin || shown.iter().any(|value| value.is_nan()) {
            continue;
        }
        let smooth = |values: &[f64]| filtered(values, band_hz * h);
        let (shown, u) = (smooth(shown), smooth(&measured.u[piece.clone()]));
        for k in margin..piece.len() - margin {
            let slope = (shown[k + 1] - shown[k - 1]) / (2.0 * h);
            let bend = (shown[k + 1] - 2.0 * shown[k] + shown[k - 1]) / (h * h);
            let (position, speed, acceleration) = match channel.output {
                Output::Position => (shown[k], slope, bend),
                _ => (
                    measured.angle.as_ref().map_or(0.0, |angle| angle[piece.start + k]),
                    shown[k],
                    slope,
                ),
            };
            let load = measured.load.as_ref().map_or(0.0, |load| load[piece.start + k]);
            let applied = Applied { u: [u[k]], load: [load], time: measured.time(piece.start + k) };
            let mut x = vec![[0.0]; POSITION + 1];
            (x[SPEED], x[POSITION]) = ([speed], [position]);
            let mut rates = x.clone();
            field(&model, &x, &applied, &[if speed < 0.0 { -1.0 } else { 1.0 }], &mut rates, None);
            missing += (drive.motor.j * (acceleration - rates[SPEED][0])).powi(2);
            all += (drive.motor.k_m * u[k]).powi(2);
        }
    }
    (all > 0.0).then(|| (missing / all).sqrt())
}

/// The values through the filter forwards and backwards; `cut` is its cut-off times the period.
fn filtered(values: &[f64], cut: f64) -> Vec<f64> {
    let first = values.first().copied().unwrap_or(0.0);
    // Without the offset the filter begins settled.
    let mut filtered: Vec<f64> = values.iter().map(|value| value - first).collect();
    for _ in 0..2 {
        for damping in DAMPINGS {
            section(&mut filtered, cut, damping);
        }
        filtered.reverse();
    }
    filtered.iter().map(|value| value + first).collect()
}

/// A low-pass section of order two by the bilinear transform, from rest at its first value.
fn section(values: &mut [f64], cut: f64, damping: f64) {
    let warped = (PI * cut).tan();
    let scale = 1.0 / (1.0 + 2.0 * damping * warped + warped * warped);
    let (b, a1) = (warped * warped * scale, 2.0 * (warped * warped - 1.0) * scale);
    let a2 = (1.0 - 2.0 * damping * warped + warped * warped) * scale;
    let first = values.first().copied().unwrap_or(0.0);
    let (mut x1, mut x2, mut y1, mut y2) = (first, first, first, first);
    for value in values {
        let x = *value;
        let y = b * (x + 2.0 * x1 + x2) - a1 * y1 - a2 * y2;
        (x2, x1, y2, y1) = (x1, x, y1, y);
        *value = y;
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use drivescope_recording::{Recording, Signal};

    const EMPS: &str = include_str!("../../scenarios/drives/emps.toml");

    #[test]
    fn the_band_is_cut_at_half_power_each_way() {
        let cut = 0.05;
        let wave: Vec<f64> = (0..4000).map(|k| (TAU * cut * f64::from(k)).sin()).collect();
        let passed = filtered(&wave, cut);
        let rms =
            |some: &[f64]| (some.iter().map(|x| x * x).sum::<f64>() / some.len() as f64).sqrt();
        let gain = rms(&passed[1000..3000]) / rms(&wave[1000..3000]);
        assert!((gain - 0.5).abs() < 1e-3, "{gain}");
        assert_eq!(filtered(&[3.0; 50], cut), [3.0; 50]);
    }

    #[test]
    fn a_missing_force_is_seen_with_its_share() {
        let text = EMPS.to_owned();
        let drive = Drive::parse(&text, "emps.toml").expect("a right drive file");
        // Prescribed motion x = A sin(w t), always forward by a ramp; u from the inverse dynamics.
        let (w, h) = (10.0, 0.001);
        let point = |k: i32| {
            let t = f64::from(k) * h;
            let (sin, cos) = (w * t).sin_cos();
            (0.005 * sin + 0.1 * t, 0.05 * cos + 0.1, -0.5 * sin)
        };
        let effects = |v: f64| drive.motor.b_m * v + 20.3935 + constant(&drive);
        let force = |k: i32| {
            let (_, v, a) = point(k);
            drive.motor.j * a + effects(v)
        };
        let u: Vec<f64> = (0..5000).map(|k| force(k) / drive.motor.k_m).collect();
        let x = (0..5000).map(|k| point(k).0).collect();
        let signal = |name: &str, unit: &str, values| Signal {
            name: name.into(),
            unit: unit.into(),
            values,
        };
        let signals = vec![signal("u", "V", u.clone()), signal("x", "m", x)];
        let recording = Recording::new("motion", 0.0, h, signals);
        let measured = Measured::new(&drive, &recording).expect("usable");
        let error = |drive: &Drive| {
            relative_force_error(drive, &measured, USUAL_BAND_HZ).expect("it has one")
        };
        assert!(error(&drive) < 1e-3, "{}", error(&drive));
        let mut stronger = drive.clone();
        stronger.set("coulomb.T_c", 25.3935).expect("possible");
        let rms = (u.iter().map(|u| (drive.motor.k_m * u).powi(2)).sum::<f64>() / 5000.0).sqrt();
        assert!((error(&stronger) * rms / 5.0 - 1.0).abs() < 0.02, "{}", error(&stronger));
    }

    /// The constant load of the file, if it has one.
    fn constant(drive: &Drive) -> f64 {
        let all = drive.parameters();
        all.iter().find(|it| it.name == "constant_load.T_0").map_or(0.0, |it| it.value)
    }
}
