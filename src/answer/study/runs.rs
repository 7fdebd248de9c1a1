//! A picture a run: residual and bands around the fault, the samples outside, the signals.

use std::ops::Range;

use drivescope_scenarios::results::{DetectorKind, Pictures, StudyResults};

use super::trace::drawing;
use super::words::{level, name, outside, row_of};
use crate::answer::block::{Align, Block, Column, HTML, Picture, Plot, Table};
use crate::report::words::{capital, number, percent};

/// Rows of the data table of a run.
const BLOCKS: usize = 20;

/// Where the run is on its page.
pub(super) fn id(place: usize) -> String {
    format!("run-{}", place + 1)
}

/// Where every run is, and what was run.
pub(super) fn names(pictures: &[Pictures]) -> Vec<(String, String)> {
    pictures.iter().enumerate().map(|(place, picture)| (id(place), name(picture))).collect()
}

/// The section.
pub(super) fn blocks(study: &StudyResults, pictures: &[Pictures]) -> Vec<Block> {
    let about = "The residual r = T - y_m with its adaptive bands, around the time at which the fault \
                 acts. Ticks below mark every sample outside the bands; a solid bar is what the rule \
                 waits for. Constant thresholds are dashed";
    let mut blocks = vec![Block::Sentence(about.to_owned())];
    if pictures.is_empty() {
        blocks.push(Block::Note("No traces were kept".to_owned()));
    }
    let all = pictures.iter().enumerate();
    blocks.extend(all.map(|(place, picture)| run(study, picture, place)));
    vec![Block::In(HTML, blocks)]
}

/// One run: what failed, its traces, their numbers.
fn run(study: &StudyResults, picture: &Pictures, place: usize) -> Block {
    let (id, shown) = (id(place), shown(study, picture));
    let label = picture.fault.as_ref().map(|name| format!(" \u{2002}{}", name.label));
    let title = capital(&name(picture)) + &label.unwrap_or_default();
    let blocks = if shown.is_empty() {
        let why = "The run ends before the fault begins: there is nothing to show";
        vec![Block::Note(why.to_owned())]
    } else {
        let caption = caption(study, picture, &shown);
        let plot = Plot::Figure(drawing(study, picture, &shown, (&id, &caption)));
        let summary = format!("Data of this picture, in blocks of {} samples", block(&shown));
        let blocks = vec![Block::Table(data(study, picture, &shown))];
        vec![Block::Figure(Picture { plot, caption }), Block::Details { summary, blocks }]
    };
    Block::Part { id, title, blocks }
}

/// The fault's span and half of its length on both sides, as far as the run holds it.
fn shown(study: &StudyResults, picture: &Pictures) -> Range<usize> {
    let span = study.fault_span;
    let beside = span.to.saturating_sub(span.from) / 2;
    let end = (span.to + beside).min(picture.residual.len());
    span.from.saturating_sub(beside).min(end)..end
}

fn share_outside(picture: &Pictures, samples: Range<usize>) -> f64 {
    let count = samples.len();
    samples.filter(|k| outside(picture, *k)).count() as f64 / count as f64
}

/// What to see, in words.
fn caption(study: &StudyResults, picture: &Pictures, shown: &Range<usize>) -> String {
    let Some(name) = &picture.fault else {
        let declared = match picture.declared {
            Some(sample) => format!("a fault was declared at sample {sample}: a false alarm"),
            None => "no fault was declared".into(),
        };
        return format!(
            "A healthy run: {} % of the samples shown lie outside the bands (designed: {} %), and \
             {declared}.",
            percent(share_outside(picture, shown.clone()), 1),
            level(study.beta)
        );
    };
    let from = study.fault_span.from;
    let declared = match picture.declared {
        Some(sample) if sample >= from => format!(
            "Declared at sample {sample}, {} samples ({} ms) after the fault began.",
            sample - from,
            number(1e3 * study.drive.period_s * (sample - from) as f64)
        ),
        Some(sample) => format!(
            "Declared at sample {sample}, {} samples before the fault began: a false alarm.",
            from - sample
        ),
        None => "Not declared.".into(),
    };
    let rate = |method| row_of(study, name, method).map(|row| percent(row.r_td, 1));
    match (rate(DetectorKind::Mem), rate(DetectorKind::Constant)) {
        (Some(mem), Some(constant)) => format!(
            "{declared} Of the faulty samples {mem} % lie outside the bands, {constant} % outside \
             the constant thresholds."
        ),
        _ => declared,
    }
}

