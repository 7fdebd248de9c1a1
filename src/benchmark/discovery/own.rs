//! Cases that the plant simulates itself: random machines, random bench runs, noise added.

use drivescope_plant::drive::{Drive, EffectData};
use drivescope_plant::effects::registry::Entry;
use drivescope_plant::unit::Unit;
use drivescope_recording::{Recording, Signal};
use rand::RngExt as _;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

use super::{Case, Group};

const SAMPLES: usize = 8000;
const PERIOD_S: f64 = 1e-3;
/// Noise of speed and current, share of their largest values: the generators' "medium".
const NOISE: [f64; 2] = [0.003, 0.005];
/// Groups and their shares of the cases.
const SHARES: [(Group, f64); 5] = [
    (Group::Hidden, 0.30),
    (Group::HiddenLoaded, 0.15),
    (Group::Null, 0.20),
    (Group::NullLoaded, 0.20),
    (Group::Pair, 0.15),
];

/// A machine: volts, amps, R, L, K, J, B, T_c.
const MACHINES: [[f64; 8]; 3] = [
    [24.0, 2.0, 3.13, 5e-3, 0.06, 8.2e-5, 6e-5, 0.016],
    [12.0, 1.4, 2.2, 2.5e-3, 0.022, 1.1e-5, 3e-6, 2.8e-3],
    [48.0, 5.0, 0.9, 2.5e-3, 0.115, 4e-4, 2e-4, 0.032],
];
/// Standard deviation of the logarithm of a machine's parameter.
const SPREAD: f64 = 0.2;

/// What can be hidden: the kind, and its coefficients for a machine.
type Hide = (&'static str, fn(&Machine, &mut Pcg64) -> Vec<(&'static str, f64)>);

const HIDDEN: [Hide; 15] = [
    ("constant_load", |m, r| vec![("T_0", sign(r) * 0.05 * m.torque())]),
    ("asymmetric_friction", |m, r| {
        let side = sign(r);
        vec![("dT_c", side * 0.3 * m.t_c), ("dB_m", side * 0.15 * m.t_c / (0.5 * m.top()))]
    }),
    ("stribeck", |m, r| {
        vec![("T_b", 0.5 * m.t_c), ("omega_s", r.random_range(0.02..0.05) * m.top())]
    }),
    ("quadratic_drag", |m, _| vec![("c", 0.15 * m.torque() / (0.5 * m.top()).powi(2))]),
    ("load_friction", |_, r| vec![("c", r.random_range(0.1..0.15))]),
    ("friction_drift", |m, r| {
        vec![("T_d", sign(r) * 0.4 * m.t_c), ("B_d", 0.0), ("tau", r.random_range(4.0..8.0))]
    }),
    ("cogging", |m, r| {
        let (a, b) = turned(r, 0.08 * m.torque());
        vec![("N", [2.0, 3.0, 4.0, 6.0, 8.0, 12.0][r.random_range(0..6)]), ("a", a), ("b", b)]
    }),
    ("unbalance", |m, r| {
        let (a, b) = turned(r, 0.08 * m.torque());
        vec![("a", a), ("b", b)]
    }),
    ("torque_ripple", |_, r| {
        let (a, b) = turned(r, 0.05);
        vec![("N", [2.0, 3.0, 4.0, 6.0, 8.0][r.random_range(0..5)]), ("a", a), ("b", b)]
    }),
    ("saturation", |m, _| vec![("c", 0.15 / (0.2 * m.volts / m.r).powi(2))]),
    ("brush_drop", |m, r| {
        vec![("V_b", 0.03 * m.volts), ("i_b", r.random_range(0.05..0.15) * m.amps)]
    }),
    ("winding_heating", |m, r| {
        let heat = m.r * (0.15 * m.volts / m.r).powi(2) * 8.0;
        let (rise, slow) = (0.4 / 0.0039, r.random_range(6.0..12.0));
        vec![("alpha", 0.0039), ("C_th", heat / rise), ("R_th", slow * rise / heat)]
    }),
    ("speed_sensor_lag", |_, r| vec![("tau", r.random_range(0.006..0.012))]),
    ("tacho_eccentricity", |_, r| {
        let (a, b) = turned(r, 0.02);
        vec![("a", a), ("b", b)]
    }),
    ("current_offset", |m, r| vec![("i_0", sign(r) * 0.08 * m.amps)]),
];

/// Pairs that differ in what they fail over.
const PAIRS: [[&str; 2]; 6] = [
    ["cogging", "quadratic_drag"],
    ["constant_load", "torque_ripple"],
    ["saturation", "unbalance"],
    ["brush_drop", "cogging"],
    ["asymmetric_friction", "speed_sensor_lag"],
    ["load_friction", "current_offset"],
];

