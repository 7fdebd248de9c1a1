//! A drive survives its file; the shipped drives hold the values of their sources.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use proptest::collection::vec;
use proptest::option;
use proptest::prelude::*;

use crate::drive::*;
use crate::effects::custom::Target;
use crate::effects::learned::{Factor, Over};
use crate::effects::registry::{Entry, REGISTRY};
use crate::file::BALANCES;
use crate::parameters::{Role, possible};
use crate::testing::{DR300, EMPS};

/// A product of a few rounded numbers: what the file gives in SI against the source's rpm.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

fn read(text: &str) -> Drive {
    Drive::parse(text, "drive.toml").unwrap_or_else(|error| panic!("{error}\n{text}"))
}

#[test]
fn dr300_has_the_values_of_its_source() {
    let drive = read(DR300);
    assert_eq!((drive.name.as_str(), drive.motion), ("AMIRA DR300", Motion::Rotary));
    let expected = MotorData {
        input: Input::Voltage,
        r: Some(3.13),
        l: Some(5e-3),
        k_e: Some(0.0599),
        k_m: 0.06,
        j: 8.2e-5,
        b_m: 6e-5,
        tie_k: true,
        rated_torque: Some(0.096),
    };
    assert_eq!(drive.motor, expected);
    let value = |name: &str| {
        let all = drive.parameters();
        all.iter().find(|parameter| parameter.name == name).expect(name).value
    };
    let rpm = PI / 30.0;
    for (name, expected) in [
        ("coulomb.T_c", 0.016),
        ("stribeck.T_b", 0.008),
        ("stribeck.omega_s", 5.0),
        ("controller.K_p", 0.004 / rpm),
        ("controller.K_i", 0.05 / rpm),
        ("controller.period", 0.005),
        ("controller.limit", 10.0),
        ("amplifier.gain", 2.4),
        ("amplifier.limit", 24.0),
        ("sensors.tacho_quantum", 2.0 * rpm),
        ("sensors.current_quantum", 0.0),
        ("noise.reference", 20.0 * rpm),
        ("noise.omega", 3.0 * rpm),
        ("noise.i", 0.010),
        ("noise.theta", 0.0),
        ("noise.torque", 1e-3),
        ("noise.torque_time", 0.05),
    ] {
        let error = (value(name) - expected).abs();
        assert!(error <= ROUNDING * expected, "{name}: {} against {expected}", value(name));
    }
    assert_eq!(drive.sensors.tacho_unit, TachoUnit::Rpm);
    assert_eq!(drive.generator, None);
    for parameter in drive.parameters() {
        let said = drive.origin.contains_key(&parameter.name);
        assert!(said || parameter.value == 0.0, "{} without its origin", parameter.name);
    }
}

#[test]
fn emps_has_the_published_values() {
    let drive = read(EMPS);
    assert_eq!((drive.motion, drive.motor.input), (Motion::Linear, Input::Force));
    assert_eq!((drive.motor.k_m, drive.motor.j, drive.motor.b_m), (35.15065, 95.1089, 203.5034));
    assert_eq!(drive.effects[0].parameters, [("T_c".to_owned(), 20.3935)]);
    assert_eq!(drive.effects[1].parameters, [("T_0".to_owned(), -3.1648)]);
    assert_eq!(drive.per_recording, ["constant_load.T_0"]);
    assert_eq!((drive.fixed.as_slice(), drive.motor.r), (["K_m".to_owned()].as_slice(), None));
}

/// Cogging on a screw is a spatial period, its harmonics effects with names of their own.
#[test]
fn cogging_has_harmonics_on_a_shaft_and_on_an_axis() {
    for (text, first) in [(DR300, 1.0), (EMPS, 2.0 * PI / 0.0025)] {
        let harmonic = |k: f64| {
            let n = k * first;
            format!(
                "[[effect]]\nkind = \"cogging\"\nid = \"cogging_{k}\"\nN = {n:?}\na = 1e-3\nb = 0\n"
            )
        };
        let drive = read(&format!("{text}\n{}{}", harmonic(1.0), harmonic(48.0)));
        let all = drive.parameters();
        let n = all.iter().find(|p| p.name == "cogging_48.N").expect("the harmonic's own");
        assert_eq!(n.value, 48.0 * first);
        assert_eq!(read(&drive.to_toml()), drive);
        assert_eq!(drive.model().states(), 3);
    }
}

#[test]
fn shipped_drives_survive_writing_and_reading() {
    for text in [DR300, EMPS] {
        let drive = read(text);
        assert_eq!(read(&drive.to_toml()), drive);
    }
}

#[test]
fn only_the_motor_is_needed() {
    let drive = read("[motor]\nR = 1\nL = 1e-3\nK_e = 0.1\nK_m = 0.1\nJ = 1e-4\nB_m = 0\n");
    assert_eq!((drive.motion, drive.motor.input), (Motion::Rotary, Input::Voltage));
    assert_eq!((drive.controller, drive.effects.len()), (None, 0));
}

