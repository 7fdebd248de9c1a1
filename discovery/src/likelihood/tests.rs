//! The whole chain against what can be computed otherwise.

use drivescope_plant::drive::{Drive, EffectData};
use drivescope_plant::effects::registry::REGISTRY;

use super::columns::{Pass, Source};
use super::direction::Direction;
use super::filter::track;
use super::gram::{Products, References, gram};
use super::marginal::{Terms, coefficients, log_evidence, standing_out};
use super::noise::Noise;
use super::state::SENSORS;
use super::track::Track;
use crate::measured::Measured;
use crate::testing::{bench, dr300, noisy};

const SDS: [f64; 2] = [0.01, 0.3];
const NOISE: Noise = Noise {
    load_sd: 50.0,
    load_s: 0.1,
    voltage_sd: 10.0,
    cycle: None,
    voltage_s: 0.02,
    sensors: [SDS[0], SDS[1], 1.0],
};

fn tied() -> Drive {
    let mut drive = dr300();
    drive.motor.tie_k = false;
    drive
}

fn measured(drive: &Drive) -> Measured {
    let recording = noisy(bench(drive, 2.0, 0.001), SDS, 5);
    Measured::new(drive, &recording).expect("it can be used")
}

fn direction(measured: &Measured) -> Direction {
    Direction::of(measured, &NOISE.sensors)
}

fn filtered(drive: &Drive, measured: &Measured) -> Track {
    let direction = direction(measured);
    track(drive, (measured, &direction), &NOISE).expect("it does not overflow")
}

/// Whitened innovations of a track, those of a few samples at the beginning left out.
fn innovations(track: &Track) -> Vec<f64> {
    let of = |tick: &super::track::Tick| {
        let all = (0..SENSORS).filter(|it| tick.inverse_sd[*it] > 0.0);
        all.map(|it| tick.innovation[it]).collect::<Vec<_>>()
    };
    track.ticks.iter().flat_map(of).collect()
}

fn column(drive: &Drive, measured: &Measured, track: &Track, source: Source<'_>) -> Vec<f64> {
    let direction = direction(measured);
    let mut pass = Pass::new(drive, (measured, &direction), source);
    let mut blocks = vec![vec![0.0; pass.len() * 2 * track.ticks.len()]];
    pass.fill(&[track], 0..track.ticks.len(), &mut blocks, |_| ());
    blocks[0].chunks(pass.len()).map(|row| row[0]).collect()
}

/// Share of a column by which it differs from another, in the direction of the first.
fn off(column: &[f64], other: &[f64]) -> f64 {
    let power: f64 = column.iter().map(|value| value * value).sum();
    let apart: f64 = column.iter().zip(other).map(|(a, b)| (a - b) * (a - b)).sum();
    (apart / power).sqrt()
}

#[test]
fn innovations_of_the_true_drive_are_white_and_of_size_one() {
    // Where dry friction turns round the filter knows less than the drive, by intent.
    let mut drive = tied();
    drive.effects.clear();
    // No random load in the recording: the filter is told so.
    let noise = Noise { load_sd: 1e-9, voltage_sd: 1e-9, ..NOISE };
    let measured = measured(&drive);
    let direction = direction(&measured);
    let track = track(&drive, (&measured, &direction), &noise).expect("it does not overflow");
    let w: Vec<f64> = innovations(&track).split_off(100);
    let n = w.len() as f64;
    let power = w.iter().map(|w| w * w).sum::<f64>() / n;
    // Four standard deviations of both.
    assert!((power - 1.0).abs() < 4.0 * (2.0 / n).sqrt(), "{power}");
    let lag = w.iter().zip(&w[2..]).map(|(a, b)| a * b).sum::<f64>() / n;
    assert!(lag.abs() < 4.0 / n.sqrt(), "{lag}");
}

