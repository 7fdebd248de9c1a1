//! Where a character of a law stands in the file: TOML strings have quotes and escapes.

/// Byte in the source of a TOML string, quotes included, at which the byte `target` of its
/// content comes from.
pub(super) fn offset_in_source(source: &str, target: usize) -> usize {
    let (quotes, escapes) = ["\"\"\"", "'''", "\"", "'"]
        .into_iter()
        .find(|quotes| source.starts_with(quotes))
        .map_or((0, false), |quotes| (quotes.len(), quotes.starts_with('"')));
    let mut at = quotes;
    if quotes == 3 {
        // A newline right after the opening quotes is not part of the content.
        at += newline(&source[at..]);
    }
    let mut content = 0;
    loop {
        let rest = &source[at..];
        let Some(first) = rest.chars().next() else { return at };
        if escapes && first == '\\' && continues(&rest[1..]) {
            let line = rest[1..].trim_start_matches([' ', '\t', '\r', '\n']);
            at += rest.len() - line.len();
        } else if content >= target {
            return at;
        } else if escapes && first == '\\' {
            let (length, decoded) = escape(&rest[1..]);
            at += 1 + length;
            content += decoded;
        } else {
            at += first.len_utf8();
            content += first.len_utf8();
        }
    }
}

/// Bytes of the newline at the start, if there is one.
fn newline(text: &str) -> usize {
    if text.starts_with("\r\n") { 2 } else { usize::from(text.starts_with('\n')) }
}

/// Whether a backslash before this text joins the line to the next one.
fn continues(text: &str) -> bool {
    newline(text.trim_start_matches([' ', '\t'])) > 0
}

/// Bytes of an escape after its backslash, and of the character that it stands for.
fn escape(text: &str) -> (usize, usize) {
    let digits = match text.as_bytes().first() {
        Some(b'x') => 2,
        Some(b'u') => 4,
        Some(b'U') => 8,
        _ => return (1, 1),
    };
    let code = text.get(1..=digits).and_then(|hex| u32::from_str_radix(hex, 16).ok());
    (1 + digits, code.and_then(char::from_u32).map_or(1, char::len_utf8))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every character of the content is found again in the source, whatever the quotes.
    #[test]
    fn each_character_is_found_in_the_source() {
        for source in [
            r#""omega * $""#,
            "'omega * $'",
            "\"\"\"\nomega\n * $\"\"\"",
            "\"\"\"omega \\\n   * \\\n\n  $\"\"\"",
            "'''\r\nomega\r\n * $'''",
            r#""\u00e4\U0001F600\t\" \x41 $""#,
            "\"ä😀 $\"",
        ] {
            let text = format!("law = {source}");
            let table = toml::de::DeTable::parse(&text).expect("it is TOML");
            let content = table.get_ref().get("law").expect("there").get_ref().as_str();
            let content = content.expect("a text").to_owned();
            let dollar = content.find('$').expect("there");
            let found = offset_in_source(source, dollar);
            assert_eq!(source[found..].chars().next(), Some('$'), "{source}");
            assert_eq!(offset_in_source(source, content.len()), found + 1, "{source}");
        }
    }
}
