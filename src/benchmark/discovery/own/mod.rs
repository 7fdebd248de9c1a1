//! Cases that the plant simulates itself: random machines, random bench runs, noise added.

mod bench_run;
mod form;
mod hidden;
mod machine;
mod unprogrammed;

use drivescope_plant::drive::{Drive, EffectData};
use drivescope_plant::effects::registry::Entry;
use rand::RngExt as _;
use rand_pcg::Pcg64;

use self::bench_run::{Load, record};
use self::hidden::{HIDDEN, PAIRS, sign};
use self::machine::Machine;
use super::{Case, Grade, Group};

pub(super) use self::form::{Distance, HiddenLaw};
use self::unprogrammed::LAWS;

/// Groups and their shares of the cases.
const SHARES: [(Group, f64); 6] = [
    (Group::Hidden, 0.24),
    (Group::HiddenLoaded, 0.14),
    (Group::Null, 0.18),
    (Group::NullLoaded, 0.18),
    (Group::Pair, 0.14),
    (Group::Graded, 0.12),
];

/// About that many cases; the same seed gives the same.
pub(super) fn cases(count: usize, seed: u64) -> Vec<Case> {
    let mut plans: Vec<(Group, Grade, usize)> = Vec::new();
    for (group, share) in SHARES {
        let usual = [Grade::USUAL];
        let grades = if group == Group::Graded { Grade::OTHERS.as_slice() } else { &usual };
        let some = (share * count as f64).round() as usize;
        plans.extend(
            (0..some).map(|number| (group, grades[number % grades.len()], number / grades.len())),
        );
    }
    let of = |(stream, (group, grade, number)): (usize, (Group, Grade, usize))| {
        case(group, grade, number, &mut Pcg64::new(u128::from(seed), stream as u128))
    };
    plans.into_iter().enumerate().map(of).collect()
}

/// So many cases of laws that nobody programmed, one after the other, every second one under a random
/// load; the same seed gives the same.
pub(super) fn unprogrammed(count: usize, seed: u64) -> Vec<Case> {
    let of = |number: usize| {
        let random = &mut Pcg64::new(u128::from(seed), (UNPROGRAMMED + number) as u128);
        let machine = Machine::draw(random);
        let effect = unprogrammed::effect(&LAWS[number % LAWS.len()], &machine, random);
        let (mut truth, name) = (machine.drive(|| 1.0), effect.id.clone());
        truth.effects.push(effect.clone());
        let loaded = !(number / LAWS.len() + number).is_multiple_of(2);
        let law = Some(HiddenLaw { truth: truth.clone(), effect });
        Case {
            law,
            ..recorded(
                Group::Unprogrammed,
                Grade::USUAL,
                (vec![name], truth),
                loaded,
                &machine,
                random,
            )
        }
    };
    (0..count).map(of).collect()
}

/// First stream of random numbers of those cases.
const UNPROGRAMMED: usize = 1 << 32;

fn case(group: Group, grade: Grade, number: usize, random: &mut Pcg64) -> Case {
    let machine = Machine::draw(random);
    let hidden: Vec<&str> = match group {
        Group::Hidden | Group::HiddenLoaded | Group::Graded => {
            vec![HIDDEN[number % HIDDEN.len()].0]
        }
        Group::Pair => PAIRS[number % PAIRS.len()].to_vec(),
        Group::Null
        | Group::NullLoaded
        | Group::NullZeroSpeed
        | Group::Outside
        | Group::Unprogrammed => vec![],
    };
    let mut truth = machine.drive(|| 1.0);
    for (kind, draw) in HIDDEN.iter().filter(|(kind, _)| hidden.contains(kind)) {
        truth.effects.push(effect(kind, &draw(&machine, random), grade.size));
    }
    let loaded = matches!(group, Group::HiddenLoaded | Group::NullLoaded);
    let hidden = hidden.into_iter().map(str::to_owned).collect();
    recorded(group, grade, (hidden, truth), loaded, &machine, random)
}

/// A machine with what is hidden in it, recorded, and the drive file of one that is a little off.
fn recorded(
    group: Group,
    grade: Grade,
    (hidden, truth): (Vec<String>, Drive),
    loaded: bool,
    machine: &Machine,
    random: &mut Pcg64,
) -> Case {
    let load = loaded.then(|| Load {
        sd: random.random_range(0.01..0.03) * machine.torque(),
        time: random.random_range(0.02..0.2),
    });
    let [estimation, validation] = ["estimation", "validation"]
        .map(|name| record(name, &truth, machine.volts, load.as_ref(), grade.noise, random));
    let off: Vec<f64> =
        (0..6).map(|_| 1.0 + sign(random) * random.random_range(0.1..0.2)).collect();
    let mut off = off.into_iter();
    let drive = machine.drive(|| off.next().unwrap_or(1.0));
    Case { group, foreign: false, grade, hidden, law: None, drive, estimation, validation }
}

/// An effect of the library with these values, its coefficients times the size: what is zero
/// where the effect is not there.
fn effect(kind: &str, values: &[(&str, f64)], size: f64) -> EffectData {
    let entry = Entry::find(kind).expect("the library has it");
    let of = |name: &str, nominal: f64| {
        let given = values.iter().find(|(other, _)| *other == name);
        let scales = entry.info.nulls.contains(&(name, 0.0));
        given.map_or(nominal, |(_, value)| *value) * if scales { size } else { 1.0 }
    };
    let parameters =
        entry.parameters.iter().map(|it| (it.name.to_owned(), of(it.name, it.nominal))).collect();
    EffectData { kind: kind.to_owned(), id: kind.to_owned(), parameters, law: None }
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
