use drivescope_plant::drive::Drive;
use drivescope_plant::effects::custom::Law;

use super::compared::Compared;
use super::grammar::{Factor, Form, Magnitude, complexity};
use super::proposals::{Greatest, Kind, names, proposals};
use super::weighed::{Valued, Visited};
use crate::testing::dr300;

const GREATEST: Greatest = Greatest { speed: 400.0, current: 2.5, travel: 30.0 };

fn all(drive: &Drive) -> Vec<Kind> {
    proposals(drive, &GREATEST)
}

#[test]
fn the_text_of_every_formula_is_a_custom_law_with_its_values() {
    let drive = dr300();
    let names = names(&drive, &GREATEST);
    let places = [[120.0, -0.7, 2.3], [-31.0, 1.9, -5.1], [0.0, 0.3, 0.2], [3.0, 0.0, 7.0]];
    for form in all(&drive).iter().filter_map(|kind| kind.last()) {
        let written = form.written(&names);
        let shape = written.shape.iter().copied();
        let coefficients = form.coefficients().iter().zip([1.7, -0.3]).map(|(name, c)| (*name, c));
        let (all, values): (Vec<String>, Vec<f64>) =
            coefficients.chain(shape).map(|(name, value)| (name.to_owned(), value)).unzip();
        let law = Law::parse(form.target, &written.text, &all)
            .unwrap_or_else(|error| panic!("{}: {error}", written.text));
        for [omega, i, theta] in places {
            let columns = form.at([omega, i, theta], &names);
            let expected: f64 = columns.iter().zip([1.7, -0.3]).map(|(it, c)| it * c).sum();
            let found = law.at(&values, [i, omega, theta, 0.0, 0.0]);
            let error = (found - expected).abs();
            assert!(
                error <= 1e-9 * (1.0 + expected.abs()),
                "{}: {found} for {expected}",
                written.text
            );
        }
    }
}

#[test]
fn a_width_far_beyond_the_recordings_is_left_out() {
    let drive = dr300();
    let names = names(&drive, &GREATEST);
    let places = [[120.0, -0.7, 2.3], [-31.0, 1.9, -5.1], [350.0, 0.3, 0.2]];
    let mut simplified = 0;
    for form in all(&drive).iter().filter_map(|kind| kind.last()) {
        assert_eq!(form.fitted(|_| None), (*form, 1.0));
        assert_eq!(form.simpler([GREATEST.speed, GREATEST.current]), None);
        // Widths of either sign are alike to a fit.
        let (far, sign) = form.fitted(|_| Some(-1e5));
        let Some(simpler) = far.simpler([GREATEST.speed, GREATEST.current]) else { continue };
        simplified += 1;
        let texts = [&far, &simpler].map(|it| complexity(&it.written(&names).text));
        assert!(texts[1] < texts[0], "{}", far.written(&names).text);
        let ratios = places.map(|it| {
            let ([at, _], [simple, _]) = (far.at(it, &names), simpler.at(it, &names));
            at / simple
        });
        let same = ratios.iter().all(|it| (it / ratios[0] - 1.0).abs() < 0.01);
        assert!(same, "{}: {ratios:?}", far.written(&names).text);
        let written = form.fitted(|_| Some(-1e5)).0.written(&names);
        assert!(sign == 1.0 || written.shape.iter().all(|(_, value)| *value > 0.0));
    }
    assert!(simplified > 100, "{simplified}");
}

/// Beside all dry friction a friction that begins at rest would do as well; the drive would stick
/// elsewhere.
#[test]
fn what_comes_nearest_to_a_drag_that_decays_vanishes_at_rest_as_it_does() {
    let drive = dr300();
    let run = (0..4000).map(|k| [GREATEST.speed * (0.002 * f64::from(k)).sin(), 0.4, 0.0]);
    let visited = Visited::along(&drive, run.collect(), GREATEST);
    let kinds = visited.proposals(&drive);
    let valued = |kind: usize, coefficient: f64| {
        let form = kinds[kind][0];
        Valued { form, kind, price: 0.0, coefficients: vec![coefficient] }
    };
    let magnitude = |form: &Form| match (form.speed, form.current, form.wave) {
        (Some(Factor { odd: true, magnitude }), None, None) => Some(magnitude),
        _ => None,
    };
    let decays = |kind: &Kind| matches!(magnitude(&kind[0]), Some(Magnitude::LinearDecay { .. }));
    let mut best = valued(kinds.iter().position(decays).expect("it is proposed"), -1e-3);
    best.form = kinds[best.kind][3];
    let all: Vec<Valued> = (0..kinds.len()).map(|kind| valued(kind, 0.0)).collect();
    let others: Vec<&Valued> = all.iter().filter(|it| it.kind != best.kind).collect();
    let near = Compared::of(&visited).nearest(&best, &others, &kinds, 4);
    assert!((2..=4).contains(&near.len()), "{near:?}");
    let of = |it: &Valued, omega: f64| {
        it.coefficients[0] * it.form.at([omega, 0.4, 0.0], &visited.names)[0]
    };
    let at_most = of(&best, 100.0);
    for it in &near[..2] {
        assert!(of(it, 1e-3).abs() < 0.1 * at_most.abs(), "{it:?}");
        assert!((0.5..2.0).contains(&(of(it, 100.0) / at_most)), "{it:?}");
    }
}

#[test]
fn no_formula_is_proposed_twice() {
    let drive = dr300();
    let names = names(&drive, &GREATEST);
    let target = |form: &Form| format!("{:?} {}", form.target, form.written(&names).text);
    let mut texts: Vec<String> = all(&drive).iter().map(|kind| target(&kind[0])).collect();
    let count = texts.len();
    assert!(count > 1000, "{count}");
    texts.sort();
    texts.dedup();
    assert_eq!(texts.len(), count);
}

#[test]
fn what_is_longer_is_more_complex() {
    assert_eq!(complexity("c * omega^3"), 3);
    assert_eq!(complexity("c * omega / sqrt(abs(omega) + 0.1)"), 6);
    assert_eq!(complexity("(c * sin(3 * theta) + d * cos(3 * theta)) * i"), 9);
}
