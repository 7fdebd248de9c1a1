//! Foreign names taken for signals that the program knows.

use crate::canonical::{Canonical, exact};
use crate::unit::Quantity::{Angle, AngularSpeed, Length, Speed};
use crate::words::{Kind, Word, meaning, words};

/// Whole names (folded and joined) whose parts would say something else or nothing.
const WHOLE: &[(&[&str], &[&str])] = &[
    (&["t", "tsec", "xvalue"], &["time"]),
    (&["vir", "uin", "vin", "input", "control", "controlvoltage"], &["u"]),
    (&["qm"], &["x", "theta"]),
    (&["qg"], &["reference"]),
    (&["tl", "tload", "load"], &["T_l"]),
    (&["f", "fm"], &["torque"]),
    // One letter for two things: the unit tells.
    (&["v"], &["u", "v"]),
    (&["q"], &["x", "theta"]),
    (&["qd", "dq", "qdot", "dtheta", "thetadot"], &["omega", "v"]),
    (&["testid", "testnr", "testno", "testnumber"], &["segment"]),
];

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

/// The signals that words may mean, in order, and their rank.
fn targets(words: &[Word]) -> Option<(&'static [&'static str], Rank)> {
    let has = |word: Word| words.contains(&word);
    let mut kinds: Vec<Kind> = Vec::new();
    for word in words {
        if let Word::Kind(kind) = word
            && !kinds.contains(kind)
        {
            kinds.push(*kind);
        }
    }
    let digits: Vec<u32> = words
        .iter()
        .filter_map(|it| if let Word::Digit(it) = it { Some(*it) } else { None })
        .collect();
    if kinds == [Kind::Segment] {
        return Some((&["segment"], Rank::Plain));
    }
    // A third speed belongs to a machine of several axes: which one is meant only a user knows.
    if digits.iter().any(|digit| *digit > 2) || has(Word::Number) {
        return None;
    }
    let second = digits.contains(&2);
    // `speed2` is behind the gear; `motor 2`, `joint_2_pos` and `q2` are of another axis.
    if second && (has(Word::Neutral) || has(Word::Rotor) || has(Word::Q) || words.len() > 3) {
        return None;
    }
    let kind = match kinds[..] {
        [] if has(Word::Q) => Some(Kind::Position),
        [] => None,
        [kind] => Some(kind),
        [Kind::Angle, Kind::Speed | Kind::Velocity | Kind::AngularSpeed]
        | [Kind::Speed | Kind::Velocity | Kind::AngularSpeed, Kind::Angle]
        | [Kind::AngularSpeed, Kind::Speed]
        | [Kind::Speed, Kind::AngularSpeed] => Some(Kind::AngularSpeed),
        [Kind::Angle, Kind::Position] | [Kind::Position, Kind::Angle] => Some(Kind::Angle),
        [Kind::Tachometer, Kind::Speed | Kind::Velocity | Kind::AngularSpeed]
        | [Kind::Speed | Kind::Velocity | Kind::AngularSpeed, Kind::Tachometer] => {
            Some(Kind::Tachometer)
        }
        _ => return None,
    };
    let kind = match kind {
        Some(Kind::Angle | Kind::Position) if has(Word::Rate) => Some(Kind::Speed),
        Some(Kind::Speed | Kind::Velocity) if has(Word::Angular) => Some(Kind::AngularSpeed),
        Some(Kind::Speed) if has(Word::Linear) => Some(Kind::Velocity),
        Some(Kind::Position) if has(Word::Angular) || has(Word::Rotor) => Some(Kind::Angle),
        Some(Kind::Velocity) if has(Word::Rotor) => Some(Kind::Speed),
        kind => kind,
    };
    let rank = match () {
        () if has(Word::Estimated) => Rank::Estimated,
        () if has(Word::Filtered) => Rank::Filtered,
        () if has(Word::Wanted) => Rank::Commanded,
        () if has(Word::Measured) => Rank::Measured,
        () => Rank::Plain,
    };
    let load = has(Word::Load);
    if has(Word::Wanted) {
        return match kind {
            Some(Kind::Torque) if !load => Some((&["torque"], rank)),
            Some(Kind::Voltage) if !load => Some((&["u"], rank)),
            // What a current loop is asked for is neither the current nor what the drive follows.
            Some(Kind::Current | Kind::Time | Kind::Temperature | Kind::Torque | Kind::Voltage) => {
                None
            }
            _ if load || second => None,
            _ => Some((&["reference"], if rank == Rank::Commanded { Rank::Plain } else { rank })),
        };
    }
    let found: &[&str] = match kind? {
        Kind::Torque if load || has(Word::Sensor) || second => &["T_l"],
        Kind::Speed if load || second => &["omega_load", "v_load"],
        Kind::AngularSpeed if load || second => &["omega_load"],
        Kind::Velocity if load || second => &["v_load", "omega_load"],
        Kind::Angle if load || second => &["theta_load", "x_load"],
        Kind::Position if load || second => &["x_load", "theta_load"],
        Kind::Time if !load && !second => &["time"],
        Kind::Temperature if !second => &["temperature"],
        _ if load || second => return None,
        Kind::Time | Kind::Temperature | Kind::Segment => return None,
        Kind::Voltage => &["u"],
        Kind::Current => &["i"],
        Kind::Torque => &["torque"],
        Kind::Speed => &["omega", "v"],
        Kind::AngularSpeed => &["omega"],
        Kind::Velocity => &["v", "omega"],
        Kind::Angle => &["theta", "x"],
        Kind::Position => &["x", "theta"],
        Kind::Tachometer => &["T"],
    };
    Some((found, rank))
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

    fn told(name: &str, unit: Option<&str>) -> Option<&'static str> {
        guess(name, unit, None).map(|guess| guess.canonical.name)
    }

    #[test]
    fn every_whole_name_is_listed_once_and_leads_somewhere() {
        let mut seen: Vec<&str> = Vec::new();
        for (names, targets) in WHOLE {
            for name in *names {
                assert_eq!(words(name).concat(), **name);
                assert!(!seen.contains(name), "`{name}` is listed twice");
                seen.push(name);
            }
            for target in *targets {
                assert!(exact(target).is_some(), "`{target}` is no canonical signal");
            }
        }
    }

    #[test]
    fn the_unit_tells_what_a_word_means() {
        assert_eq!(told("Speed", None), Some("omega"));
        assert_eq!(told("Speed", Some("mm/s")), Some("v"));
        assert_eq!(told("position", Some("deg")), Some("theta"));
        assert_eq!(told("Position", None), Some("x"));
        assert_eq!(told("V", None), Some("u"));
        assert_eq!(told("T", Some("degC")), Some("temperature"));
        assert_eq!(told("T", Some("Nm")), Some("torque"));
        assert_eq!(told("T", None), None);
        assert_eq!(told("t", None), Some("time"));
        assert_eq!(told("Speed", Some("V")), None);
        assert_eq!(told("vibration", None), None);
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
                assert_eq!(told(name, None), Some(signal), "{name}");
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
            assert_eq!(told(name, None), None, "{name}");
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
