//! False alarms, the residual, and whether the assumptions of the bands hold.

use drivescope_scenarios::results::{DetectorKind, StudyResults};

use super::words::{TEST_LEVEL, false_alarms, level, normality, rows_of, whiteness};
use crate::answer::block::{Align, Block, Column, HTML, Table};
use crate::report::words::{count, given, number, p_value, percent};

/// Samples of the paper's sum of squared errors.
const PAPER_SAMPLES: usize = 3000;

/// The section.
pub(super) fn blocks(study: &StudyResults) -> Vec<Block> {
    let alarms_about = format!(
        "r_fd: share of the healthy samples outside the threshold. Widths were measured on {} other \
         healthy samples. False alarms: declarations in these samples; \u{201c}before a \
         fault\u{201d}: in the healthy part of faulty runs",
        study.model.design_samples
    );
    let assumptions_about = format!(
        "Healthy data. A p value below {} rejects the assumption; many samples reject it for \
         deviations too small to matter, so the measured r_fd has the last word",
        given(TEST_LEVEL)
    );
    let note = |words| Block::In(HTML, vec![Block::Note(words)]);
    vec![
        Block::Table(alarms(study)),
        note(alarms_about),
        Block::Table(statistics(study)),
        Block::Table(assumptions(study)),
        note(assumptions_about),
    ]
}

fn alarms(study: &StudyResults) -> Table {
    let column = |heading: &str| Column::new(Align::Number, heading);
    let columns = vec![
        Column::new(Align::Name, "Method"),
        column("r_fd [%]"),
        column("paper [%]").beside(),
        column("designed [%]"),
        column("false alarms"),
        column("before a fault").only(HTML),
    ];
    let healthy = &study.healthy;
    let caption = format!("{}, {} samples", count(healthy.runs, "healthy run"), healthy.samples);
    let mut table = Table::new(caption, columns);
    for method in DetectorKind::ALL {
        let rows = rows_of(&study.detection, method);
        let paper = study.paper.r_fd.of(method);
        let designed = method.info().instead_of_level;
        table.push(vec![
            method.label().into(),
            percent(study.r_fd.of(method), 2).into(),
            paper.map_or_else(|| "-".to_owned(), |rate| percent(rate, 1)).into(),
            designed.map_or_else(|| level(study.beta), str::to_owned).into(),
            false_alarms(healthy.alarms.of(method)),
            false_alarms(rows.iter().map(|row| row.false_alarms).sum()),
        ]);
    }
    table
}

fn statistics(study: &StudyResults) -> Table {
    let (model, unit) = (&study.model, &study.drive.tacho_unit);
    let set_point = study.drive.set_point;
    let rms = |sse: f64, samples: usize| number(set_point * (sse / samples as f64).sqrt());
    let ours = format!(
        "as shares of the set point: {} {unit} rms",
        rms(model.error_model_sse, model.error_model_samples)
    );
    let paper = format!(
        "it gives no scale: as shares of this set point that would be {} {unit} rms, a tachometer's \
         noise; unscaled it would be {} {unit} rms, finer than any",
        rms(study.paper.arx_sse, PAPER_SAMPLES),
        number((study.paper.arx_sse / PAPER_SAMPLES as f64).sqrt()),
    );
    let of = |value: f64| format!("{} {unit}", number(value));
    let (low, high) = model.constant;
    let rows = [
        (
            "process model, sd of its free-run error in training".to_owned(),
            of(model.training_sd),
            format!("{}, {} samples", model.process_model, model.training_samples),
        ),
        (
            "residual on healthy design data, mean".to_owned(),
            of(model.residual_mean),
            "r of the closed loop".to_owned(),
        ),
        ("residual on healthy design data, sd".to_owned(), of(model.residual_sd), String::new()),
        (
            "error model: past outputs, past inputs".to_owned(),
            format!("{}, {}", model.n_a, model.n_b),
            String::new(),
        ),
        (
            "its SSE, one step, in set points squared".to_owned(),
            number(model.error_model_sse),
            ours,
        ),
        ("samples of that sum".to_owned(), model.error_model_samples.to_string(), String::new()),
        (format!("the paper's, over {PAPER_SAMPLES} samples"), number(study.paper.arx_sse), paper),
        ("v, sd of r - y_e".to_owned(), of(model.v), "from which the bands are made".to_owned()),
        (
            "constant thresholds".to_owned(),
            format!("{} to {} {unit}", number(low), number(high)),
            "dashed above".to_owned(),
        ),
    ];
    let columns = vec![
        Column::new(Align::Words, "Quantity"),
        Column::new(Align::Name, "Value"),
        Column::new(Align::Words, "What it is").only(HTML),
    ];
    let mut table = Table::new("Models and residual", columns);
    for (quantity, value, note) in rows {
        table.push(vec![quantity.into(), value.into(), note.into()]);
    }
    table
}

fn assumptions(study: &StudyResults) -> Table {
    let (white, normal) = (study.model.whiteness_p, study.model.normality_p);
    let columns = vec![
        Column::new(Align::Name, "Assumption"),
        Column::new(Align::Number, "p value"),
        Column::new(Align::Words, "Reading").only(HTML),
    ];
    let mut table = Table::new("Do the assumptions of the bands (6), (7) hold?", columns);
    for (name, p, reading) in [
        ("r - y_e is white (independent)", white, whiteness(white)),
        ("r - y_e is normal", normal, normality(normal)),
    ] {
        table.push(vec![name.into(), p_value(p).into(), format!("{reading}.").into()]);
    }
    table
}
