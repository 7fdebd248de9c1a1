//! Sensors beside those of the motor: on the load side, and in the winding.
//!
//! Where an effect has the state that such a sensor tells of (the twist and the slip of a coupling,
//! the temperature of the winding), it is one more output. The load of a drive without a coupling
//! moves as its motor does: there the sensor is compared with the motor's own and not with the
//! model, so that a twist which the model lacks stands in the error and bends no parameter of it.
//! What a position or a temperature is counted from is unknown, and belongs to the start.

use drivescope_numerics::Regression;
use drivescope_plant::drive::{Drive, Input};
use drivescope_plant::effects::info::Beside;
use drivescope_plant::units::{for_motion, name_for_motion};
use drivescope_recording::{Recording, Signal};

use crate::canonical::{position, speed};
use crate::driving::usable;
use crate::measured::{Channel, Measured, Output, Purpose, channel};

/// Motion of the load over the motor's that one shaft may have: a coupling that rings moves the
/// load somewhat more or less, a gear several times.
const OF_ONE_SHAFT: std::ops::Range<f64> = 0.5..2.0;

/// Names and units of [`Beside::ALL`], as of a rotary drive.
const NAMES: [(&str, &str); Beside::ALL.len()] =
    [("omega_load", "rad/s"), ("theta_load", "rad"), ("temperature", "K")];

impl Output {
    /// The sensor beside those of the motor that shows it, if it is one.
    pub(crate) fn beside(self) -> Option<Beside> {
        Beside::ALL.into_iter().find(|sensor| Self::from(*sensor) == self)
    }
}

impl From<Beside> for Output {
    fn from(sensor: Beside) -> Self {
        match sensor {
            Beside::LoadSpeed => Self::LoadSpeed,
            Beside::LoadPosition => Self::LoadPosition,
            Beside::Temperature => Self::Temperature,
        }
    }
}

impl Measured {
    /// Takes what such sensors recorded for outputs, or says why it is set aside.
    pub(crate) fn with_beside(
        mut self,
        drive: &Drive,
        recording: &Recording,
        purpose: Purpose,
    ) -> Self {
        let model = drive.model();
        // A search compares the sensor with a winding that stays as it is, as it compares the
        // load's with a stiff shaft.
        let may_heat = purpose == Purpose::Search && drive.motor.input == Input::Voltage;
        for (sensor, (name, unit)) in Beside::ALL.into_iter().zip(NAMES) {
            let name = name_for_motion(drive.motion, name);
            let Some(shown) = usable(recording, name) else { continue };
            let refused = match sensor {
                Beside::LoadSpeed => unlike(recording, speed(drive).0, shown),
                Beside::LoadPosition => unlike(recording, position(drive).0, shown),
                Beside::Temperature if model.has(sensor) || may_heat => None,
                Beside::Temperature => Some(cold(drive)),
            };
            let unit = match sensor {
                Beside::Temperature => unit.to_owned(),
                _ => for_motion(drive.motion, unit),
            };
            match refused {
                Some(why) => self.remarks.push(format!("{name} is not used: {why}")),
                None => self.outputs.push(channel(sensor.into(), (name, unit), shown)),
            }
        }
        self
    }

    /// What the motor's own sensor shows at sample `k` of what that one would show were there no
    /// coupling; NaN where it was not measured.
    pub(crate) fn of_motor(&self, sensor: Beside, k: usize) -> f64 {
        let of = |output| self.output(output).map_or(f64::NAN, |it: &Channel| it.values[k]);
        match (sensor, &self.angle) {
            (Beside::LoadSpeed, _) => of(Output::Speed),
            (Beside::LoadPosition, Some(angle)) => angle[k],
            (Beside::LoadPosition, None) => of(Output::Position),
            (Beside::Temperature, _) => f64::NAN,
        }
    }
}

