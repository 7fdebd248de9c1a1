//! Dates and times of day as loggers write them, in whole nanoseconds.

/// Nanoseconds in a second.
const SECOND: i128 = 1_000_000_000;
/// Nanoseconds in a day.
pub(super) const DAY: i128 = 86_400 * SECOND;

/// What a text says of a moment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stamp {
    /// Nanoseconds since the first of January 1970.
    Moment(i128),
    /// Nanoseconds since midnight, or since the full hour where `span` is an hour; the clock
    /// starts again after `span` nanoseconds.
    Clock { at: i128, span: i128 },
    /// Days since the first of January 1970.
    Day(i128),
}

/// Reads a date, a time of day, or both; `month_first` tells how `05/03/2024` is meant.
pub(super) fn stamp(text: &str, month_first: bool) -> Option<Stamp> {
    let text = text.trim();
    if !text.starts_with(|c: char| c.is_ascii_digit()) {
        return None;
    }
    if let Some((days, clock)) = text.split_once(" day") {
        // A duration as pandas prints it: `0 days 00:00:01.5`.
        let (at, _) = of_day(clock.trim_start_matches('s').trim())?;
        return Some(Stamp::Clock { at: days.parse::<i128>().ok()? * DAY + at, span: DAY });
    }
    let end = text.find([' ', 'T', '\u{a0}']).unwrap_or(text.len());
    let Some(day) = day(&text[..end], month_first) else {
        return of_day(text).map(|(at, span)| Stamp::Clock { at, span });
    };
    let rest = text[end..].trim_start_matches(['T', ' ', '\u{a0}', '-']);
    if rest.is_empty() {
        return Some(Stamp::Day(day));
    }
    let (clock, offset) = zone(rest)?;
    let (at, span) = of_day(clock)?;
    // Beside a date, `12:30` is hours and minutes.
    let at = if span == DAY { at } else { 60 * at };
    Some(Stamp::Moment(day * DAY + at - offset))
}

/// Days since the first of January 1970 of `2024-05-03`, `03.05.2024`, `05/03/2024`.
fn day(text: &str, month_first: bool) -> Option<i128> {
    let mark = text.chars().find(|c| "-./".contains(*c))?;
    let mut parts = text.trim_end_matches('.').split(mark).map(digits);
    let (a, b, c) = (parts.next()??, parts.next()??, parts.next()??);
    if parts.next().is_some() {
        return None;
    }
    let year_first = text.find(mark) == Some(4);
    let (year, month, day) = match (year_first, mark, month_first) {
        (true, ..) => (a, b, c),
        (false, '/', true) if a <= 12 => (c, a, b),
        (false, '/', false) if b > 12 => (c, a, b),
        _ => (c, b, a),
    };
    let year = if year < 100 { 2000 + year } else { year };
    let right = (1..=12).contains(&month) && (1..=31).contains(&day) && year < 10_000;
    right.then(|| days(year, month, day))
}

/// Days of the Gregorian calendar since the first of January 1970: years begin in March, so that
/// the day that is put in at times is the last.
fn days(year: i128, month: i128, day: i128) -> i128 {
    let year = if month <= 2 { year - 1 } else { year };
    let of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    // 719468 days lie between the first of March of the year 0 and the start of 1970.
    365 * year + year / 4 - year / 100 + year / 400 + of_year - 719_468
}

/// Takes `Z`, `UTC`, `+02:00` or `-0500` off, and gives the offset in nanoseconds.
fn zone(text: &str) -> Option<(&str, i128)> {
    for name in ["Z", "z", "UTC", "GMT"] {
        if let Some(clock) = text.strip_suffix(name) {
            return Some((clock.trim_end(), 0));
        }
    }
    let Some(at) = text.rfind(['+', '-']) else { return Some((text, 0)) };
    let clock = text[..at].trim_end();
    let zone = text[at + 1..].replace(':', "");
    let (hours, minutes) = match zone.len() {
        2 => (digits(&zone)?, 0),
        4 => (digits(&zone[..2])?, digits(&zone[2..])?),
        _ => return None,
    };
    let offset = (3600 * hours + 60 * minutes) * SECOND;
    Some((clock, if text[at..].starts_with('-') { -offset } else { offset }))
}

/// Nanoseconds of `12:00:01.25`, `12:00:01,25 PM`, `12:00:01:250` (all of a day) or `00:01.5` (of
/// an hour), and the span after which the clock starts again.
fn of_day(text: &str) -> Option<(i128, i128)> {
    let half = [("AM", 0), ("A.M.", 0), ("PM", 12), ("P.M.", 12)].iter().find_map(|(word, add)| {
        let at = text.len().checked_sub(word.len())?;
        text.get(at..)?.eq_ignore_ascii_case(word).then_some((at, *add))
    });
    let text = half.map_or(text, |(length, _)| &text[..length]).trim_end();
    let mut parts = text.split(':');
    let (first, second) = (parts.next()?, parts.next()?);
    let (third, fourth) = (parts.next(), parts.next());
    if parts.next().is_some() {
        return None;
    }
    let (hours, minutes, seconds, span) = match (third, fourth) {
        (None, _) => (0, digits(first)?, fraction(second)?, 3600 * SECOND),
        (Some(seconds), None) => (digits(first)?, digits(second)?, fraction(seconds)?, DAY),
        (Some(seconds), Some(thousandths)) => {
            let seconds = digits(seconds)? * SECOND + decimals(thousandths, 3)?;
            (digits(first)?, digits(second)?, seconds, DAY)
        }
    };
    if minutes >= 60 || seconds > 60 * SECOND {
        return None;
    }
    let hours = match half {
        Some((_, add)) if (1..=12).contains(&hours) => hours % 12 + add,
        Some(_) => return None,
        None => hours,
    };
    Some(((3600 * hours + 60 * minutes) * SECOND + seconds, span))
}

