//! Every fit ends at the same minimum, from any sensible start: twenty starts drawn over a factor
//! of ten in every parameter, on real recordings and on one of our own.
//!
//! `cargo test --release -p drivescope-discovery --test same_minimum -- --ignored --nocapture`
//! prints the spread of each.

use std::path::PathBuf;

use drivescope_discovery::{
    Evidence, Fitted, Measured, Options, Setting, begin, fit, noise, unexplained,
};
use drivescope_plant::drive::Drive;
use drivescope_recording::{Mapping, ReadOptions, Recording, read};
use rand::SeedableRng;
use rand::distr::{Distribution, Uniform};
use rand_pcg::Pcg64;

#[path = "../src/testing.rs"]
mod testing;

const EMPS: &str = include_str!("../../scenarios/drives/emps.toml");
/// A drive of the torque balance alone, as `init` makes it.
const FORCE: &str = "schema = 1\nname = \"first\"\nmotion = \"rotary\"\n[motor]\ninput = \"force\"\n\
    K_m = 1.0\nJ = 1.0\nB_m = 1.0\n[[effect]]\nkind = \"coulomb\"\nT_c = 1.0\n\
    [fit]\nfixed = [\"K_m\"]\n";
/// Starts that are drawn.
const STARTS: usize = 20;
/// Spread of the error, relative, that is the same minimum.
const SAME: f64 = 1e-3;

fn force(motion: &str) -> Drive {
    Drive::parse(&FORCE.replace("rotary", motion), "first.toml").expect("a right drive file")
}

/// A recording of other people's, resampled; none where the data are not there.
fn measured(file: &str, columns: &str, period_s: Option<f64>) -> Option<Recording> {
    let path = PathBuf::from(std::env::var_os("DRIVESCOPE_DATA")?).join(file);
    let columns = Mapping::parse_list(columns).expect("a right mapping");
    let options = ReadOptions { columns, resample: period_s, ..ReadOptions::default() };
    Some(read(&path, &options).expect("readable").0)
}

fn evidence(drive: &Drive, recordings: &[Recording]) -> Evidence {
    let mut made = Evidence::default();
    for recording in recordings {
        let measured = Measured::new(drive, recording).expect("usable");
        made.noise.push(noise(drive, &measured, &[]).iter().map(|it| it.sd).collect());
        made.recordings.push(measured);
    }
    made
}

fn fitted(drive: &Drive, evidence: &Evidence) -> (Fitted, Setting) {
    let setting = Setting::of_fit(drive, evidence);
    (fit(drive, evidence, &setting, &Options::default()).expect("it converges"), setting)
}

/// Largest and smallest error of fits from starts around what was found, and the name.
fn spread(name: &str, drive: &Drive, recordings: &[Recording]) -> f64 {
    let evidence = evidence(drive, recordings);
    let (found, setting) = fitted(drive, &evidence);
    let mut random = Pcg64::seed_from_u64(7);
    let factor = Uniform::new_inclusive(-1.0, 1.0).expect("a range");
    let errors: Vec<(f64, f64)> = (0..STARTS)
        .map(|_| {
            let mut start = found.drive.clone();
            for it in found.drive.fitted() {
                // What is zero has no size: it is drawn around the library's.
                let size = if it.value == 0.0 { it.nominal } else { it.value };
                let value = size * 10f64.powf(0.5 * factor.sample(&mut random));
                start.set(&it.name, value).expect("possible");
                if it.name == "K_e" && start.motor.tie_k {
                    start.motor.k_m = value;
                }
            }
            let (fitted, setting) = fitted(&start, &evidence);
            (fitted.squares.error(), setting.observer.hz)
        })
        .collect();
    let of = |pick: fn(f64, f64) -> f64, from: f64| errors.iter().map(|it| it.0).fold(from, pick);
    let (least, most) = (of(f64::min, f64::INFINITY), of(f64::max, 0.0));
    let same = errors.iter().filter(|it| it.0 <= least * (1.0 + SAME)).count();
    println!(
        "{name}: found {:.6} at {} Hz; least {least:.6}, most {most:.6}, spread {:.3e}; {same} of \
         {STARTS} at the least",
        found.squares.error(),
        setting.observer.hz,
        most / least - 1.0,
    );
    for it in begin(drive, &evidence).drive.fitted() {
        print!("  {} {:.5e}", it.name, it.value);
    }
    let shares = |drive: &Drive| unexplained(drive, &evidence).map(|it| it.map(|it| it.share));
    println!("  begun {}: {:?}", found.starts_tried, shares(&begin(drive, &evidence).drive));
    for it in &found.parameters {
        print!("  {} {:.5e} +- {:.1e}", it.name, it.value, it.std_error);
    }
    print!("  {:?}", shares(&found.drive));
    println!("  {:?}", found.not_identifiable.iter().map(|it| &it.parameter).collect::<Vec<_>>());
    most / least - 1.0
}

/// A recording of the built-in drive under its own noise.
fn own() -> (Drive, Recording) {
    let drive = testing::dr300();
    let mut recording = testing::bench(&drive, 8.0, 0.001);
    for (number, sd) in [(1, 0.01), (2, 0.3)] {
        let values = &mut recording.signals[number].values;
        let noise = testing::gaussian(values.len(), number as u64);
        values.iter_mut().zip(noise).for_each(|(value, noise)| *value += sd * noise);
    }
    recording.signals.pop();
    (drive, recording)
}

#[test]
fn our_own_recording_has_one_minimum() {
    let (drive, recording) = own();
    assert!(spread("dr300", &drive, &[recording]) < SAME);
}

#[test]
#[ignore = "minutes in release"]
fn real_recordings_have_one_minimum() {
    let mut wrong = Vec::new();
    let emps = Drive::parse(EMPS, "emps.toml").expect("a right drive file");
    let hsm = |name: &str| measured(&format!("hsm150/{name}.csv"), "", None);
    let odrive = |name: &str| {
        measured(&format!("odrive/{name}.csv"), "i=Iq_measured:A,theta=position:rad", Some(0.0025))
    };
    let link = |name: &str| measured(&format!("flexible_link/{name}.csv"), "", None);
    let axis = measured("emps/emps_estimation.csv", "", None);
    if axis.is_none() {
        println!("NOT RUN: DRIVESCOPE_DATA is not set");
        return;
    }
    let cases = [
        ("emps, shipped", emps, vec![axis.clone()]),
        ("emps, init", force("linear"), vec![axis]),
        ("hsm150 both", force("rotary"), vec![hsm("pos_0.06_1"), hsm("neg_0.045_1")]),
        ("hsm150 pos", force("rotary"), vec![hsm("pos_0.065_3")]),
        ("hsm150 neg", force("rotary"), vec![hsm("neg_0.04_3")]),
        ("odrive 0", force("rotary"), vec![odrive("0")]),
        ("odrive 1", force("rotary"), vec![odrive("1")]),
        ("flexible_link ctu 1", force("rotary"), vec![link("ctu_stage1")]),
        ("flexible_link ctu 2", force("rotary"), vec![link("ctu_stage2")]),
    ];
    for (name, drive, recordings) in cases {
        let Some(recordings) = recordings.into_iter().collect::<Option<Vec<_>>>() else { continue };
        if spread(name, &drive, &recordings) >= SAME {
            wrong.push(name);
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}