struct Machine {
    volts: f64,
    amps: f64,
    r: f64,
    l: f64,
    k: f64,
    j: f64,
    b: f64,
    t_c: f64,
}

impl Machine {
    fn draw(random: &mut Pcg64) -> Self {
        let middle = MACHINES[random.random_range(0..MACHINES.len())];
        let mut spread = || {
            let draw: f64 = StandardNormal.sample(random);
            (SPREAD * draw.clamp(-2.0, 2.0)).exp()
        };
        let [volts, amps, r, l, k, j, b, t_c] = middle;
        let [r, l, k] = [r * spread(), l * spread(), k * spread()];
        Self { volts, amps, r, l, k, j: j * spread(), b: b * spread(), t_c: t_c * spread() }
    }

    fn torque(&self) -> f64 {
        self.k * self.amps
    }

    /// Speed without load at the supply voltage, rad/s.
    fn top(&self) -> f64 {
        self.volts / self.k
    }

    /// Its drive file, every parameter times a factor.
    fn drive(&self, mut off: impl FnMut() -> f64) -> Drive {
        let k = self.k * off();
        let text = format!(
            "schema = 1\nname = \"random machine\"\nmotion = \"rotary\"\n[motor]\ninput = \
             \"voltage\"\nR = {:?}\nL = {:?}\nK_e = {k:?}\nK_m = {k:?}\nJ = {:?}\nB_m = \
             {:?}\ntie_K = true\n[[effect]]\nkind = \"coulomb\"\nT_c = {:?}\n",
            self.r * off(),
            self.l * off(),
            self.j * off(),
            self.b * off(),
            self.t_c * off()
        );
        Drive::parse(&text, "random machine").expect("the text is a drive file")
    }
}

fn sign(random: &mut Pcg64) -> f64 {
    if random.random_bool(0.5) { 1.0 } else { -1.0 }
}

/// An amplitude in a random phase.
fn turned(random: &mut Pcg64, amplitude: f64) -> (f64, f64) {
    let (sin, cos) = random.random_range(0.0..std::f64::consts::TAU).sin_cos();
    (amplitude * cos, amplitude * sin)
}

/// About that many cases; the same seed gives the same.
pub(super) fn cases(count: usize, seed: u64) -> Vec<Case> {
    let mut groups: Vec<(Group, usize)> = Vec::new();
    for (group, share) in SHARES {
        let some = (share * count as f64).round() as usize;
        groups.extend((0..some).map(|number| (group, number)));
    }
    let of = |(stream, (group, number)): (usize, (Group, usize))| {
        case(group, number, &mut Pcg64::new(u128::from(seed), stream as u128))
    };
    groups.into_iter().enumerate().map(of).collect()
}

fn case(group: Group, number: usize, random: &mut Pcg64) -> Case {
    let machine = Machine::draw(random);
    let hidden: Vec<&str> = match group {
        Group::Hidden | Group::HiddenLoaded => vec![HIDDEN[number % HIDDEN.len()].0],
        Group::Pair => PAIRS[number % PAIRS.len()].to_vec(),
        _ => vec![],
    };
    let mut truth = machine.drive(|| 1.0);
    for (kind, draw) in HIDDEN.iter().filter(|(kind, _)| hidden.contains(kind)) {
        let values = draw(&machine, random);
        let entry = Entry::find(kind).expect("the library has it");
        let value = |name: &str, nominal| {
            values.iter().find(|(other, _)| *other == name).map_or(nominal, |(_, value)| *value)
        };
        let parameters = entry
            .parameters
            .iter()
            .map(|it| (it.name.to_owned(), value(it.name, it.nominal)))
            .collect();
        let (kind, id) = ((*kind).to_owned(), (*kind).to_owned());
        truth.effects.push(EffectData { kind, id, parameters, law: None });
    }
    let loaded = matches!(group, Group::HiddenLoaded | Group::NullLoaded);
    let load = loaded.then(|| {
        let sd = random.random_range(0.01..0.03) * machine.torque();
        (sd, random.random_range(0.02..0.2))
    });
    let [estimation, validation] =
        ["estimation", "validation"].map(|name| record(name, &truth, machine.volts, load, random));
    let off: Vec<f64> =
        (0..6).map(|_| 1.0 + sign(random) * random.random_range(0.1..0.2)).collect();
    let mut off = off.into_iter();
    let drive = machine.drive(|| off.next().unwrap_or(1.0));
    let hidden = hidden.into_iter().map(str::to_owned).collect();
    Case { group, foreign: false, hidden, drive, estimation, validation }
}

