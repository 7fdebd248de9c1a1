//! Numbers as the world writes them: decimal point or comma, thousands apart or not.

use drivescope_units::Unit;

use super::encoding::text;

/// Longest text of a number: 17 digits, sign, point and exponent need 24; zeros may be padded.
pub(super) const LONGEST_NUMBER: usize = 64;

/// What marks the decimals of a column, as far as its cells have told.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum Mark {
    /// Nothing has told yet: `1,234` counts as a decimal comma, `1.234` as a point.
    #[default]
    Unknown,
    /// `1,234.5`: a comma parts thousands.
    Point,
    /// `1.234,5`: a point parts thousands.
    Comma,
}

impl Mark {
    /// The number that a field holds; what it tells of the mark is kept.
    pub(crate) fn number(&mut self, field: &[u8]) -> Option<f64> {
        let grouped = *self == Mark::Comma && memchr::memchr(b'.', field).is_some();
        if !grouped && let Some(value) = plain(field) {
            return Some(value);
        }
        let (value, stated) = written(field, *self)?;
        if *self == Mark::Unknown {
            *self = stated;
        }
        Some(value)
    }

    /// What one field tells of the mark.
    pub(super) fn told_by(field: &[u8]) -> Mark {
        written(field, Mark::Unknown).map_or(Mark::Unknown, |(_, stated)| stated)
    }
}

/// The number that a field holds by itself, NaN where it says that it holds none.
pub(crate) fn number(field: &[u8]) -> Option<f64> {
    if is_missing(field) { Some(f64::NAN) } else { Mark::Unknown.number(field) }
}

/// The unit behind a number and a blank, as some loggers write into every cell: `12.5 V`.
pub(super) fn with_unit(field: &[u8]) -> Option<String> {
    let text = text(field);
    let (value, unit) = text.rsplit_once(' ')?;
    let counts = number(value.as_bytes()).is_some_and(f64::is_finite);
    (counts && !unit.bytes().any(|it| it.is_ascii_digit()) && Unit::parse(unit).is_some())
        .then(|| unit.to_owned())
}

/// Whether a field says that there is no value.
pub(super) fn is_missing(field: &[u8]) -> bool {
    let words: [&[u8]; 8] = [b"", b"nan", b"na", b"n/a", b"null", b"none", b"-nan", b"#n/a"];
    words.iter().any(|word| field.eq_ignore_ascii_case(word))
}

/// A plain number with a decimal comma at most: what most cells of such a file are.
pub(super) fn with_comma(field: &[u8]) -> Option<f64> {
    if memchr::memchr(b'.', field).is_some() {
        return None;
    }
    let Some(at) = memchr::memchr(b',', field) else { return plain(field) };
    let mut text = [0; LONGEST_NUMBER];
    let text = text.get_mut(..field.len())?;
    text.copy_from_slice(field);
    text[at] = b'.';
    plain(text)
}

fn plain(field: &[u8]) -> Option<f64> {
    std::str::from_utf8(field).ok()?.parse().ok()
}

/// A number in any writing, and what it tells of the mark.
fn written(field: &[u8], mark: Mark) -> Option<(f64, Mark)> {
    if field.len() > LONGEST_NUMBER || !field.iter().any(u8::is_ascii_digit) {
        return None;
    }
    let text = text(field).replace('\u{2212}', "-");
    let unsigned = text.trim_start_matches(['-', '+']);
    let sign = &text[..text.len() - unsigned.len()];
    // Fortran writes 1.5D-03.
    let exponent_at = unsigned.find(['e', 'E', 'd', 'D']).unwrap_or(unsigned.len());
    let (mantissa, exponent) = unsigned.split_at(exponent_at);
    let mantissa = match mantissa.find(|c| " \u{a0}\u{202f}\u{2009}'’".contains(c)) {
        Some(at) => ungrouped(mantissa, mantissa[at..].chars().next()?)?,
        None => mantissa.to_owned(),
    };
    let (points, commas) = (mantissa.matches('.').count(), mantissa.matches(',').count());
    let one = |mark: char| grouped(&mantissa, mark).is_some();
    let (digits, stated) = match (points, commas) {
        (0, 0) => (mantissa, Mark::Unknown),
        (0, 1) if mark == Mark::Point && one(',') => (ungrouped(&mantissa, ',')?, Mark::Point),
        (1, 0) if mark == Mark::Comma && one('.') => (ungrouped(&mantissa, '.')?, Mark::Comma),
        (0, 1) => {
            let stated = if one(',') { Mark::Unknown } else { Mark::Comma };
            (mantissa.replace(',', "."), stated)
        }
        (1, 0) => {
            let stated = if one('.') { Mark::Unknown } else { Mark::Point };
            (mantissa, stated)
        }
        (0, _) => (ungrouped(&mantissa, ',')?, Mark::Point),
        (_, 0) => (ungrouped(&mantissa, '.')?, Mark::Comma),
        (_, 1) if mantissa.rfind(',') > mantissa.rfind('.') => {
            let (whole, decimals) = mantissa.split_once(',')?;
            (format!("{}.{decimals}", ungrouped(whole, '.')?), Mark::Comma)
        }
        (1, _) => {
            let (whole, decimals) = mantissa.split_once('.')?;
            (format!("{}.{decimals}", ungrouped(whole, ',')?), Mark::Point)
        }
        _ => return None,
    };
    let exponent = exponent.replace(['d', 'D'], "e").replace(',', ".");
    if !digits.starts_with(|c: char| c.is_ascii_digit() || c == '.') {
        return None;
    }
    Some((format!("{sign}{digits}{exponent}").parse().ok()?, stated))
}

