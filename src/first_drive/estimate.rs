//! The values of a first drive: least squares on the balances, then a fit where that lowers the
//! error and leaves the balances as well explained.

use drivescope_discovery::{
    Begun, Case, Estimate, Evidence, Fit as OfRecording, Identified, Options, Setting, begin,
    evaluate, fit, small_inertia, unexplained, with_own,
};
use drivescope_plant::drive::{Drive, Input};
use drivescope_recording::Recording;

use super::evidence::seen;
use super::loads::{inertia_beside_weight, with_constant_load};
use super::origins::values;
use super::usual::template;
use super::{Choice, FirstDrive, FirstDriveError, Given, Origin, Quality, Value};
use crate::simulation::replay::Fit;

/// Standard error of an inertia over its value, below which a motion tells it.
const KNOWN: f64 = 0.2;
/// A fit may leave at most this many times what least squares leave of a balance unexplained.
const AS_WELL: f64 = 1.05;

/// What the recording says of the drive that was chosen.
pub(super) fn first_drive(
    recording: &Recording,
    mut choice: Choice,
    given: &Given,
) -> miette::Result<FirstDrive> {
    let template = template(&choice, given)?;
    let evidence = seen(&template, recording)?;
    choice.remarks.extend(evidence.recordings[0].remarks.iter().cloned());
    let mut begun = begin(&template, &evidence);
    if let Some(with_load) = with_constant_load(&template, recording, &begun)? {
        begun = with_load;
    }
    let is_told = |begun: &Begun| begun.identified.iter().any(|it| it.name == "J");
    let is_given = given.value("J", choice.input).is_some();
    if !is_told(&begun)
        && !is_given
        && let Some((j, told)) = inertia_beside_weight(&begun.drive, recording, &begun)?
    {
        begun.drive.motor.j = j;
        // Without the weight a fit would move it away.
        begun.drive.fixed.push(told.name.clone());
        begun.identified.push(told);
    }
    let untold = !is_told(&begun) && !is_given;
    let mut by_motion = None;
    if let Some(j) = small_inertia(&begun.drive, &evidence).filter(|_| untold) {
        begun.drive.motor.j = j;
        // Steps that are over within a few samples leave windows of the balance nothing; the motion
        // tells their time all the same.
        let evidence = seen(&begun.drive, recording)?;
        by_motion = refined(&begun.drive, &evidence);
        let told = by_motion.as_ref().and_then(|(_, estimates)| inertia(estimates));
        match told {
            Some(told) => begun.identified.push(told),
            None => {
                // An inertia that nothing tells is kept so small that it hardly matters.
                begun.drive.fixed.push("J".to_owned());
                by_motion = None;
            }
        }
    }
    let evidence = seen(&begun.drive, recording)?;
    let refined = by_motion.or_else(|| refined(&begun.drive, &evidence));
    let drive = refined.as_ref().map_or(&begun.drive, |it| &it.0);
    let values = values(drive, &begun, refined.as_ref().map(|it| it.1.as_slice()), &choice, given);
    let fixed = values.iter().filter(|it| !matches!(it.origin, Origin::Estimated(_)));
    // What only a fit of more, or of other, recordings tells is not held.
    let held =
        |it: &&Value| !matches!(it.origin, Origin::Guessed(_)) || ["K_m", "J"].contains(&it.name);
    let by_voltage = choice.input == Input::Voltage;
    let fixed = fixed.filter(held).map(|it| it.name);
    let fixed = fixed.filter(|name| !(by_voltage && *name == "K_m")).collect();
    let quality = quality(drive, &evidence)?;
    Ok(FirstDrive { recording: recording.name.clone(), choice, values, fixed, quality })
}

/// The inertia, where a fit knows it.
fn inertia(estimates: &[Estimate]) -> Option<Identified> {
    let known = estimates.iter().find(|it| it.name == "J" && it.std_error < KNOWN * it.value)?;
    Some(Identified { name: known.name.clone(), std_error: known.std_error })
}

