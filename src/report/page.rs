//! The frame of a report, and the pieces that its sections share.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::plot::STYLE;

/// Nothing is loaded, nothing runs, nothing is sent.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; img-src data:; \
                      base-uri 'none'; form-action 'none'";

/// The style of reports.
pub(crate) fn style() -> String {
    [include_str!("page.css"), STYLE].concat()
}

/// A whole report: what it is about below its title, its sections, and how it was made.
pub(crate) fn page(title: &str, about: &Markup, sections: &Markup, made: &Markup) -> String {
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta http-equiv="Content-Security-Policy" content=(POLICY);
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { (title) }
                style { (PreEscaped(style())) }
            }
            body {
                a.skip href="#main" { "Skip to the findings" }
                header {
                    h1 { (title) }
                    p.about { (about) }
                }
                main #main { (sections) }
                footer { (made) }
            }
        }
    }
    .into_string()
}

/// A section with a heading that links to itself.
pub(crate) fn section(id: &str, title: &str, body: &Markup) -> Markup {
    html! {
        section id=(id) aria-labelledby={ (id) "-h" } {
            h2 id={ (id) "-h" } { a href={ "#" (id) } { (title) } }
            (body)
        }
    }
}

/// A table that scrolls by itself where the page is narrow, by keyboard too.
pub(crate) fn table(caption: &str, head: &Markup, body: &Markup) -> Markup {
    html! {
        div.scroll role="region" tabindex="0" aria-label=(caption) {
            table {
                caption { (caption) }
                thead { (head) }
                tbody { (body) }
            }
        }
    }
}

/// A picture with what to see in it; on a narrow page it scrolls by itself.
pub(crate) fn figure(id: &str, svg: String, name: &str, caption: &Markup) -> Markup {
    html! {
        figure id=(id) {
            div.scroll role="region" tabindex="0" aria-label=(name) { (PreEscaped(svg)) }
            figcaption { (caption) }
        }
    }
}

/// With a minus sign instead of a hyphen before digits and between spaces.
pub(crate) fn minus(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut before = ' ';
    for (at, c) in text.char_indices() {
        let rest = &text[at + c.len_utf8()..];
        let digit_follows = rest.starts_with(|c: char| c.is_ascii_digit());
        // Not between words or after a number: `2024-05`, but in the exponent of `3e-5`.
        let sign = digit_follows && (!before.is_alphanumeric() || before == 'e');
        let difference = before == ' ' && rest.starts_with(' ');
        out.push(if c == '-' && (sign || difference) { '\u{2212}' } else { c });
        before = c;
    }
    out
}

/// Words with their signs and symbols typeset.
pub(crate) fn typeset(words: &str) -> Markup {
    math(&minus(words))
}

/// Text with its symbols typeset: `r_td` as r with a lowered td, `f_1^2` as f₁². A symbol is one
/// letter, an underscore and what follows it of letters and digits, but for the name of a file.
pub(crate) fn math(text: &str) -> Markup {
    let mut out = String::new();
    // Up to here the text has been written.
    let mut written = 0;
    let mut before = ' ';
    for (at, c) in text.char_indices() {
        let is_start = c.is_ascii_alphabetic() && !before.is_alphanumeric() && before != '_';
        if is_start && at >= written {
            let rest = &text[at + 1..];
            let index = rest.strip_prefix('_').map_or("", alphanumeric);
            let after = rest.get(1 + index.len()..).unwrap_or_default();
            let is_file = after.strip_prefix('.').is_some_and(|it| !alphanumeric(it).is_empty());
            let power = after.strip_prefix('^').map_or("", alphanumeric);
            if !index.is_empty() && !is_file {
                let end = text.len() - after.len() + power.len() + usize::from(!power.is_empty());
                let symbol = match power {
                    "" => html! { (text[written..at]) (c) sub { (index) } },
                    _ => html! { (text[written..at]) (label(&text[at..end])) },
                };
                out += &symbol.into_string();
                written = end;
            }
        }
        before = c;
    }
    out += &html! { (text[written..]) }.into_string();
    PreEscaped(out)
}

/// The letters and digits with which a text begins.
fn alphanumeric(text: &str) -> &str {
    &text[..text.find(|c: char| !c.is_ascii_alphanumeric()).unwrap_or(text.len())]
}

/// The paper's label with raised and lowered digits: `f_1^2` as f₁².
pub(crate) fn label(label: &str) -> String {
    const LOWERED: [char; 10] = ['₀', '₁', '₂', '₃', '₄', '₅', '₆', '₇', '₈', '₉'];
    const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let mut out = String::with_capacity(label.len());
    let mut digits: Option<[char; 10]> = None;
    for c in label.chars() {
        match (c, c.to_digit(10), digits) {
            ('_', ..) => digits = Some(LOWERED),
            ('^', ..) => digits = Some(RAISED),
            (_, Some(digit), Some(set)) => out.push(set[digit as usize]),
            _ => {
                digits = None;
                out.push(c);
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symbols_are_typeset_and_names_are_not() {
        let text = math("r_td of <K_m>, file_name, a_, arx_2 K_e").into_string();
        assert_eq!(
            text,
            "r<sub>td</sub> of &lt;K<sub>m</sub>&gt;, file_name, a_, arx_2 K<sub>e</sub>"
        );
        // The name of a file is none, the end of a sentence is no file.
        let text = typeset("-5 % of f_1^2 in a_1.csv: r - y_e. So K_m.").into_string();
        assert_eq!(text, "−5 % of f₁² in a_1.csv: r − y<sub>e</sub>. So K<sub>m</sub>.");
    }

    #[test]
    fn signs_and_labels_are_typeset() {
        assert_eq!(minus("tacho -5 %, 3e-5, arx-4, 2024-05"), "tacho −5 %, 3e−5, arx-4, 2024-05");
        assert_eq!(label("f_1^2"), "f₁²");
        assert_eq!(label("f_12^1 b2"), "f₁₂¹ b2");
    }
}
