//! The numbers of a comparison as tiles and tables.

use drivescope_discovery::compare::{Comparison, Curve, Finding, OutputComparison};
use drivescope_plant::drive::Motion;
use drivescope_plant::units::for_motion;

use super::{Setting, correlations};
use crate::answer::block::{ALL, Align, Block, Column, Fact, HTML, Said, Table};
use crate::answer::{noise, run};
use crate::report::words::{error, fit_percent, number, p_value, percent};

/// The figures that matter most.
pub(crate) fn tiles(compared: &Comparison, setting: &Setting) -> Block {
    let step = setting.step;
    let on = if step.is_some() { " on estimation" } else { "" };
    let own = step.map_or(compared.error, |step| step.estimation_error);
    let floor = error(compared.floor);
    // A text has the error in its second sentence, and the fits in the table of the residuals.
    let mut tiles = vec![
        Fact::new(HTML, format!("Error{on}"), error(own))
            .note(format!("in units of the noise, floor {floor}")),
    ];
    tiles.extend(
        setting
            .validation_error
            .map(|it| Fact::new(ALL, "Error on validation", error(it)).note("what only judges")),
    );
    let whole = if step.is_some() { "over the whole recording; " } else { "" };
    for output in compared.recordings.first().map_or(&[][..], |it| &it.outputs) {
        let ahead = fit(output.one_step_percent);
        tiles.push(
            Fact::new(HTML, format!("Fit of {}", output.name), fit(output.fit_percent))
                .note(format!("{whole}one step ahead {ahead}")),
        );
    }
    Block::Tiles(tiles)
}

fn fit(value: Option<f64>) -> String {
    value.map_or_else(|| "constant".to_owned(), fit_percent)
}

/// The variables over which the model fails.
pub(crate) fn findings(compared: &Comparison, motion: Motion) -> Vec<Block> {
    let about = Block::Note(format!(
        "{} possible laws over speed, its sign, current, angle, time, temperature, acceleration and \
         limits were tested with blocks of {} s. The probability is that of as much by chance, \
         corrected for their number, each row conditional on the rows above; below 0.001 it is \
         reported",
        compared.tested,
        number(compared.block_s)
    ));
    let found = match compared.findings.as_slice() {
        // The verdict says it.
        [] => Block::In(
            HTML,
            vec![Block::Sentence("Nowhere: no variable explains the residual".to_owned())],
        ),
        some => where_it_fails(some, motion),
    };
    vec![found, Block::In(HTML, vec![about])]
}

/// The same as a table.
pub(crate) fn where_it_fails(findings: &[Finding], motion: Motion) -> Block {
    let column = Column::new;
    let columns = vec![
        column(Align::Name, "Variable"),
        column(Align::Number, "Share of the excess"),
        column(Align::Number, "By chance"),
        column(Align::Name, "Acts on"),
        column(Align::Words, "What it looks like"),
    ];
    let mut table = Table::new("Where the model fails, most telling first", columns);
    for it in findings {
        let unit = for_motion(motion, "rad");
        let period = it.period.map(|it| format!(", period {} {unit}", number(it)));
        table.push(vec![
            it.variable.into(),
            format!("{} %", percent(it.share, 1)).into(),
            p_value(it.p_value).into(),
            it.balance.into(),
            (it.words.clone() + &period.unwrap_or_default()).into(),
        ]);
    }
    Block::Table(table)
}

/// The points of a curve with their bands.
pub(super) fn curve(it: &Curve) -> Block {
    let columns = [
        format!("{} [{}]", it.variable, it.x_unit),
        format!("missing [{}]", it.unit),
        "95 % from".to_owned(),
        "to".to_owned(),
    ];
    let columns = columns.map(|heading| Column::new(Align::Number, heading));
    let mut table = Table::new(format!("Data: {}", it.words), columns.into());
    for (k, x) in it.x.iter().enumerate() {
        let values = [*x, it.value[k], it.lower[k], it.upper[k]];
        table.push(values.map(|value| number(value).into()).into());
    }
    Block::Table(table)
}

/// Whether the residual of an output is white, and whether it knows the input.
pub(super) fn tests(output: &OutputComparison) -> [&'static str; 2] {
    let yes = |found: bool| if found { "yes" } else { "no" };
    [yes(!output.autocorrelation.correlated), yes(output.input_correlation.correlated)]
}

/// Every output of every recording, and whether its residual is white.
pub(super) fn residuals(compared: &Comparison) -> Vec<Block> {
    type Output<'a> = (&'a str, &'a OutputComparison);
    let name = |heading: &str| Column::new(Align::Name, heading);
    let figure = |heading: &str| Column::new(Align::Number, heading);
    let columns: &[(Column, Said<Output>)] = &[
        (name("Recording"), |(recording, _)| (*recording).into()),
        (name("Output"), |(_, it)| it.name.into()),
        (figure("Fit"), |(_, it)| fit(it.fit_percent).into()),
        (figure("Fit one step ahead"), |(_, it)| fit(it.one_step_percent).into()),
        (figure("rms difference"), |(_, it)| format!("{} {}", number(it.rms), it.unit).into()),
        (figure("Error"), |(_, it)| error(it.error).into()),
        (figure("Error one step ahead").only(HTML), |(_, it)| error(it.one_step_error).into()),
        (figure("Effective samples").only(HTML), |(_, it)| {
            format!("{:.0}", it.autocorrelation.effective_samples).into()
        }),
        (name("White"), |(_, it)| tests(it)[0].into()),
        (name("Knows the input"), |(_, it)| tests(it)[1].into()),
    ];
    let rows = compared.recordings.iter().flat_map(|recording| {
        recording.outputs.iter().map(move |it| (recording.name.as_str(), it))
    });
    let table = Table::of("Residuals", columns, rows);
    let about = Block::Note(
        "Errors in units of the noise. Bands of the correlations allow for correlated samples \
         (Bartlett). The prediction one step ahead uses what was left of all outputs before"
            .to_owned(),
    );
    let each = compared.recordings.iter().enumerate().map(|(place, it)| correlations(it, place));
    vec![Block::Table(table), Block::In(HTML, [about].into_iter().chain(each).collect())]
}

/// Noise, observer, doubts.
pub(super) fn setting(compared: &Comparison, setting: &Setting) -> Vec<Block> {
    let noise = setting.noise.iter().map(|it| noise(it, ""));
    let facts = Block::Facts([run(compared.observer_hz)].into_iter().chain(noise).collect());
    let doubts = setting.doubts.iter().map(|doubt| Block::Alert(doubt.clone()));
    [facts].into_iter().chain(doubts).collect()
}
