//! Colours and dashes, by name: the style sheet knows what they are in light, dark and print.

/// The style sheet of the plots, for the page's `<style>`.
pub const STYLE: &str = include_str!("plot.css");

/// A colour of the Okabe-Ito set.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Ink {
    /// The colour of text: measured signals.
    Text,
    /// Blue (sky blue on dark ground).
    Blue,
    Orange,
    /// Bluish green.
    Green,
    /// Vermilion: what calls for attention.
    Vermilion,
    /// Reddish purple.
    Purple,
}

impl Ink {
    /// Its class in the style sheet.
    pub fn class(self) -> &'static str {
        match self {
            Self::Text => "k-text",
            Self::Blue => "k-blue",
            Self::Orange => "k-orange",
            Self::Green => "k-green",
            Self::Vermilion => "k-vermilion",
            Self::Purple => "k-purple",
        }
    }
}

/// How a line is broken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Dash {
    /// Not at all.
    Solid,
    /// Long dashes.
    Dashed,
    /// Dots.
    Dotted,
}

impl Dash {
    /// Its class in the style sheet.
    pub fn class(self) -> &'static str {
        match self {
            Self::Solid => "d-solid",
            Self::Dashed => "d-dashed",
            Self::Dotted => "d-dotted",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_style_sheet_knows_every_class() {
        let inks = [Ink::Text, Ink::Blue, Ink::Orange, Ink::Green, Ink::Vermilion, Ink::Purple];
        for class in inks.map(Ink::class) {
            assert!(STYLE.contains(&format!(".{class}{{--ink:")), "{class}");
        }
        for class in [Dash::Dashed, Dash::Dotted].map(Dash::class) {
            assert!(STYLE.contains(&format!(".{class}{{stroke-dasharray:")), "{class}");
        }
    }
}
