//! Rows at either end that a logger wrote before it had heard of every sensor, or after.

use std::ops::Range;

use crate::canonical;
use crate::place::Lines;
use crate::signal::Signal;
use crate::stretches::Stretches;

/// Share of the rows at either end beyond which a signal that lacks has a hole of its own.
const MOST: f64 = 0.1;
/// What comes at its own slow pace, and must not shorten the rest.
const SLOW: [&str; 2] = ["temperature", "reference"];

/// Cuts rows off at either end that lack values of the signals that the file is read for; which
/// rows stay, and what to say of the others, a phrase each.
pub(crate) fn cut(signals: &mut [Signal], lines: &Lines) -> (Range<usize>, Vec<String>) {
    let rows = signals.first().map_or(0, |it| it.values.len());
    let before = |it: &Signal| it.values.iter().take_while(|value| value.is_nan()).count();
    let behind = |it: &Signal| it.values.iter().rev().take_while(|value| value.is_nan()).count();
    let (start, early) = lacking(signals, rows, before);
    let (end, late) = lacking(signals, rows, behind);
    let kept = start..rows - end;
    let said = |out: Range<usize>, words: &str, names: Vec<&str>| {
        let mut places = Stretches::default();
        out.for_each(|k| places.add(k, lines.line(k)));
        let names: Vec<String> = names.into_iter().map(|name| format!("`{name}`")).collect();
        let places = places.text(lines.counted());
        (!places.is_empty()).then(|| format!("{places}, {words} value of {}", names.join(", ")))
    };
    let said =
        [said(0..start, "before the first", early), said(kept.end..rows, "behind the last", late)];
    let said = said.into_iter().flatten().collect();
    if kept.len() < rows {
        for signal in signals {
            signal.values.truncate(kept.end);
            signal.values.drain(..kept.start);
        }
    }
    (kept, said)
}

/// The most rows that a signal lacks at an end, and the signals that lack some.
fn lacking(
    signals: &[Signal],
    rows: usize,
    count: impl Fn(&Signal) -> usize,
) -> (usize, Vec<&str>) {
    let read =
        |it: &&Signal| canonical::exact(&it.name).is_some() && !SLOW.contains(&it.name.as_str());
    let few =
        |it: &Signal| Some(count(it)).filter(|n| (1..=(MOST * rows as f64) as usize).contains(n));
    let lack = signals.iter().filter(read).filter_map(|it| Some((few(it)?, it.name.as_str())));
    let (counts, names): (Vec<usize>, Vec<&str>) = lack.unzip();
    (counts.into_iter().max().unwrap_or(0), names)
}
