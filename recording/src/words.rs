//! The words of a column's name, and what each says in the languages of our users.

/// What a word says is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Time,
    Voltage,
    Current,
    /// Torque or force.
    Torque,
    /// Of a motor or an axis: which of the two the unit tells.
    Speed,
    AngularSpeed,
    /// Linear unless the unit says otherwise.
    Velocity,
    Angle,
    /// Linear unless the unit says otherwise.
    Position,
    Temperature,
    Tachometer,
    Segment,
}

/// What else a word says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Word {
    /// What is measured.
    Kind(Kind),
    /// Wanted, not measured.
    Wanted,
    /// At the load or behind the gear.
    Load,
    /// By a sensor of its own.
    Sensor,
    Measured,
    /// Smoothed.
    Filtered,
    /// Calculated.
    Estimated,
    /// Turning.
    Angular,
    /// Moving along a line.
    Linear,
    /// Of the motor or a joint, whose position is an angle where no unit says otherwise.
    Rotor,
    /// The derivative of what stands beside it.
    Rate,
    /// A number of a run, beside the word for one.
    Number,
    /// The letter q: an axis of the current, or a joint's position.
    Q,
    Digit(u32),
    /// Nothing of its own.
    Neutral,
}

use Kind::{
    Angle, AngularSpeed, Current, Position, Segment, Speed, Tachometer, Temperature, Time, Torque,
    Velocity, Voltage,
};
use Word::{
    Angular, Estimated, Filtered, Linear, Load, Measured, Neutral, Number, Q, Rate, Rotor, Sensor,
    Wanted,
};

/// Every word known, as [`fold`] writes it.
const VOCABULARY: &[(Word, &str)] = &[
    (
        Word::Kind(Time),
        "time timestamp times zeit uhrzeit zeitstempel clock temps tiempo tempo seconds sekunden datetime datumzeit horodatage heure hora ora elapsed second",
    ),
    (
        Word::Kind(Voltage),
        "voltage volt volts spannung tension tensione voltaje u uq vq ua va um vm",
    ),
    (
        Word::Kind(Current),
        "current strom courant corriente corrente intensite intensidad amps cur curr i iq ia im",
    ),
    (
        Word::Kind(Torque),
        "torque trq tq tau moment drehmoment couple par coppia momento force kraft fuerza forza thrust",
    ),
    (Word::Kind(Speed), "speed spd geschwindigkeit vitesse velocidad velocita"),
    (
        Word::Kind(AngularSpeed),
        "omega w wm rpm n drehzahl winkelgeschwindigkeit rotationsgeschwindigkeit upm gyro giri",
    ),
    (Word::Kind(Velocity), "velocity vel"),
    (Word::Kind(Angle), "theta angle winkel phi angulo angolo drehwinkel encoder azimuth"),
    (
        Word::Kind(Position),
        "position pos posn x weg lage posicion posizione displacement deplacement desplazamiento spostamento verschiebung qpos stroke hub",
    ),
    (Word::Kind(Temperature), "temperature temp temperatur temperatura"),
    (Word::Kind(Tachometer), "tacho tachometer tach tachogenerator"),
    (
        Word::Kind(Segment),
        "run segment trial experiment lauf versuch essai ensayo prova episode messreihe",
    ),
    (
        Wanted,
        "ref reference referenz setpoint sp set target command commanded cmd desired des demand demanded wanted goal soll sollwert consigne consigna riferimento referencia vorgabe fuhrungsgrosse",
    ),
    (Load, "load last charge carga carico link tip arm output abtrieb abtriebs l"),
    (Sensor, "sensor cell messwelle transducer messflansch capteur sensore"),
    (
        Measured,
        "measured measurement meas mes mess act actual ist istwert real feedback fb fbk raw present mesure mesuree medido medida misurato misurata",
    ),
    (Filtered, "filt filtered filter filtre smooth smoothed gefiltert lp lpf avg mean"),
    (
        Estimated,
        "est estimated estimate hat obs observer sim simulated model pred predicted calc geschatzt berechnet",
    ),
    (Angular, "angular rotational angulaire angulare rotation rot"),
    (Linear, "linear lineaire lineal lineare carriage schlitten slide tool translation"),
    (Rotor, "rotor shaft welle arbre albero eje anker motor mot moteur motore joint"),
    (Rate, "dot rate"),
    (Number, "id nr no num number nummer index idx numero"),
    (Q, "q"),
    (
        Neutral,
        "stamp m machine drive antrieb armature a induit servo axis achse axe asse field value wert valor valeur valore signal sig channel kanal canal ch data log of the de du la le el il di del della in an signed vector dc bldc s",
    ),
];

