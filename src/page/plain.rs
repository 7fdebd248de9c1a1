//! What libraries say, for somebody who has no command line before him: the part of a sentence
//! that names an option goes, the finding stays.

/// Marks between a finding and what to do about it.
const PARTS: [&str; 2] = ["; ", ": "];
/// Ends of sentences.
const ENDS: [&str; 3] = [". ", "? ", "! "];

/// The words without the parts that name an option of the command line.
pub(super) fn plain(words: &str) -> String {
    let mut kept = words.to_owned();
    while let Some(at) = option(&kept) {
        let (from, to) = part(&kept, at);
        kept.replace_range(from..to, "");
    }
    let kept = kept.trim();
    if kept.is_empty() { "it cannot be used as it is".to_owned() } else { kept.to_owned() }
}

/// Where the first option stands.
fn option(words: &str) -> Option<usize> {
    let names = |(at, _): &(usize, &str)| {
        let before = words[..*at].chars().next_back();
        let after = words[at + 2..].chars().next();
        before.is_none_or(|it| !it.is_alphanumeric() && it != '-')
            && after.is_some_and(|it| it.is_ascii_lowercase())
    };
    words.match_indices("--").find(names).map(|(at, _)| at)
}

/// The part around it: what is in brackets, or from the mark before it to the end of the part.
fn part(words: &str, at: usize) -> (usize, usize) {
    let (before, after) = words.split_at(at);
    let last = |marks: &[&str]| marks.iter().filter_map(|it| before.rfind(it)).max();
    let next = |marks: &[&str]| marks.iter().filter_map(|it| after.find(it)).min();
    let to = next(&["; ", ". ", "\n"]).map_or(words.len(), |end| at + end);
    if let (Some(open), Some(close)) = (before.rfind(" ("), after.find(')'))
        && !before[open..].contains(')')
    {
        return (open, at + close + 1);
    }
    let (part, end) = (last(&PARTS), last(&ENDS));
    match (part, end) {
        (Some(part), end) if end.is_none_or(|end| end < part) => (part, to),
        // A sentence of its own goes with its end.
        (_, Some(end)) => (end + 1, (to + 1).min(words.len())),
        _ => (0, to),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_finding_stays_and_the_option_goes() {
        for (said, kept) in [
            ("no time among `a`; name it with --columns time=NAME:UNIT", "no time among `a`"),
            (
                "`x` is no unit; known are V, mV. Say which with --columns u=a:UNIT",
                "`x` is no unit; known are V, mV.",
            ),
            (
                "it is in counts: say how many (or how long) with --columns x=p:counts/4096",
                "it is in counts",
            ),
            ("is it in rpm? Then say --columns omega=COLUMN:rpm", "is it in rpm?"),
            (
                "remove it, or resample (--resample 0.1), which helps",
                "remove it, or resample, which helps",
            ),
            ("another one judges better (--validate)", "another one judges better"),
            ("too long; take fewer, as --resample 0.5 would. It is slow", "too long. It is slow"),
            ("One. Say --columns a=b. Two", "One. Two"),
            ("say --columns a=b", "it cannot be used as it is"),
            ("5 -- 7 and a--b are no options", "5 -- 7 and a--b are no options"),
        ] {
            assert_eq!(plain(said), kept);
        }
    }
}
