//! First and last words: what was found, how to read it.

use drivescope_scenarios::results::{DetectionRow, DetectorKind, StudyResults};

use super::words::{lead, level, rows_of, verdict};
use crate::answer::block::{Block, Fact, HTML, Item};
use crate::report::words::{given, percent};

/// The verdict and the four figures that carry it.
pub(super) fn headline(study: &StudyResults) -> Vec<Block> {
    let rows = rows_of(&study.detection, DetectorKind::Mem);
    let found = rows.iter().filter(|row| row.detected()).count();
    let alarms = study.healthy.alarms.of(DetectorKind::Mem);
    let tiles = vec![
        Fact::new(HTML, "Faults detected", format!("{found} of {}", rows.len()))
            .judged(found == rows.len())
            .note("bands by model error modelling"),
        Fact::new(HTML, "False alarms", alarms.to_string())
            .judged(alarms == 0)
            .note(format!("in {} healthy samples", study.healthy.samples)),
        delays(study, &rows),
        Fact::new(
            HTML,
            "Healthy samples outside, r_fd",
            format!("{} %", percent(study.r_fd.of(DetectorKind::Mem), 2)),
        )
        .note(format!(
            "designed {} %, paper {} %",
            level(study.beta),
            percent(study.paper.r_fd.mem, 1)
        )),
    ];
    let (words, constant) =
        (verdict(study, DetectorKind::Mem), verdict(study, DetectorKind::Constant));
    let remark = format!("For comparison: {constant}.");
    vec![Block::Verdict { about: String::new(), words, remark }, Block::Tiles(tiles)]
}

/// The verdict of every method.
pub(super) fn verdicts(study: &StudyResults) -> Vec<Block> {
    DetectorKind::ALL.into_iter().map(|method| Block::Sentence(verdict(study, method))).collect()
}

fn delays(study: &StudyResults, rows: &[&DetectionRow]) -> Fact {
    const NAME: &str = "Delay to declaration";
    let mut delays: Vec<usize> = rows.iter().filter_map(|row| row.delay).collect();
    delays.sort_unstable();
    let (Some(least), Some(most)) = (delays.first(), delays.last()) else {
        return Fact::new(HTML, NAME, "none declared");
    };
    let middle = [delays[(delays.len() - 1) / 2], delays[delays.len() / 2]];
    let median = (middle[0] + middle[1]) as f64 / 2.0;
    Fact::new(HTML, NAME, format!("{} ms", given(1e3 * study.drive.period_s * median))).note(
        format!(
            "median, {median} samples; range {least} to {most} (the rule itself takes {})",
            study.window
        ),
    )
}

/// What the figures do not say by themselves.
pub(super) fn reading(study: &StudyResults) -> Vec<Block> {
    let (ours, paper) = (study.r_fd.of(DetectorKind::Mem), study.paper.r_fd.mem);
    let items = [
        "They depend on the assumed noise (see Experiment), which the paper does not state. With more \
         noise the smallest faults are found late or not at all; with less, smaller ones than these \
         are found."
            .to_owned(),
        format!(
            "Adaptive bands lead over constant thresholds by what the process model lacks: the better \
             the model, the smaller their lead. {}",
            lead(study)
        ),
        format!(
            "The share of healthy samples outside the bands is designed: {} %. It is right when it is \
             met (here {} %), not when it is small. The paper's {} % suggests bands wider than its \
             confidence level asks for.",
            level(study.beta),
            percent(ours, 2),
            percent(paper, 1)
        ),
        format!("A false alarm is {} samples in a row outside, not one sample.", study.window),
        "Each fault was run once, with noise drawn from one seed: another seed moves delays by a few \
         samples. The size of a fault, its begin and its end were not known to the diagnoser, and the \
         runs that judge were not used in its design."
            .to_owned(),
    ];
    let item = |head| Item { key: None, code: false, head, note: String::new() };
    vec![Block::In(HTML, vec![Block::List(items.into_iter().map(item).collect())])]
}