#[test]
fn a_linear_drive_takes_both_names_of_its_signals() {
    let noisy = |keys: &str| read(&format!("{EMPS}[noise]\n{keys}"));
    assert_eq!(noisy("v = 0.1\nx = 1e-8"), noisy("omega = 0.1\ntheta = 1e-8"));
    let law = |key: &str| {
        let text = format!("[[effect]]\nkind = \"custom\"\n{key} = \"v * 1.01\"\n[fit]");
        read(&EMPS.replace("[fit]", &text)).effects.remove(2).law
    };
    assert_eq!(
        law("v"),
        Some(LawData::Typed { target: Target::Omega, text: "v * 1.01".to_owned() })
    );
    assert_eq!(law("v"), law("omega"));
}

#[test]
fn an_origin_needs_no_quotes() {
    let plain = DR300.replace("\"coulomb.T_c\" =", "coulomb.T_c =");
    assert_ne!(plain, DR300);
    assert_eq!(read(&plain), read(DR300));
}

/// Numbers of every size that a range allows.
fn number((low, high): (f64, f64)) -> BoxedStrategy<f64> {
    prop_oneof![any::<f64>(), -1.0..2.0, Just(low.max(0.0).min(high))]
        .prop_filter("within its range", move |value| possible(*value, (low, high)))
        .boxed()
}

fn positive() -> BoxedStrategy<f64> {
    number((f64::MIN_POSITIVE, f64::INFINITY))
}

fn not_negative() -> BoxedStrategy<f64> {
    number((0.0, f64::INFINITY))
}

fn words() -> BoxedStrategy<String> {
    prop_oneof![any::<String>(), "[a-z \"'\\\\\n\t#=\\[\\]]{0,20}"].boxed()
}

fn motor(input: Input) -> impl Strategy<Value = MotorData> {
    let values = (positive(), positive(), positive(), positive(), positive(), not_negative());
    (values, any::<bool>(), option::of(positive())).prop_map(move |(values, tie, rated_torque)| {
        let (r, l, k_e, k_m, j, b_m) = values;
        let electrical = |value| (input == Input::Voltage).then_some(value);
        let (r, l, k_e) = (electrical(r), electrical(l), electrical(k_e));
        let tie_k = tie && input == Input::Voltage;
        MotorData { input, r, l, k_e, k_m, j, b_m, tie_k, rated_torque }
    })
}

/// An effect of the library or a typed one, under the number's own name.
fn effect(number_of_it: usize, motion: Motion, input: Input) -> BoxedStrategy<EffectData> {
    let id = format!("effect_{number_of_it}");
    let (custom_id, curve_id) = (id.clone(), id.clone());
    let entries: Vec<_> =
        REGISTRY.iter().filter(|entry| entry.info.impossible(motion, input).is_none()).collect();
    let registered = prop::sample::select(entries).prop_flat_map(move |entry| {
        let id = if number_of_it == 0 { entry.info.id.to_owned() } else { id.clone() };
        let values: Vec<_> = entry.parameters.iter().map(|p| number(p.range)).collect();
        values.prop_map(move |values| {
            let names = entry.parameters.iter().map(|parameter| parameter.name.to_owned());
            let kind = entry.info.id.to_owned();
            EffectData { kind, id: id.clone(), parameters: names.zip(values).collect(), law: None }
        })
    });
    let targets: Vec<Target> = Target::ALL
        .iter()
        .map(|(_, target)| *target)
        .filter(|target| {
            input == Input::Voltage || !matches!(target, Target::Voltage | Target::Heat)
        })
        .collect();
    let any_number = number((f64::NEG_INFINITY, f64::INFINITY));
    let typed = (prop::sample::select(targets), vec(any_number, 0..4), "[ \n\t]{0,3}").prop_map(
        move |(target, values, space)| {
            // Not in the order of the alphabet: the order of the file is what counts.
            let names = ["z", "c", "a_1"].map(str::to_owned);
            let parameters: Vec<_> = names.into_iter().zip(values).collect();
            let terms = parameters.iter().map(|(name, _)| format!("{name} *{space}abs(i)"));
            let law = terms.chain(["omega^2".to_owned()]).collect::<Vec<_>>().join(" + ");
            let kind = "custom".to_owned();
            let law = Some(LawData::Typed { target, text: law });
            EffectData { kind, id: custom_id.clone(), parameters, law }
        },
    );
    let curves: Vec<_> = BALANCES
        .into_iter()
        .map(|(_, target)| target)
        .filter(|target| input == Input::Voltage || *target != Target::Voltage)
        .flat_map(|target| Over::ALL.map(|(_, over)| (target, over)))
        .flat_map(|(target, over)| {
            let factors = [None, Some(Factor::Current), Some(Factor::Direction)].into_iter();
            let dry = move |times| times != Some(Factor::Direction) || target == Target::Torque;
            factors.filter(move |times| dry(*times)).map(move |times| (target, over, times))
        })
        .collect();
    let any_number = number((f64::NEG_INFINITY, f64::INFINITY));
    let learned = (prop::sample::select(curves), vec((0.01..0.5, any_number), 2..12)).prop_map(
        move |((target, over, times), all)| {
            let mut knot = -1.0;
            let knots = all.iter().map(|(step, _)| {
                knot += step;
                knot
            });
            let knots = knots.collect();
            let named = |(k, (_, value)): (usize, &(f64, f64))| (LawData::value_name(k), *value);
            let parameters = all.iter().enumerate().map(named).collect();
            let law = Some(LawData::Learned { target, over, times, knots });
            EffectData { kind: "learned".to_owned(), id: curve_id.clone(), parameters, law }
        },
    );
    prop_oneof![registered, typed, learned].boxed()
}