/// A bench run: slow passages through zero, steps, a multisine, in random order.
fn voltage(volts: f64, random: &mut Pcg64) -> Vec<f64> {
    let quarter = SAMPLES / 4;
    let mut parts: Vec<Vec<f64>> = Vec::new();
    for _ in 0..2 {
        let (height, turns) = (random.random_range(0.25..0.45), random.random_range(0.8..1.6));
        let phase = random.random_range(0.0..1.0);
        let wave = |k: usize| {
            let x = (turns * k as f64 / quarter as f64 + phase).rem_euclid(1.0);
            height * (4.0 * (x - 0.5_f64).abs() - 1.0)
        };
        parts.push((0..quarter).map(wave).collect());
    }
    let mut steps = Vec::new();
    let mut side = sign(random);
    while steps.len() < quarter {
        let level = side * random.random_range(0.15..0.6);
        let dwell = random.random_range(150..400);
        steps.extend(std::iter::repeat_n(level, dwell));
        side = -side;
    }
    steps.truncate(quarter);
    parts.push(steps);
    let tones: Vec<(f64, f64)> = (0..10)
        .map(|k| {
            let hz = 0.7 * (40.0_f64 / 0.7).powf(f64::from(k) / 9.0);
            (hz, random.random_range(0.0..std::f64::consts::TAU))
        })
        .collect();
    let height = random.random_range(0.06..0.1);
    let sines = |k: usize| {
        let t = k as f64 * PERIOD_S;
        let of = |(hz, phase): &(f64, f64)| (std::f64::consts::TAU * hz * t + phase).sin();
        height * tones.iter().map(of).sum::<f64>()
    };
    parts.push((0..quarter).map(sines).collect());
    for k in (1..parts.len()).rev() {
        parts.swap(k, random.random_range(0..=k));
    }
    parts.concat().into_iter().map(|share| share.clamp(-1.0, 1.0) * volts).collect()
}

fn record(
    name: &str,
    truth: &Drive,
    volts: f64,
    load: Option<(f64, f64)>,
    random: &mut Pcg64,
) -> Recording {
    let u = voltage(volts, random);
    let mut unit = Unit::new(truth.clone(), true);
    let place = |name: &str| unit.reference(name).expect("a unit has it");
    let (at_u, at_load, shown) = (place("u"), place("T_l"), ["i", "omega"].map(place));
    let mut columns: [Vec<f64>; 2] = Default::default();
    let mut torque = 0.0;
    unit.initialize(0.0);
    for (k, u) in u.iter().enumerate() {
        if let Some((sd, time)) = load {
            let keep = (-PERIOD_S / time).exp();
            let draw: f64 = StandardNormal.sample(random);
            torque = keep * torque + sd * (1.0 - keep * keep).sqrt() * draw;
        }
        unit.set_time(k as f64 * PERIOD_S);
        unit.set(at_u, *u).expect("finite");
        unit.set(at_load, torque).expect("finite");
        for (column, place) in columns.iter_mut().zip(shown) {
            column.push(unit.get(place).expect("finite"));
        }
        unit.step(PERIOD_S).expect("finite");
    }
    let [mut i, mut omega] = columns;
    for (signal, share) in [(&mut omega, NOISE[0]), (&mut i, NOISE[1])] {
        let sd = share * signal.iter().fold(0.0_f64, |most, y| most.max(y.abs()));
        for value in signal.iter_mut() {
            let draw: f64 = StandardNormal.sample(random);
            *value += sd * draw;
        }
    }
    let signal = |name: &str, unit: &str, values| Signal {
        name: name.to_owned(),
        unit: unit.to_owned(),
        values,
    };
    let signals = vec![signal("u", "V", u), signal("i", "A", i), signal("omega", "rad/s", omega)];
    Recording { name: name.to_owned(), start_s: 0.0, period_s: PERIOD_S, signals }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_seed_gives_the_same_cases_and_the_shares_are_all_there_is() {
        let sum: f64 = SHARES.iter().map(|share| share.1).sum();
        assert!((sum - 1.0).abs() < 1e-9, "{sum}");
        let [a, b, c] = [3, 3, 4].map(|seed| cases(4, seed));
        assert_eq!(a[0].estimation, b[0].estimation);
        assert_ne!(a[0].estimation, c[0].estimation);
        assert_ne!(a[0].estimation, a[0].validation);
    }

    #[test]
    fn every_pair_is_of_what_can_be_hidden() {
        for kind in PAIRS.iter().flatten() {
            assert!(HIDDEN.iter().any(|(other, _)| other == kind), "{kind}");
        }
    }
}
