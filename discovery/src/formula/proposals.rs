//! The formulas that are tried: every factor of the speed, of the current, their products, and waves
//! over the position times the plain ones; the constants of their shapes on a grid.

use std::f64::consts::TAU;

use drivescope_plant::drive::{Drive, Input, Motion};
use drivescope_plant::effects::custom::Target;

use super::grammar::{Factor, Form, Magnitude, Names, Wave};

/// Widths over the greatest value of the variable.
const WIDTHS: [f64; 6] = [0.02, 0.05, 0.12, 0.25, 0.5, 1.0];
/// Half waves up to the greatest value of the variable.
const HALF_WAVES: [f64; 5] = [0.6, 1.0, 1.6, 2.6, 4.2];
/// Places of a bump over the greatest value, and its widths over its place.
const BUMPS: [f64; 8] = [0.12, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.85];
const BUMP_WIDTHS: [f64; 2] = [0.2, 0.4];
/// Widths of the steep side of a bell and of the bell.
const STEEP: [f64; 2] = [0.02, 0.06];
const BELLS: [f64; 3] = [0.12, 0.25, 0.5];
/// Periods a revolution of a wave alone, and of one that multiplies something.
const PERIODS: usize = 24;
const FEW_PERIODS: usize = 12;
/// Where a root begins, over the greatest value of its variable, at most.
const ROUNDED: f64 = 1e-3;

/// The greatest values along the recordings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Greatest {
    pub(super) speed: f64,
    pub(super) current: f64,
    /// From the least to the greatest position.
    pub(super) travel: f64,
}

/// What the variables are called in a drive whose greatest values are these.
pub(super) fn names(drive: &Drive, greatest: &Greatest) -> Names {
    let (speed, position) = match drive.motion {
        Motion::Rotary => ("omega", "theta"),
        Motion::Linear => ("v", "x"),
    };
    // A force-driven drive has no current but what commands it.
    let current = if drive.motor.input == Input::Force { "u" } else { "i" };
    // A power of ten, so that it reads well.
    let rounded = |most: f64| 10f64.powf((ROUNDED * most).max(f64::MIN_POSITIVE).log10().floor());
    let rounded = [rounded(greatest.speed), rounded(greatest.current)];
    Names { speed, current, position, rounded }
}

/// A formula in all its shapes.
pub(super) type Kind = Vec<Form>;

/// Factors of one kind in all their shapes.
type Factors = Vec<Factor>;

fn both(magnitude: Magnitude) -> [Factors; 2] {
    [true, false].map(|odd| vec![Factor { odd, magnitude }])
}

/// Factors without a constant.
fn plain() -> Vec<Factors> {
    use Magnitude::*;
    let mut all = vec![vec![Factor { odd: true, magnitude: One }]];
    all.extend([Root, Linear, ThreeHalves, Square, Cube].into_iter().flat_map(both));
    all
}

/// Factors with a width.
fn wide(most: f64) -> Vec<Factors> {
    let magnitudes: [fn(f64) -> Magnitude; 5] = [
        |a| Magnitude::Decay { a },
        |a| Magnitude::LinearDecay { a },
        |a| Magnitude::Bell { a },
        |a| Magnitude::LinearBell { a },
        |a| Magnitude::Saturating { a },
    ];
    let of = |odd: bool, magnitude: &fn(f64) -> Magnitude| {
        WIDTHS.map(|share| Factor { odd, magnitude: magnitude(share * most) }).to_vec()
    };
    let each = magnitudes.iter().flat_map(|it| [of(true, it), of(false, it)]);
    each.collect()
}