/// What stands around the motor and the effects.
fn surroundings(motion: Motion) -> impl Strategy<Value = Drive> {
    let controller =
        (not_negative(), not_negative(), option::of(positive()), option::of(positive()))
            .prop_map(|(k_p, k_i, period, limit)| ControllerData { k_p, k_i, period, limit });
    let amplifier = (positive(), option::of(positive()))
        .prop_map(|(gain, limit)| AmplifierData { gain, limit });
    let generator = (positive(), positive(), option::of(positive()))
        .prop_map(|(k_m, gain, limit)| GeneratorData { k_m, gain, limit });
    let sensors = (not_negative(), not_negative(), any::<bool>()).prop_map(move |(t, c, rpm)| {
        let rpm = rpm && motion == Motion::Rotary;
        let tacho_unit = if rpm { TachoUnit::Rpm } else { TachoUnit::Si };
        SensorData { tacho_quantum: t, current_quantum: c, tacho_unit }
    });
    let noise = (
        not_negative(),
        not_negative(),
        not_negative(),
        not_negative(),
        not_negative(),
        positive(),
    )
        .prop_map(|(omega, i, theta, reference, torque, torque_time)| NoiseData {
            omega,
            i,
            theta,
            reference,
            torque,
            torque_time,
        });
    let loops = (option::of(controller), option::of(amplifier), option::of(generator));
    (words(), loops, sensors, prop_oneof![Just(NoiseData::default()), noise]).prop_map(
        move |(name, (controller, amplifier, generator), sensors, noise)| Drive {
            name,
            motion,
            controller,
            amplifier,
            generator,
            sensors,
            noise,
            ..read(if motion == Motion::Linear { EMPS } else { DR300 })
        },
    )
}

/// Any drive that a file may describe.
fn drives() -> impl Strategy<Value = Drive> {
    let motion = prop_oneof![Just(Motion::Rotary), Just(Motion::Linear)];
    let input = prop_oneof![Just(Input::Voltage), Just(Input::Force)];
    (motion, input).prop_flat_map(|(motion, input)| {
        let effects = (0..4usize).prop_flat_map(move |count| {
            (0..count).map(|k| effect(k, motion, input)).collect::<Vec<_>>()
        });
        let said = vec((any::<prop::sample::Index>(), words(), 0..4u8), 0..6);
        (surroundings(motion), motor(input), effects, said).prop_map(
            |(drive, motor, effects, said)| {
                let mut drive = Drive { motor, effects: Vec::new(), ..drive };
                for effect in effects {
                    let entry = Entry::find(&effect.kind);
                    if entry.is_none_or(|entry| drive.refuses(entry).is_none()) {
                        drive.effects.push(effect);
                    }
                }
                let all = drive.parameters();
                (drive.fixed, drive.per_recording) = (Vec::new(), Vec::new());
                drive.origin = BTreeMap::new();
                for (index, origin, list) in said {
                    let parameter = index.get(&all);
                    let name = parameter.name.clone();
                    let new = drive.origin.insert(name.clone(), origin).is_none();
                    match (parameter.role, list) {
                        (Role::Physics, 0) if new => drive.fixed.push(name),
                        (Role::Physics, 1) if new => drive.per_recording.push(name),
                        _ => {}
                    }
                }
                drive
            },
        )
    })
}

proptest! {
    #[test]
    fn any_drive_survives_writing_and_reading(drive in drives()) {
        prop_assert_eq!(read(&drive.to_toml()), drive);
    }

    #[test]
    fn no_text_makes_the_reader_panic(
        cut in any::<prop::sample::Index>(),
        put in "[a-zA-Z_0-9.=\"'\\[\\]{}\n #-]{0,12}",
    ) {
        let letters: Vec<char> = DR300.chars().collect();
        let at = cut.index(letters.len());
        let rest = at + (put.len() / 2).min(letters.len() - at);
        let text: String = letters[..at].iter().copied().chain(put.chars()).chain(letters[rest..].iter().copied()).collect();
        if let Err(error) = Drive::parse(&text, "broken.toml") {
            let span = error.place().expect("an error of the content").span.clone();
            prop_assert!(text.get(span).is_some(), "{}", error);
        }
    }
}