/// The drive after a fit, with the estimates; none where least squares alone are the better answer.
fn refined(begun: &Drive, evidence: &Evidence) -> Option<(Drive, Vec<Estimate>)> {
    let setting = Setting::of_fit(begun, evidence);
    let before = evaluate(begun, evidence, &setting, true).ok()?;
    let fitted = fit(begun, evidence, &setting, &Options::default()).ok()?;
    let lower = fitted.squares.sum < before.squares.sum;
    let drive = fitted.drive_of(0);
    let pairs = unexplained(begun, evidence).into_iter().zip(unexplained(&drive, evidence));
    let as_well = pairs.into_iter().all(|pair| match pair {
        (Some(before), Some(after)) => after.rms <= AS_WELL * before.rms,
        _ => true,
    });
    let own = fitted.recordings.into_iter().flat_map(|it| it.own);
    let estimates: Vec<Estimate> = fitted.parameters.into_iter().chain(own).collect();
    (lower && as_well).then_some((drive, estimates))
}

/// How well the drive fits its recording.
fn quality(drive: &Drive, evidence: &Evidence) -> miette::Result<Quality> {
    let setting = Setting::of_fit(drive, evidence);
    let measured = &evidence.recordings[0];
    let judged = evaluate(drive, evidence, &setting, false)
        .map_err(|error| FirstDriveError::NoDrive { reason: error.to_string() })?;
    let OfRecording { starts, .. } = &judged.recordings[0];
    let own = with_own(drive, &judged.recordings[0]);
    let case = Case { drive: &own, measured, noise: &evidence.noise[0], starts, setting: &setting };
    let shown = case.trajectory();
    let fits = measured.outputs.iter().map(|channel| {
        let (name, unit) = (channel.name.to_owned(), channel.unit.clone());
        Fit::of(name, unit, &channel.values, &shown[channel.output as usize])
    });
    let fits = fits.collect();
    let unexplained = unexplained(drive, evidence);
    Ok(Quality { fits, observer_hz: setting.observer.hz, unexplained })
}

#[cfg(test)]
mod tests {
    use drivescope_plant::drive::EffectData;
    use drivescope_recording::Quantity;
    use indicatif::ProgressBar;

    use super::*;
    use crate::expression::SignalOverTime;
    use crate::first_drive::Constant;
    use crate::simulation::typed::{Driven, Run};

    const RICH: &str = "12 * sin(2 * t) + 6 * sin(7 * t) + 4 * sign(sin(20 * t))";

    /// A run with the drive's own noise under a rich input, sampled at 1 kHz.
    fn recorded(drive: &Drive, input: &str) -> Recording {
        let u = SignalOverTime::parse("--input", input, Quantity::Voltage).expect("it is a law");
        let run = Run {
            drive: drive.clone(),
            driven: Driven::Input(u.sampled("--input", 1e-3, 8000).expect("it is finite")),
            load: None,
            faults: Vec::new(),
            period_s: 1e-3,
            seed: 3,
        };
        run.simulate(&ProgressBar::hidden()).expect("it runs")
    }

    fn drive(name: &str) -> Drive {
        crate::drive_source::drive(name).expect("it is built in")
    }

    fn of(recording: &Recording, names: &[&str], given: &str) -> FirstDrive {
        let mut some = recording.clone();
        some.signals.retain(|signal| names.contains(&signal.name.as_str()));
        let given = Given::parse(given).expect("right");
        let first = FirstDrive::of(&some, None, &given).expect("it is enough");
        first.file("first.toml").expect("it is a drive");
        first
    }

    fn near(first: &FirstDrive, name: &str, truth: f64, share: f64) {
        let found = first.value(name).expect("the drive has it");
        assert!((found.value / truth - 1.0).abs() < share, "{found:?}, truly {truth}");
        assert!(matches!(found.origin, Origin::Estimated(_)), "{found:?}");
        assert!(found.std_error.is_some_and(|error| error < 0.2 * truth), "{found:?}");
    }