/// Factors that stand alone only: of waves, bumps and bells with a steep side.
fn special(most: f64) -> Vec<Factors> {
    let half_waves = |odd: bool, magnitude: fn(f64) -> Magnitude| {
        let of = |waves: f64| Factor { odd, magnitude: magnitude(most / (0.5 * TAU * waves)) };
        HALF_WAVES.map(of).to_vec()
    };
    let bumps = |odd: bool| {
        let of = |place: f64| {
            let b = place * most;
            BUMP_WIDTHS.map(|wide| Factor { odd, magnitude: Magnitude::Bump { a: wide * b, b } })
        };
        BUMPS.iter().flat_map(|place| of(*place)).collect()
    };
    let steep = |b: f64| {
        STEEP.map(|a| Factor {
            odd: true,
            magnitude: Magnitude::SteepBell { a: a * most, b: b * most },
        })
    };
    vec![
        half_waves(true, |a| Magnitude::Sine { a }),
        half_waves(false, |a| Magnitude::Cosine { a }),
        bumps(true),
        bumps(false),
        BELLS.iter().flat_map(|b| steep(*b)).collect(),
    ]
}

/// Every formula for a drive.
pub(super) fn proposals(drive: &Drive, greatest: &Greatest) -> Vec<Kind> {
    let voltage = drive.motor.input == Input::Voltage;
    let targets =
        if voltage { vec![Target::Torque, Target::Voltage] } else { vec![Target::Torque] };
    targets.into_iter().flat_map(|target| of_target(target, drive.motion, greatest)).collect()
}

fn of_target(target: Target, motion: Motion, greatest: &Greatest) -> Vec<Kind> {
    let none = Form { target, speed: None, current: None, wave: None };
    let [speed, current] = [greatest.speed, greatest.current];
    let of_speed = |factors: &Factors| -> Kind {
        factors.iter().map(|it| Form { speed: Some(*it), ..none }).collect()
    };
    let of_current = |factors: &Factors| -> Kind {
        factors.iter().map(|it| Form { current: Some(*it), ..none }).collect()
    };
    let mut all: Vec<Kind> = Vec::new();
    for factors in [plain(), wide(speed), special(speed)].iter().flatten() {
        all.push(of_speed(factors));
    }
    for factors in [plain(), wide(current), special(current)].iter().flatten() {
        all.push(of_current(factors));
    }
    let product = |one: &Factors, other: &Factors| -> Kind {
        let of = |it: &Form| {
            let current = other.iter().map(|factor| Form { current: Some(*factor), ..*it });
            current.collect::<Vec<_>>()
        };
        of_speed(one).iter().flat_map(of).collect()
    };
    // A width in one of two factors is enough: few recordings tell two.
    for one in &plain() {
        all.extend(plain().iter().map(|other| product(one, other)));
        all.extend(wide(current).iter().map(|other| product(one, other)));
        all.extend(wide(speed).iter().map(|wide| product(wide, one)));
    }
    let waved = |form: Form, wave: Wave| vec![Form { wave: Some(wave), ..form }];
    all.extend(waves(motion, PERIODS, greatest).into_iter().map(|wave| waved(none, wave)));
    let plain = plain();
    let few =
        plain.iter().filter(|it| matches!(it[0].magnitude, Magnitude::One | Magnitude::Linear));
    let simple: Vec<&Factors> = few.collect();
    for wave in waves(motion, FEW_PERIODS, greatest) {
        for factors in &plain {
            all.extend(of_speed(factors).into_iter().map(|it| waved(it, wave)));
            all.extend(of_current(factors).into_iter().map(|it| waved(it, wave)));
        }
        for (one, other) in simple.iter().flat_map(|one| simple.iter().map(move |it| (one, it))) {
            all.extend(product(one, other).into_iter().map(|it| waved(it, wave)));
        }
    }
    all
}

/// Waves up to so many a revolution, or along the way of an axis.
fn waves(motion: Motion, most: usize, greatest: &Greatest) -> Vec<Wave> {
    let numbers = 1..=most;
    match motion {
        Motion::Rotary => numbers.map(Wave::Periods).collect(),
        Motion::Linear if greatest.travel > 0.0 => {
            numbers.map(|it| Wave::Number(it as f64 * TAU / greatest.travel)).collect()
        }
        Motion::Linear => Vec::new(),
    }
}
