//! Pieces of SVG: escaped text, elements, the frame of a plot with its text alternative.

use std::fmt::Write;

/// Width of every plot, pixels of its own system; it scales with the page.
pub(super) const WIDTH: f64 = 960.0;

/// Greatest width of a character over the font size, generous: legends are placed by it.
const CHARACTER: f64 = 6.6;

/// Text for an element or an attribute in double quotes.
pub(super) fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            // Not allowed in XML, not even escaped.
            c if c.is_control() && !c.is_whitespace() => safe.push('\u{fffd}'),
            c => safe.push(c),
        }
    }
    safe
}

/// About how wide a text is, pixels.
pub(super) fn width(text: &str) -> f64 {
    CHARACTER * text.chars().count() as f64
}

/// A coordinate to a tenth of a pixel.
pub(super) fn px(value: f64) -> f64 {
    (value * 10.0).round() / 10.0
}

/// Appends formatted text to a string, which cannot fail.
macro_rules! put {
    ($out:expr, $($arguments:tt)*) => {
        // Writing to a string cannot fail.
        let _ = write!($out, $($arguments)*);
    };
}
pub(super) use put;

/// Appends a text element; `anchor` is start, middle or end.
pub(super) fn text(out: &mut String, x: f64, y: f64, anchor: &str, class: &str, content: &str) {
    put!(
        out,
        r#"<text x="{}" y="{}" text-anchor="{anchor}" class="{class}">{}</text>"#,
        px(x),
        px(y),
        escaped(content)
    );
}

/// The whole plot, of that width and height, around its content.
pub(super) fn plot(
    id: &str,
    title: &str,
    description: &str,
    (width, height): (f64, f64),
    content: &str,
) -> String {
    let id = escaped(id);
    let class = if width < WIDTH { "plot narrow" } else { "plot" };
    format!(
        r#"<svg class="{class}" viewBox="0 0 {width} {}" role="img" aria-labelledby="{id}-t" aria-describedby="{id}-d"><title id="{id}-t">{}</title><desc id="{id}-d">{}</desc>{content}</svg>"#,
        px(height),
        escaped(title),
        escaped(description),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_cannot_leave_their_place() {
        let svg = plot("a", "</title><script>", "\"&\u{1}", (WIDTH, 10.0), "");
        assert!(svg.contains("&lt;/title&gt;&lt;script&gt;"));
        assert!(svg.contains("&quot;&amp;\u{fffd}"));
    }
}
