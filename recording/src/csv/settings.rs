//! Numbers that stand above the header: `Sampling rate: 1 kHz`, `counts per revolution;4096`.

use drivescope_units::{Quantity, Unit};

use super::encoding::text;
use super::lines::Numbered;
use super::number::number;

/// One setting.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Setting {
    /// What it is called, in lower case.
    key: String,
    value: f64,
    unit: String,
}

/// The settings among lines, in order.
pub(super) fn settings(lines: &[Numbered]) -> Vec<Setting> {
    lines.iter().filter_map(|(_, line)| setting(&text(line))).collect()
}

fn setting(line: &str) -> Option<Setting> {
    let line = line.trim_start_matches(['#', '%', '/', ';', '"', ' ']);
    let mark = [':', '=', ';', '\t', ','].into_iter().find(|mark| line.contains(*mark))?;
    let (key, value) = line.split_once(mark)?;
    let value = value.trim_matches(['"', ' ', ':', '=', ';', '\t', ',']);
    let end = value.find(|c: char| c.is_whitespace() || ";\t".contains(c)).unwrap_or(value.len());
    let (mut number_text, mut unit) = (&value[..end], value[end..].trim_matches([';', ' ', '\t']));
    if number(number_text.as_bytes()).is_none() {
        // `0.001s`
        let at = value.find(|c: char| c.is_alphabetic() && !"eE".contains(c))?;
        (number_text, unit) = (value[..at].trim_end_matches(','), value[at..].trim());
    }
    let value = number(number_text.trim().as_bytes()).filter(|value| value.is_finite())?;
    // The unit may stand with the key, too: `Ts [ms]: 1`.
    let (key, inside) = match key.trim().trim_end_matches([']', ')']).split_once(['[', '(']) {
        Some((key, inside)) => (key, inside),
        None => (key, ""),
    };
    let unit = if unit.is_empty() { inside } else { unit };
    Some(Setting { key: key.trim().to_lowercase(), value, unit: unit.trim().to_owned() })
}

/// The sampling time, s, where a setting says it or the rate.
pub(super) fn period_s(settings: &[Setting]) -> Option<f64> {
    let has = |key: &str, words: &[&str]| words.iter().any(|word| key.contains(word));
    settings.iter().find_map(|Setting { key, value, unit }| {
        let rate = ["rate", "frequency", "frequenz", "fréquence", "frecuencia", "frequenza"];
        let sampled = has(key, &["sampl", "abtast", "échantillon", "muestr", "campion"]);
        let in_hertz = match unit.to_lowercase().as_str() {
            "hz" | "1/s" | "s/s" | "sps" | "" => Some(1.0),
            "khz" => Some(1e3),
            "mhz" => Some(1e6),
            _ => None,
        };
        let positive = *value > 0.0;
        if positive && (sampled && has(key, &rate) || key == "fs" || key == "f_s") {
            return in_hertz.map(|factor| 1.0 / (value * factor));
        }
        let time = ["time", "period", "interval", "zeit", "step", "dt", "temps", "tiempo", "tempo"];
        if positive && (sampled && has(key, &time) || ["ts", "t_s", "dt"].contains(&key.as_str())) {
            let unit = if unit.is_empty() { "s" } else { unit };
            let unit = Unit::parse(unit).filter(|unit| unit.quantity == Quantity::Time)?;
            return Some(unit.to_si(*value));
        }
        None
    })
}

/// The counts a revolution of an encoder, where a setting says them.
pub(super) fn counts_a_revolution(settings: &[Setting]) -> Option<f64> {
    let found = settings.iter().find(|Setting { key, value, .. }| {
        let has = |words: &[&str]| words.iter().any(|word| key.contains(word));
        let counts = has(&["count", "cnt", "inc", "ink", "pulse", "impuls", "tick", "cuenta"]);
        let turn = has(&["rev", "turn", "umdr", "tour", "tr", "giro", "vuelta"]);
        let named = key == "cpr" || key == "ppr" || has(&["strichzahl", "encoder resolution"]);
        *value >= 1.0 && (counts && turn || named)
    });
    found.map(|setting| setting.value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stated(text: &str) -> Vec<Setting> {
        settings(&[(1, text.as_bytes().to_vec())])
    }

    #[test]
    fn sampling_is_told_in_many_words() {
        for text in [
            "Sampling rate: 1000 Hz",
            "sample frequency;1;kHz",
            "# Ts = 0.001",
            "Abtastzeit [ms]: 1",
            "% fs=1000",
            "dt = 1ms",
            "sampling time,0.001,s",
        ] {
            assert_eq!(period_s(&stated(text)), Some(0.001), "{text}");
        }
        for text in ["Samples: 1000", "Title; of 3", "Date: 2024-05-03", "rate: 3", "Ts = 0"] {
            assert_eq!(period_s(&stated(text)), None, "{text}");
        }
    }

    #[test]
    fn an_encoder_is_told_too() {
        for text in ["counts per revolution: 4096", "CPR=4096", "Inkremente/Umdrehung;4096"] {
            assert_eq!(counts_a_revolution(&stated(text)), Some(4096.0), "{text}");
        }
        assert_eq!(counts_a_revolution(&stated("revolutions: 7")), None);
    }
}
