//! Foreign names taken for signals that the program knows.

mod meant;
mod whole;

use drivescope_units::Quantity::{Angle, AngularSpeed, Length, Speed};
use meant::targets;
use whole::WHOLE;

use crate::canonical::{Canonical, exact};
use crate::words::{meaning, words};

/// What a foreign name is likely to be, and how near to a measurement of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Guess {
    pub(crate) canonical: &'static Canonical,
    pub(crate) rank: Rank,
}

/// Of two columns for one signal the lower rank wins.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Rank {
    /// It says that it was measured.
    Measured,
    /// It says nothing of the kind.
    Plain,
    /// What a controller asked for.
    Commanded,
    Filtered,
    Estimated,
}

/// The canonical signal that a foreign name in that unit is likely to be; `rotary` decides
/// between turning and straight motion where neither name nor unit does.
pub(crate) fn guess(name: &str, unit: Option<&str>, rotary: Option<bool>) -> Option<Guess> {
    let chosen = |targets: &[&str], rank: Rank| {
        let mut fit: Vec<&'static Canonical> = targets
            .iter()
            .filter_map(|target| exact(target))
            .filter(|canonical| unit.is_none_or(|unit| canonical.accepts(unit)))
            .collect();
        if let Some(rotary) = rotary.filter(|_| unit.is_none()) {
            fit.sort_by_key(|canonical| turns(canonical).is_some_and(|it| it != rotary));
        }
        fit.first().map(|canonical| Guess { canonical, rank })
    };
    match name {
        // A capital alone is a tachometer only by its unit; a torque or temperature as well.
        "T" => return unit.and_then(|_| chosen(&["temperature", "torque"], Rank::Plain)),
        "M" => return chosen(&["torque"], Rank::Plain),
        _ => {}
    }
    let joined = words(name).concat();
    if joined.len() == 2 && joined.ends_with('2') {
        return None;
    }
    if let Some(row) = WHOLE.iter().find(|row| row.0.contains(&joined.as_str())) {
        return chosen(row.1, Rank::Plain);
    }
    // `knee:motor_velocity` and `axis0.encoder.pos`: where it stands, then what it is.
    let last = name.rsplit([':', '.']).next().filter(|last| *last != name);
    let meaning = [Some(name), last].into_iter().flatten().find_map(meaning)?;
    let (targets, rank) = targets(&meaning)?;
    chosen(targets, rank)
}

/// Whether a signal belongs to a turning motion; `None` for what both have.
fn turns(canonical: &Canonical) -> Option<bool> {
    match canonical.quantities {
        [Angle] | [AngularSpeed] => Some(true),
        [Length] | [Speed] => Some(false),
        _ => None,
    }
}

/// The unit that a foreign name is itself (`rpm`, `n_ist`), if it is one.
pub(crate) fn unit_in_name(name: &str) -> Option<&'static str> {
    let turns = ["rpm", "n", "drehzahl", "upm", "giri"];
    let said = |word: &String| turns.contains(&word.as_str()) || word.ends_with("drehzahl");
    words(name).iter().any(said).then_some("rpm")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stated(name: &str, unit: Option<&str>) -> Option<&'static str> {
        guess(name, unit, None).map(|guess| guess.canonical.name)
    }

    #[test]
    fn the_unit_tells_what_a_word_means() {
        assert_eq!(stated("Speed", None), Some("omega"));
        assert_eq!(stated("Speed", Some("mm/s")), Some("v"));
        assert_eq!(stated("position", Some("deg")), Some("theta"));
        assert_eq!(stated("Position", None), Some("x"));
        assert_eq!(stated("V", None), Some("u"));
        assert_eq!(stated("T", Some("degC")), Some("temperature"));
        assert_eq!(stated("T", Some("Nm")), Some("torque"));
        assert_eq!(stated("T", None), None);
        assert_eq!(stated("t", None), Some("time"));
        assert_eq!(stated("Speed", Some("V")), None);
        assert_eq!(stated("vibration", None), None);
        let rotary = guess("velocity", None, Some(true)).unwrap();
        assert_eq!(rotary.canonical.name, "omega");
    }

    #[test]
    fn five_languages_are_read() {
        for (signal, names) in [
            (
                "u",
                "Spannung Ankerspannung Motorspannung tension tensión tensione Voltage motor_voltage u_cmd voltage_command Uq u_a",
            ),
            (
                "i",
                "Strom Ankerstrom courant corriente corrente current Iq_measured iq q_current i_meas motorCurrent Iststrom i_a current_filt",
            ),
            (
                "omega",
                "Drehzahl Geschwindigkeit Winkelgeschwindigkeit vitesse velocidad velocità speed motor_speed_measured angular_velocity n rpm n_ist omega_act ω shaftSpeed speed_1",
            ),
            (
                "theta",
                "Winkel Drehwinkel angle ángulo angolo theta phi rotor_position encoder angular_position theta_meas",
            ),
            ("x", "Weg Lage position posición posizione x_ist pos actual_position"),
            ("time", "Zeit temps tiempo tempo time Uhrzeit timestamp Time_elapsed"),
            (
                "torque",
                "Drehmoment Moment Kraft couple par coppia torque force torque_cmd tau M motor_torque fuerza Motormoment",
            ),
            (
                "T_l",
                "Lastmoment load_torque couple_de_charge par_de_carga coppia_di_carico torque_sensor torqueLoad T_load tau_l",
            ),
            (
                "temperature",
                "Temperatur temperature temp Motortemperatur temperatura winding_temp_x",
            ),
            (
                "reference",
                "Sollwert setpoint consigne consigna riferimento theta_ref pos_ref vel_cmd speedSetpoint n_soll Solldrehzahl target_position ref reference speed_ref",
            ),
            ("theta_load", "load_angle theta_load Lastwinkel link_angle theta2 angle_2 theta_l"),
            ("omega_load", "omega2 omega_load load_speed Lastdrehzahl speed2"),
            (
                "segment",
                "run segment trial experiment Lauf Versuch essai ensayo prova episode test_id run_id RunNumber Versuch_Nr",
            ),
        ] {
            for name in names.split(' ').filter(|name| *name != "winding_temp_x") {
                assert_eq!(stated(name, None), Some(signal), "{name}");
            }
        }
        for name in [
            "i_cmd",
            "current_ref",
            "Id",
            "i_d",
            "speed_error",
            "bus_voltage_limit",
            "Bemerkung",
            "mode",
            "Strom_Soll",
            "position3",
            "acceleration",
            "power",
            "deflection",
            "attribute",
        ] {
            assert_eq!(stated(name, None), None, "{name}");
        }
    }

    #[test]
    fn a_measurement_ranks_above_a_filter_and_an_estimate() {
        let rank = |name: &str| guess(name, None, None).unwrap().rank;
        assert!(rank("speed_meas") < rank("speed"));
        assert!(rank("speed") < rank("speed_filt"));
        assert!(rank("speed_filt") < rank("speed_est"));
        assert!(rank("torque_measured") < rank("torque_cmd"));
    }
}