/// Whether `mark` parts an integer (perhaps with decimals of another mark) into thousands.
fn grouped(text: &str, mark: char) -> Option<()> {
    let mut groups = text.split(mark);
    let first = groups.next()?;
    let digits = |it: &str| it.bytes().all(|byte| byte.is_ascii_digit());
    let leads = (1..=3).contains(&first.len()) && digits(first) && !first.starts_with('0');
    (leads && groups.all(|it| it.len() == 3 && digits(it))).then_some(())
}

/// The digits without the mark that parts thousands; decimals may follow the last group.
fn ungrouped(text: &str, mark: char) -> Option<String> {
    let end = text.rfind(mark)? + mark.len_utf8();
    let more = text[end..].find(|c: char| !c.is_ascii_digit()).map_or(text.len(), |at| end + at);
    grouped(&text[..more], mark)?;
    Some(text.replace(mark, ""))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_every_writing() {
        for (text, value) in [
            ("1.5", 1.5),
            ("-2e-3", -2e-3),
            ("1,5", 1.5),
            ("-1,5e2", -150.0),
            ("+3", 3.0),
            ("1.234,5", 1234.5),
            ("1,234.5", 1234.5),
            ("-1.234.567,25", -1_234_567.25),
            ("1,234,567", 1_234_567.0),
            ("1 234,5", 1234.5),
            ("1'234.5", 1234.5),
            ("1\u{a0}234", 1234.0),
            ("\u{2212}1.5", -1.5),
            ("1.5D-03", 1.5e-3),
            (",5", 0.5),
            ("1,234", 1.234),
        ] {
            assert_eq!(number(text.as_bytes()), Some(value), "{text}");
        }
        assert_eq!(number(b"1\xa0234,5"), Some(1234.5), "a blank of Windows-1252");
        for missing in ["", "NaN", "nan", "NA", "null", "#N/A"] {
            assert!(number(missing.as_bytes()).is_some_and(f64::is_nan), "{missing}");
        }
        for text in [
            "abc",
            "1,234,5",
            "1 2",
            "0x10",
            "#DIV/0!",
            "12:30",
            "1.2.3",
            "---",
            "-",
            "e",
            "1e",
            "01.02.2024",
            "12.34.567,1",
            "1,2.3,4",
            "A1",
            "5 V",
        ] {
            assert_eq!(number(text.as_bytes()), None, "{text}");
        }
    }

    #[test]
    fn a_unit_may_stand_in_the_cell() {
        assert_eq!(with_unit(b"-1,5 mV").as_deref(), Some("mV"));
        for text in ["5", "5 apples", "V", "12:00 h", "1 2"] {
            assert_eq!(with_unit(text.as_bytes()), None, "{text}");
        }
    }

    #[test]
    fn what_a_column_told_decides_what_is_ambiguous() {
        let read = |mut mark: Mark, fields: &[&str]| -> Vec<Option<f64>> {
            fields.iter().map(|field| mark.number(field.as_bytes())).collect()
        };
        let some = |values: &[f64]| values.iter().copied().map(Some).collect::<Vec<_>>();
        assert_eq!(read(Mark::Point, &["1,234", "0.5"]), some(&[1234.0, 0.5]));
        assert_eq!(read(Mark::Comma, &["1.234", "0,5", "1.5"]), some(&[1234.0, 0.5, 1.5]));
        assert_eq!(read(Mark::Unknown, &["0,5", "1.234", "2"]), some(&[0.5, 1234.0, 2.0]));
        assert_eq!(read(Mark::Unknown, &["1,234.5", "1,234"]), some(&[1234.5, 1234.0]));
        assert_eq!(Mark::told_by(b"0.001"), Mark::Point);
        assert_eq!(Mark::told_by(b"1.001"), Mark::Unknown);
    }
}