/// The words of a name: at blanks, marks and digits, and where small letters turn into capitals.
pub(crate) fn words(name: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let mut last = ' ';
    for c in name.chars() {
        let starts = !last.is_alphanumeric()
            || last.is_numeric() != c.is_numeric()
            || last.is_lowercase() && c.is_uppercase();
        if c.is_alphanumeric() || "'’".contains(c) && last.is_alphanumeric() {
            match words.last_mut() {
                Some(word) if !starts => word.push_str(&fold(c)),
                _ => words.push(fold(c)),
            }
        }
        last = c;
    }
    words
}

/// Lower case, accents taken off, Greek letters by their names.
fn fold(c: char) -> String {
    let lower: String = c.to_lowercase().collect();
    let folded = match lower.as_str() {
        "à" | "á" | "â" | "ã" | "ä" => "a",
        "ç" => "c",
        "è" | "é" | "ê" | "ë" => "e",
        "ì" | "í" | "î" | "ï" => "i",
        "ñ" => "n",
        "ò" | "ó" | "ô" | "õ" | "ö" => "o",
        "ù" | "ú" | "û" | "ü" => "u",
        "ß" => "ss",
        "ω" => "omega",
        "θ" | "ϑ" => "theta",
        "φ" | "ϕ" => "phi",
        "τ" => "tau",
        _ => return lower,
    };
    folded.to_owned()
}

/// What the words of a name say; `None` where one of them is not known.
pub(crate) fn meaning(name: &str) -> Option<Vec<Word>> {
    let parts: Vec<Vec<Word>> = words(name).iter().map(|it| word(it)).collect::<Option<_>>()?;
    Some(parts.concat())
}

/// A word, or the words that it is composed of (`lastmoment`, `refspeed`).
fn word(text: &str) -> Option<Vec<Word>> {
    if let Ok(digit) = text.parse() {
        return Some(vec![Word::Digit(digit)]);
    }
    let listed = |text: &str| {
        let row = VOCABULARY.iter().find(|row| row.1.split(' ').any(|word| word == text));
        row.map(|row| row.0)
    };
    if let Some(word) = listed(text) {
        return Some(vec![word]);
    }
    // Each part has three letters at least: shorter ones would be found in any word.
    let cuts = text.char_indices().map(|(at, _)| at).filter(|at| *at >= 3 && at + 3 <= text.len());
    cuts.into_iter().find_map(|at| {
        let first = listed(&text[..at])?;
        Some([vec![first], word(&text[at..])?].concat())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_word_stands_twice() {
        let all: Vec<&str> = VOCABULARY.iter().flat_map(|row| row.1.split(' ')).collect();
        for (k, text) in all.iter().enumerate() {
            assert!(!all[..k].contains(text), "`{text}` is listed twice");
            assert_eq!(text.chars().map(fold).collect::<String>(), **text);
        }
    }

    #[test]
    fn names_are_parted_at_marks_capitals_and_digits() {
        for (name, expected) in [
            ("Iq_measured", &["iq", "measured"][..]),
            ("motorSpeedRef", &["motor", "speed", "ref"]),
            ("omega2", &["omega", "2"]),
            ("Vitesse réelle", &["vitesse", "reelle"]),
            ("ω_load", &["omega", "load"]),
            ("RPM", &["rpm"]),
        ] {
            assert_eq!(words(name), expected, "{name}");
        }
        assert_eq!(meaning("Lastmoment"), Some(vec![Load, Word::Kind(Torque)]));
        assert_eq!(meaning("solldrehzahl"), Some(vec![Wanted, Word::Kind(AngularSpeed)]));
        assert_eq!(meaning("vibration"), None);
    }
}