/// Of every law of the library with a derivative at its null: the column is what the filter's
/// innovations lose when the law stands in the drive.
#[test]
fn the_column_of_every_law_is_the_difference_of_the_whole_filter() {
    let drive = tied();
    let measured = measured(&drive);
    let mut compared = 0;
    for entry in REGISTRY {
        let info = entry.info;
        let identified = !info.nulls.is_empty() && info.nulls.iter().all(|(_, null)| *null == 0.0);
        if !identified || drive.refuses(entry).is_some() {
            continue;
        }
        let effect = |coefficient: f64| {
            let value = |it: &drivescope_plant::effects::law::Parameter| {
                let null = info.nulls.iter().position(|(name, _)| *name == it.name);
                let value = match null {
                    Some(0) => coefficient,
                    Some(_) => 0.0,
                    None => it.nominal,
                };
                (it.name.to_owned(), value)
            };
            let parameters = entry.parameters.iter().map(value).collect();
            EffectData { kind: info.id.into(), id: "law".into(), parameters, law: None }
        };
        let with = |coefficient: f64| {
            let mut drive = drive.clone();
            drive.effects.push(effect(coefficient));
            drive
        };
        let name = info.nulls[0].0;
        let own = entry.parameters.iter().find(|it| it.name == name).expect("its own");
        let (at_null, names) = (with(0.0), [format!("law.{name}")]);
        let source = Source::Parameters { drive: &at_null, names: &names };
        // A law over the current has a sample done in more parts, at its null too.
        let plain = filtered(&at_null, &measured);
        let exact = column(&drive, &measured, &plain, source);
        // A lag that is as short as a sample changes what each reversal tells, and so the gains there.
        if exact.iter().all(|value| *value == 0.0) || info.id == "speed_sensor_lag" {
            continue;
        }
        // The data are the true drive's: what the law would show is lost where it is in the model.
        // Where the change is small events move by rounding, where it is large it is not linear.
        let differences = [1e-4, 1e-2].map(|share| {
            let step = share * own.nominal.abs();
            let changed = innovations(&filtered(&with(step), &measured));
            let before = innovations(&plain);
            let of = |(before, after): (&f64, &f64)| (before - after) / step;
            off(&exact, &before.iter().zip(&changed).map(of).collect::<Vec<_>>())
        });
        // The gains follow the law a little.
        let off = differences[0].min(differences[1]);
        // A period of this ripple is a few samples at full speed.
        let bar = if info.id == "torque_ripple" { 0.12 } else { 0.08 };
        assert!(off < bar, "{}: {differences:?}", info.id);
        compared += 1;
    }
    assert!(compared >= 11, "{compared} laws");
}

#[test]
fn evidence_is_that_of_a_normal_prior_and_finds_the_coefficient() {
    let drive = tied();
    let truth = {
        let mut truth = drive.clone();
        truth.motor.r = truth.motor.r.map(|r| 1.02 * r);
        truth
    };
    let recording = noisy(bench(&truth, 2.0, 0.001), SDS, 6);
    let measured = Measured::new(&drive, &recording).expect("it can be used");
    let track = filtered(&drive, &measured);
    let names = ["R".to_owned(), "J".to_owned()];
    let source = [Source::Parameters { drive: &drive, names: &names }];
    let references = References { torque: 0.02, voltage: 4.0, shown: [1.0; SENSORS] };
    let direction = direction(&measured);
    let gram =
        gram(&drive, (&measured, &direction), &[&track], &references, (&source, &[]), &[], &|| {
            false
        });
    let products: &Products = &gram[0].products;
    let terms = Terms { columns: vec![0], variances: vec![0.04] };
    // ln N(y; 0, I + v w w') - ln N(y; 0, I), by the matrix determinant lemma.
    let (g, b, v) = (products.of(0, 0), products.of(0, products.data()), 0.04);
    let expected = 0.5 * b * b * v / (1.0 + g * v) - 0.5 * (1.0 + g * v).ln();
    let found = log_evidence(products, &terms);
    assert!((found / expected - 1.0).abs() < 1e-9, "{found} is not {expected}");
    let both = Terms { columns: vec![0, 1], variances: vec![1.0, 1.0] };
    let estimate = coefficients(products, &both).expect("it is told")[0];
    assert!((estimate / (0.02 * 3.13) - 1.0).abs() < 0.25, "{estimate}");
    assert!(standing_out(products, &terms, 1) > 0.1);
    assert!(standing_out(products, &Terms { columns: vec![1], variances: vec![1e9] }, 1) < 1e-3);
    // Shifted by the estimate, as if the coefficient were there.
    let (moved, change) = products.shifted(&[2.0, 0.0]);
    assert!((moved.of(0, moved.data()) - (b + 2.0 * g)).abs() < 1e-6 * g);
    assert!((change + 2.0 * b + 2.0 * g).abs() < 1e-6 * g, "{change}");
}