/// A few digits as a number; more than any part of a date or a time has are refused.
fn digits(text: &str) -> Option<i128> {
    let right = (1..=6).contains(&text.len()) && text.bytes().all(|byte| byte.is_ascii_digit());
    right.then(|| text.parse().ok())?
}

/// Seconds with decimals in nanoseconds; what is finer is cut off.
fn fraction(text: &str) -> Option<i128> {
    match text.split_once(['.', ',']) {
        Some((whole, rest)) if whole.len() <= 2 && !rest.is_empty() => {
            Some(digits(whole)? * SECOND + decimals(rest, rest.len())?)
        }
        Some(_) => None,
        None => Some(digits(text).filter(|_| text.len() <= 2)? * SECOND),
    }
}

/// Digits behind a point in billionths, padded with zeros on the left to `width` first.
fn decimals(text: &str, width: usize) -> Option<i128> {
    if !text.bytes().all(|byte| byte.is_ascii_digit()) {
        return None;
    }
    let pad = width.saturating_sub(text.len());
    let digits = text.bytes().take(9_usize.saturating_sub(pad));
    let (value, known) =
        digits.fold((0, pad), |(sum, k), byte| (10 * sum + i128::from(byte - b'0'), k + 1));
    Some((known..9).fold(value, |value, _| 10 * value))
}

/// A decimal number in billionths, exact; `None` where it has an exponent or is no number.
pub(super) fn billionths(text: &str) -> Option<i128> {
    let (sign, digits) = text.strip_prefix('-').map_or((1, text), |rest| (-1, rest));
    let (whole, rest) = digits.split_once(['.', ',']).unwrap_or((digits, ""));
    if whole.is_empty() || whole.len() > 20 || !whole.bytes().all(|it| it.is_ascii_digit()) {
        return None;
    }
    Some(sign * (whole.parse::<i128>().ok()? * SECOND + decimals(rest, rest.len())?))
}

/// Nanoseconds in seconds, rounded once.
pub(super) fn seconds(nanoseconds: i128) -> f64 {
    nanoseconds as f64 / SECOND as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_and_times_in_every_writing_are_the_same_moment() {
        // The third of May 2024 is day 19846 since 1970 (54 years, 13 leap days, 31+29+31+30+2).
        let noon = Stamp::Moment((19_846 * 86_400 + 43_201) * SECOND + SECOND / 4);
        for text in [
            "2024-05-03T12:00:01.250Z",
            "2024-05-03 12:00:01.25",
            "2024-05-03T14:00:01.250+02:00",
            "2024-05-03 07:00:01,250 -0500",
            "03.05.2024 12:00:01,250",
            "05/03/2024 12:00:01.250 PM",
            "2024/05/03 12:00:01.250000000",
            "03.05.24 12:00:01.250",
        ] {
            assert_eq!(stamp(text, true), Some(noon), "{text}");
        }
        assert_eq!(stamp("2024-05-03", true), Some(Stamp::Day(19_846)));
        assert_eq!(stamp("13/05/2024", true), stamp("05/13/2024", false));
        assert_eq!(days(1970, 1, 1), 0);
        assert_eq!(days(2000, 3, 1) - days(2000, 2, 28), 2);
        assert_eq!(days(1900, 3, 1) - days(1900, 2, 28), 1);
    }

    #[test]
    fn a_clock_without_a_date_starts_again() {
        let day = |at| Some(Stamp::Clock { at, span: DAY });
        for (text, at) in [
            ("12:00:01.250", 43_201_250_000_000),
            ("12:00:01,250", 43_201_250_000_000),
            ("12:00:01:250", 43_201_250_000_000),
            ("12:00:01 AM", 1_000_000_000),
            ("0 days 00:00:00.005000", 5_000_000),
        ] {
            assert_eq!(stamp(text, true), day(at), "{text}");
        }
        let hour = Stamp::Clock { at: 61_500_000_000, span: 3600 * SECOND };
        assert_eq!(stamp("01:01.5", true), Some(hour));
        for text in ["12", "1.5", "a:b", "12:61:00", "12:00:61", "1.2.3.4", "1.2.3", "99.99.2024"] {
            assert!(!matches!(stamp(text, true), Some(Stamp::Moment(_) | Stamp::Clock { .. })));
        }
    }

    #[test]
    fn decimals_of_stamps_are_exact() {
        assert_eq!(billionths("1714730401.123456789"), Some(1_714_730_401_123_456_789));
        assert_eq!(billionths("-2"), Some(-2 * SECOND));
        assert_eq!(billionths("1e9"), None);
        assert_eq!(seconds(250_000_000), 0.25);
    }
}
