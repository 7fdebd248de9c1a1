//! What the words of a name mean together.

use super::Rank;
use crate::words::{Kind, Word};

/// The signals that words may mean, in order, and their rank.
pub(super) fn targets(words: &[Word]) -> Option<(&'static [&'static str], Rank)> {
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