    #[test]
    fn a_voltage_driven_drive_is_found() {
        let truth = drive("dr300");
        let first = of(&recorded(&truth, RICH), &["u", "i", "omega", "theta"], "");
        let motor = &truth.motor;
        near(&first, "R", motor.r.expect("it has one"), 0.02);
        near(&first, "K_e", motor.k_m, 0.02);
        near(&first, "J", motor.j, 0.03);
        near(&first, "coulomb.T_c", 0.016, 0.1);
        near(&first, "L", motor.l.expect("it has one"), 0.2);
        near(&first, "B_m", motor.b_m, 0.5);
        assert!(first.value("constant_load.T_0").is_none(), "there is no load");
        assert_eq!((first.quality.observer_hz, first.quality.fits.len()), (0.0, 2));
        for fit in &first.quality.fits {
            assert!(fit.percent.is_some_and(|percent| percent > 95.0), "{fit:?}");
        }
    }

    #[test]
    fn an_offset_of_the_current_sensor_is_no_load() {
        let truth = drive("dr300");
        let recording = recorded(&truth, RICH);
        let mut shifted = recording.clone();
        let current = shifted.signals.iter_mut().find(|it| it.name == "i").expect("recorded");
        current.values.iter_mut().for_each(|i| *i += 0.3);
        let first = of(&shifted, &["u", "i", "omega"], "");
        assert!(first.value("constant_load.T_0").is_none(), "the armature does not feel it");
        let mut loaded = truth.clone();
        loaded.effects.push(EffectData {
            kind: "constant_load".to_owned(),
            id: "constant_load".to_owned(),
            parameters: vec![("T_0".to_owned(), 0.3 * truth.motor.k_m)],
            law: None,
        });
        let first = of(&recorded(&loaded, RICH), &["u", "i", "omega"], "");
        near(&first, "constant_load.T_0", 0.3 * truth.motor.k_m, 0.1);
    }

    #[test]
    fn one_step_of_the_voltage_tells_the_induced_voltage_before_dry_friction() {
        let recording = recorded(&drive("dr300"), "3 + 3 * sign(t - 1)");
        let first = of(&recording, &["u", "omega"], "");
        let value = |name: &str| first.value(name).expect("it has it");
        assert!(matches!(value("K_e").origin, Origin::Estimated(_)), "{:?}", value("K_e"));
        // Less than a tenth of what drives it: it moves.
        let driving = 6.0 * value("K_m").value / value("R").value;
        assert!(value("coulomb.T_c").value < 0.1 * driving, "{:?}", value("coulomb.T_c"));
        for fit in &first.quality.fits {
            assert!(fit.percent.is_some_and(|percent| percent > 80.0), "{fit:?}");
        }
    }

    #[test]
    fn without_a_current_ratios_are_found() {
        let truth = drive("dr300");
        let motor = &truth.motor;
        let recording = recorded(&truth, RICH);
        let first = of(&recording, &["u", "omega"], "");
        // K takes B_m R / K on board: 5 %.
        near(&first, "K_e", motor.k_m, 0.07);
        let value = |name: &str| first.value(name).expect("it has it").value;
        let ratio = value("J") / value("K_m") * value("R");
        let truth = motor.j / motor.k_m * motor.r.expect("it has one");
        assert!((ratio / truth - 1.0).abs() < 0.03, "{ratio} {truth}");
        let guessed: Vec<_> = first.guesses().iter().map(|(name, _)| *name).collect();
        assert_eq!(guessed, ["R", "L", "B_m"]);
        let known = of(&recording, &["u", "omega"], "R=3.13");
        near(&known, "J", motor.j, 0.1);
        assert!(known.fixed.contains(&"R"), "{:?}", known.fixed);
    }