fn block(shown: &Range<usize>) -> usize {
    shown.len().div_ceil(BLOCKS).max(1)
}

/// The picture as numbers.
fn data(study: &StudyResults, picture: &Pictures, shown: &Range<usize>) -> Table {
    let unit = &study.drive.tacho_unit;
    let column = |heading: String| Column::new(Align::Number, heading);
    let columns = vec![
        Column::new(Align::Name, "samples"),
        column(format!("mean r [{unit}]")),
        column(format!("least r [{unit}]")),
        column(format!("greatest r [{unit}]")),
        column(format!("mean lower band [{unit}]")),
        column(format!("mean upper band [{unit}]")),
        column("outside [%]".to_owned()),
        column(format!("mean T [{unit}]")),
        column("mean C_m [V]".to_owned()),
    ];
    let caption = format!("Run {}, means and extremes of each block", name(picture));
    let mut table = Table::new(caption, columns);
    for from in shown.clone().step_by(block(shown)) {
        let samples = from..(from + block(shown)).min(shown.end);
        let of = |signal: &[f64]| Extent::of(signal, samples.clone());
        let r = of(&picture.residual);
        table.push(vec![
            format!("{}\u{2013}{}", samples.start, samples.end - 1).into(),
            decimals(r.mean, 1).into(),
            decimals(r.least, 1).into(),
            decimals(r.greatest, 1).into(),
            decimals(of(&picture.lower).mean, 1).into(),
            decimals(of(&picture.upper).mean, 1).into(),
            percent(share_outside(picture, samples.clone()), 0).into(),
            decimals(of(&picture.t).mean, 1).into(),
            decimals(of(&picture.c_m).mean, 3).into(),
        ]);
    }
    table
}

fn decimals(value: f64, count: usize) -> String {
    if value.is_finite() { format!("{value:.count$}") } else { "-".into() }
}

struct Extent {
    mean: f64,
    least: f64,
    greatest: f64,
}

impl Extent {
    /// Of the samples that are there and finite; not finite where there are none.
    fn of(signal: &[f64], samples: Range<usize>) -> Self {
        let end = samples.end.min(signal.len());
        let values = signal[samples.start.min(end)..end].iter().filter(|v| v.is_finite());
        let (count, sum, least, greatest) = values.fold(
            (0.0, 0.0, f64::INFINITY, f64::NEG_INFINITY),
            |(count, sum, least, greatest), v| {
                (count + 1.0, sum + v, f64::min(least, *v), f64::max(greatest, *v))
            },
        );
        Self { mean: sum / count, least, greatest }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::testing::{pictures, study};

    #[test]
    fn what_is_shown_is_the_fault_and_half_its_length_around_it() {
        let (study, mut pictures) = (study(), pictures());
        assert_eq!(shown(&study, &pictures[0]), 3500..5500);
        pictures[0].residual.truncate(4200);
        assert_eq!(shown(&study, &pictures[0]), 3500..4200);
        pictures[0].residual.truncate(100);
        assert_eq!(shown(&study, &pictures[0]), 100..100);
    }

    #[test]
    fn the_caption_says_when_it_was_declared() {
        let (study, mut pictures) = (study(), pictures());
        let says = |picture: &Pictures| caption(&study, picture, &shown(&study, picture));
        assert!(says(&pictures[1]).starts_with("Declared at sample 4052, 52 samples (260 ms)"));
        pictures[1].declared = Some(3900);
        assert!(says(&pictures[1]).contains("100 samples before the fault began"));
        pictures[1].declared = None;
        assert!(says(&pictures[1]).starts_with("Not declared."));
        assert!(says(&pictures[12]).contains("no fault was declared"));
    }

    #[test]
    fn blocks_leave_out_what_was_not_computed() {
        let block = Extent::of(&[f64::NAN, 1.0, 3.0, 9.0], 0..3);
        assert_eq!((block.mean, block.least, block.greatest), (2.0, 1.0, 3.0));
        assert!(!Extent::of(&[1.0], 5..9).mean.is_finite());
    }
}