/// Why the temperature of a drive without that effect is of no use.
fn cold(drive: &Drive) -> String {
    match drive.motor.input {
        Input::Voltage => "the drive has no winding_heating, which `add` brings in",
        Input::Force => "a drive without a voltage has no winding that heats",
    }
    .to_owned()
}

/// Why the load's motion cannot be compared with that of the motor, of that name.
fn unlike(recording: &Recording, motor: &str, load: &Signal) -> Option<String> {
    let Some(of_motor) = usable(recording, motor) else {
        return Some(format!("the motor's {motor} was not measured beside it"));
    };
    let mut line = Regression::new(2);
    let pairs = of_motor.values.iter().zip(&load.values);
    for (x, y) in pairs.filter(|(x, y)| x.is_finite() && y.is_finite()) {
        line.push([1.0, *x], *y);
    }
    match line.solve().map(|fit| fit.parameters[1]) {
        Ok(ratio) if OF_ONE_SHAFT.contains(&ratio) => None,
        Ok(ratio) => Some(format!(
            "it moves {ratio:.3} times as far as {motor}; multiply it by the gear's ratio"
        )),
        Err(_) => Some(format!("{motor} does not move")),
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::rig::Rig;
    use crate::testing::{bench, dr300, gaussian, noisy};
    use crate::{Direction, Evidence, Observer, Options, Setting, Unwatched, add, discover, fit};

    fn with(extra: &[(&str, &str, Vec<f64>)], effects: &str) -> Measured {
        let mut recording = bench(&dr300(), 1.0, 0.001);
        for (name, unit, values) in extra {
            let (name, unit) = ((*name).to_owned(), (*unit).to_owned());
            recording.signals.push(Signal { name, unit, values: values.clone() });
        }
        let text = format!("{}\n{effects}", include_str!("../../scenarios/drives/dr300.toml"));
        let drive = Drive::parse(&text, "d.toml").expect("a right drive file");
        Measured::new(&drive, &recording).expect("it can be used")
    }

    fn names(measured: &Measured) -> Vec<&'static str> {
        measured.outputs.iter().map(|it| it.name).collect()
    }

    #[test]
    fn a_load_on_the_same_shaft_is_an_output_and_one_behind_a_gear_is_not() {
        let recording = bench(&dr300(), 1.0, 0.001);
        let theta = &recording.signal("theta").expect("it is there").values;
        let omega = &recording.signal("omega").expect("it is there").values;
        let scaled =
            |values: &[f64], factor: f64| values.iter().map(|y| 3.0 + factor * y).collect();
        let both = [
            ("omega_load", "rad/s", scaled(omega, 1.01)),
            ("theta_load", "rad", scaled(theta, 0.99)),
        ];
        let found = with(&both, "");
        assert_eq!(names(&found), ["i", "omega", "omega_load", "theta_load"]);
        assert_eq!(found.remarks, [""; 0]);
        assert_eq!(found.of_motor(Beside::LoadPosition, 70), theta[70]);
        let geared = with(&[("theta_load", "rad", scaled(theta, 0.01))], "");
        assert_eq!(names(&geared), ["i", "omega"]);
        assert!(geared.remarks[0].contains("0.010 times"), "{:?}", geared.remarks);
        let still = with(&[("omega_load", "rad/s", vec![0.0; 1000])], "");
        assert!(still.remarks[0].contains("0.000 times"), "{:?}", still.remarks);
    }

    #[test]
    fn a_temperature_needs_a_winding_that_heats() {
        let warm = [("temperature", "K", vec![293.0; 1000])];
        let aside = with(&warm, "");
        assert!(aside.remarks[0].contains("winding_heating"), "{:?}", aside.remarks);
        assert_eq!(names(&aside), ["i", "omega"]);
        let heating =
            "[[effect]]\nkind = \"winding_heating\"\nalpha = 0.004\nR_th = 5.0\nC_th = 9.0\n";
        assert_eq!(names(&with(&warm, heating)), ["i", "omega", "temperature"]);
    }

    const COUPLING: &str =
        "[[effect]]\nkind = \"flexible_coupling\"\nk = 0.5\nd = 2e-4\nratio = 0.5\n";

    /// A drive with a soft coupling, and its run with the load's position counted from 3 rad.
    pub(crate) fn coupled() -> (Drive, Recording) {
        let text = format!("{}\n{COUPLING}", include_str!("../../scenarios/drives/dr300.toml"));
        let mut drive = Drive::parse(&text, "d.toml").expect("a right drive file");
        // The file's K_m is not its K_e, to which a fit ties it.
        drive.motor.tie_k = false;
        let mut recording = bench(&drive, 2.0, 0.001);
        let (name, unit) = ("theta_load".to_owned(), "rad".to_owned());
        let values = recording.signal("theta").expect("it is there").values.clone();
        recording.signals.push(Signal { name, unit, values });
        let rig = Rig::new(drive.clone(), &recording, &[SDS[0], SDS[1], SDS[2]], 0.0);
        let shown = rig.case().trajectory();
        let noise = gaussian(recording.len(), 5);
        let load = &shown[Output::LoadPosition as usize];
        let of_load = load.iter().zip(noise).map(|(theta, noise)| 3.0 + theta + SDS[2] * noise);
        recording.signals.last_mut().expect("it was added").values = of_load.collect();
        (drive, noisy(recording, [SDS[0], SDS[1]], 11))
    }

    /// Noise of current, speed and the load's position.
    pub(crate) const SDS: [f64; 3] = [0.01, 0.3, 3e-4];
    /// Standard errors that an estimate may be off.
    const OFF: f64 = 4.0;

    #[test]
    fn the_stiffness_follows_from_the_position_of_the_load() {
        let (truth, recording) = coupled();
        let mut far = truth.clone();
        far.set("flexible_coupling.k", 0.8).expect("possible");
        let error = |names: &[&str]| {
            let mut some = recording.clone();
            some.signals.retain(|it| names.contains(&it.name.as_str()));
            let measured = Measured::new(&far, &some).expect("it can be used");
            let noise = vec![SDS[..measured.outputs.len()].to_vec()];
            let evidence = Evidence { recordings: vec![measured], noise };
            let setting = Setting::new(&far, Observer::NONE);
            let fitted = fit(&far, &evidence, &setting, &Options::default()).expect("it fits");
            let estimated = fitted.parameters.iter().find(|it| it.name == "flexible_coupling.k");
            let estimated = estimated.expect("it is told").clone();
            assert!(
                (estimated.value - 0.5).abs() < OFF * estimated.std_error,
                "{names:?}: {estimated:?}"
            );
            if names.len() > 4 {
                let zero = fitted.recordings[0].starts[0].load_zero;
                assert!((zero - 3.0).abs() < OFF * SDS[2], "{zero}");
                assert!(fitted.squares.error() < 1.02, "{}", fitted.squares.error());
            }
            estimated.std_error
        };
        let motor = error(&["u", "i", "omega", "theta"]);
        let both = error(&["u", "i", "omega", "theta", "theta_load"]);
        assert!(both < 0.7 * motor, "{both} with the load, {motor} without it");
    }

    #[test]
    fn a_rigid_drive_is_not_bent_by_the_twist_and_shows_it() {
        let (_, recording) = coupled();
        let rig = Rig::new(dr300(), &recording, &SDS, 0.0);
        let directions = [Direction::Parameter("J"), Direction::Start { piece: 0, state: 4 }];
        let rows = rig.case().sensitivities(&directions);
        let mut squares = 0.0;
        for (row, output) in rows.output.iter().enumerate().filter(|(_, output)| **output == 2) {
            assert_eq!(rows.columns[(0, row)], 0.0);
            assert!((rows.columns[(1, row)] * SDS[2] - 1.0).abs() < 1e-12, "output {output}");
            squares += (rows.residual[row] - 3.0 / SDS[2]).powi(2);
        }
        let error = (squares / recording.len() as f64).sqrt();
        assert!(error > 5.0, "the twist stands out of the noise: {error}");
    }

    #[test]
    fn a_search_sees_that_the_coupling_is_missing() {
        let (truth, recording) = coupled();
        let mut rigid = truth;
        rigid.effects.retain(|it| it.kind != "flexible_coupling");
        let measured = Measured::new(&rigid, &recording).expect("it can be used");
        // Both begin at rest.
        let [estimation, validation] = [0..2000, 0..1300].map(|range| Evidence {
            recordings: vec![measured.part(range).expect("long enough")],
            noise: vec![SDS.to_vec()],
        });
        let found = discover(&rigid, &estimation, &validation, &Unwatched).expect("it can be run");
        assert_eq!(found.named, ["flexible_coupling"]);
        let [base, with] = &found.ladder[..] else { panic!("{:?}", found.ladder) };
        assert!(base.error > 100.0, "a twist that the model lacks is plain: {base:?}");
        assert!(with.error < 1.5 && with.validation_error < 1.5, "{with:?}");
    }

    /// Noise of current, speed and temperature.
    const WARM_SDS: [f64; 3] = [0.01, 0.3, 0.1];
    const HEATING: &str =
        "[[effect]]\nkind = \"winding_heating\"\nalpha = 0.004\nR_th = 12.0\nC_th = 0.4\n";

    /// A drive whose winding heats by tens of kelvin, and its run with the winding's temperature.
    pub(crate) fn heating(duration_s: f64) -> (Drive, Recording) {
        let text = format!("{}\n{HEATING}", include_str!("../../scenarios/drives/dr300.toml"));
        let mut drive = Drive::parse(&text, "d.toml").expect("a right drive file");
        drive.motor.tie_k = false;
        let mut recording = bench(&drive, duration_s, 0.001);
        let (name, unit) = ("temperature".to_owned(), "K".to_owned());
        recording.signals.push(Signal { name, unit, values: vec![0.0; recording.len()] });
        let rig = Rig::new(drive.clone(), &recording, &WARM_SDS, 0.0);
        let shown = rig.case().trajectory();
        let noise = gaussian(recording.len(), 6);
        let above = shown[Output::Temperature as usize].iter().zip(noise);
        let values = above.map(|(t, noise)| 293.0 + t + WARM_SDS[2] * noise).collect();
        recording.signals.last_mut().expect("it was added").values = values;
        (drive, noisy(recording, [WARM_SDS[0], WARM_SDS[1]], 12))
    }

    #[test]
    fn a_search_takes_the_temperature_of_a_drive_that_lacks_the_heating() {
        let (truth, recording) = heating(6.0);
        let mut cold = truth;
        cold.effects.retain(|it| it.kind != "winding_heating");
        let measured = Measured::of(&cold, &recording, Purpose::Search).expect("it can be used");
        assert_eq!(names(&measured), ["i", "omega", "temperature"]);
        let part = |range| Evidence {
            recordings: vec![measured.part(range).expect("long enough")],
            noise: vec![WARM_SDS.to_vec()],
        };
        let (estimation, validation) = (part(0..4000), part(4000..6000));
        let added = add(&cold, "winding_heating", &estimation, &validation, &Unwatched);
        let [base, with] = &added.expect("it can be run").ladder[..] else { panic!("two steps") };
        assert!(base.error > 20.0, "the winding warms: {base:?}");
        // The validation begins warm.
        assert!(with.error < 1.1 && with.validation_error < 1.1, "{with:?}");
        let found = discover(&cold, &estimation, &validation, &Unwatched).expect("it can be run");
        assert_eq!(found.named, ["winding_heating"], "{:?}", found.ranking);
    }
}