    #[test]
    fn a_force_driven_axis_is_found_up_to_its_constant() {
        let truth = drive("emps");
        let recording = recorded(&truth, "2 * sin(2 * t) + sign(sin(9 * t))");
        let first = of(&recording, &["u", "x"], "");
        let k_m = truth.motor.k_m;
        assert_eq!(first.guesses().first().map(|(name, _)| *name), Some("K_m"));
        near(&first, "J", truth.motor.j / k_m, 0.02);
        near(&first, "B_m", truth.motor.b_m / k_m, 0.02);
        // The offset of the published drive explains much of what is left.
        let offset = first.value("constant_load.T_0").expect("there is one").value;
        assert!((offset * k_m / -3.1648 - 1.0).abs() < 0.1, "{offset}");
        let known = of(&recording, &["u", "x"], "K_m=35.15065");
        near(&known, "J", truth.motor.j, 0.02);
        assert!(known.guesses().is_empty(), "{:?}", known.guesses());
    }

    #[test]
    fn a_current_or_a_torque_drives_where_no_voltage_was_recorded() {
        let truth = drive("dr300");
        let mut recording = recorded(&truth, RICH);
        let motor = &truth.motor;
        let by_current = of(&recording, &["i", "omega"], "");
        near(&by_current, "J", motor.j / motor.k_m, 0.05);
        assert_eq!(by_current.choice.constant, Constant::Ratio);
        let given = of(&recording, &["i", "omega"], "K_m=0.06");
        near(&given, "coulomb.T_c", 0.016, 0.15);
        let i = recording.signal("i").expect("recorded").clone();
        let values = i.values.iter().map(|i| motor.k_m * i).collect();
        let (name, unit) = ("torque".to_owned(), "N m".to_owned());
        recording.signals.push(drivescope_recording::Signal { name, unit, values });
        let by_torque = of(&recording, &["torque", "omega"], "");
        near(&by_torque, "J", motor.j, 0.05);
        assert!(by_torque.guesses().is_empty(), "{:?}", by_torque.guesses());
    }

    #[test]
    fn a_weight_does_not_hide_the_inertia() {
        let mut truth = drive("dr300");
        let heavy = [("a", 0.02), ("b", 0.3)].map(|(name, torque)| (name.to_owned(), torque));
        truth.effects.push(EffectData {
            kind: "unbalance".to_owned(),
            id: "unbalance".to_owned(),
            parameters: heavy.into(),
            law: None,
        });
        // It swings below its own frequency: the balance without the weight tells no inertia.
        let recording = recorded(&truth, "2 * sin(5 * t) + 2 * sin(31 * t) + sign(sin(20 * t))");
        let first = of(&recording, &["i", "theta"], "");
        near(&first, "J", truth.motor.j / truth.motor.k_m, 0.2);
        assert!(!first.fixed.contains(&"J"), "{:?}", first.fixed);
    }

    #[test]
    fn the_load_alone_shows_a_rigid_drive() {
        let truth = drive("dr300");
        let mut recording = recorded(&truth, RICH);
        let of_load = recording.signals.iter_mut().find(|it| it.name == "theta");
        "theta_load".clone_into(&mut of_load.expect("recorded").name);
        let first = of(&recording, &["u", "i", "theta_load"], "");
        near(&first, "R", truth.motor.r.expect("it has one"), 0.02);
        near(&first, "J", truth.motor.j, 0.05);
        let said = |it: &&String| it.contains("theta_load is taken for theta");
        assert_eq!(first.choice.remarks.iter().filter(said).count(), 1);
    }

    #[test]
    fn a_recording_that_tells_nothing_still_gives_a_drive() {
        let mut recording = recorded(&drive("dr300"), "0");
        for signal in &mut recording.signals {
            signal.values.fill(0.0);
        }
        let found = of(&recording, &["u", "i", "omega"], "");
        assert!(found.guesses().len() >= 5, "{:?}", found.guesses());
    }
}
