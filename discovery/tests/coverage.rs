//! 95 % intervals hold the truth in 93 to 97 % of simulated fits.

#[path = "../src/testing.rs"]
mod testing;

use drivescope_discovery::{Evidence, Measured, Observer, Options, Setting, fit};
use drivescope_plant::drive::{Drive, NoiseData};
use testing::{bench, dr300, loaded, noisy, random_load};

const PERIOD_S: f64 = 0.001;
const SD: [f64; 2] = [0.01, 0.3];

fn truth() -> Drive {
    let mut drive = dr300();
    drive.motor.k_m = 0.0599;
    drive.noise = NoiseData::default();
    drive
}

/// Share of the intervals value +- 1.96 standard errors that hold the truth, over all parameters
/// of that many fits to recordings with measurement noise and, if given, a random load (standard
/// deviation N m, memory s); and the least share of one parameter.
fn covered(fits: u64, duration_s: f64, load: Option<(f64, f64)>) -> (f64, f64) {
    let truth = truth();
    let clean = bench(&truth, duration_s, PERIOD_S);
    let u = clean.signals[0].values.clone();
    let mut held = vec![0u64; truth.fitted().len()];
    for seed in 0..fits {
        let clean = match load {
            None => clean.clone(),
            Some(load) => {
                let load = random_load(u.len(), PERIOD_S, load, 77 + seed);
                loaded(&truth, u.clone(), &load, PERIOD_S)
            }
        };
        let measured = Measured::new(&truth, &noisy(clean, SD, 1000 + seed)).expect("usable");
        let evidence = Evidence { recordings: vec![measured], noise: vec![SD.to_vec()] };
        let setting = Setting::new(&truth, Observer::NONE);
        let options = Options { starts: 1, ..Options::default() };
        let fitted = fit(&truth, &evidence, &setting, &options).expect("it converges");
        for (k, (estimate, parameter)) in fitted.parameters.iter().zip(truth.fitted()).enumerate() {
            let off = (estimate.value - parameter.value).abs();
            held[k] += u64::from(off <= 1.96 * estimate.std_error);
        }
    }
    let share = |held: &u64| *held as f64 / fits as f64;
    println!("{:?}", held.iter().map(share).collect::<Vec<_>>());
    let least = held.iter().map(share).fold(1.0, f64::min);
    (held.iter().map(share).sum::<f64>() / held.len() as f64, least)
}

/// The short form: 60 fits of 8 parameters know a share of 0.95 to about 0.015.
#[test]
fn intervals_cover_in_a_few_fits() {
    let (covered, least) = covered(60, 2.0, None);
    assert!((0.91..=0.99).contains(&covered), "{covered}");
    assert!(least > 0.85, "{least}");
}

/// The figure: 93 to 97 % over 500 fits.
#[test]
#[ignore = "half a minute: run it with --ignored"]
fn intervals_cover_93_to_97_per_cent() {
    let (covered, least) = covered(500, 2.0, None);
    assert!((0.93..=0.97).contains(&covered), "{covered}");
    // One parameter's share of 500 is known to 0.01; the block errors add a little on the safe side.
    assert!(least > 0.92, "{least}");
}

/// Under a random load of 6 % of the dry friction, with a memory of 50 ms, the blocks see most of
/// what colours the residual: about 90 % for the parameters that act at speed. T_b and omega_s,
/// which the load shifts itself, fall short (70 to 80 %), hence the average.
#[test]
#[ignore = "half a minute: run it with --ignored"]
fn a_random_load_costs_some_coverage() {
    let (covered, least) = covered(100, 8.0, Some((1e-3, 0.05)));
    assert!((0.82..=0.97).contains(&covered), "{covered}");
    assert!(least > 0.6, "{least}");
}
