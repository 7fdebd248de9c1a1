//! What a comparison says: the verdict, where and when the model fails, and what that rests on.

mod answer;
pub(crate) mod pictures;
mod setting;
mod tables;
#[cfg(test)]
mod tests;

use drivescope_discovery::compare::{Comparison, Curve, RecordingComparison, Span};
use drivescope_recording::Clock;

use super::block::{Block, HTML, Item, Key, PAGE, Picture, Plot};
use super::named;
use crate::report::words::error;

pub(crate) use answer::CompareAnswer;
pub(crate) use setting::{OfStep, Setting};
use tables::tiles;
pub(crate) use tables::{findings, where_it_fails};
#[cfg(test)]
pub(super) use tests::comparison as sample;

/// Above the floor by which an error is that of the noise still.
const AT_THE_FLOOR: f64 = 1.05;

/// Whether the model explains the recordings down to their noise.
pub(crate) fn explains(compared: &Comparison) -> bool {
    compared.error <= AT_THE_FLOOR * compared.floor
}

/// All of it.
pub(crate) fn blocks(compared: &Comparison, setting: &Setting) -> Vec<Block> {
    let mut blocks = summary(compared, setting);
    blocks.push(Block::Section {
        id: "where",
        title: "Where it fails",
        blocks: findings(compared, setting.motion),
    });
    blocks.push(Block::Section {
        id: "curves",
        title: "What is missing over each variable",
        blocks: vec![
            Block::In(
                HTML,
                vec![Block::Sentence(
                "Each curve is the torque, voltage or resistance that the model lacks, estimated \
                 from the outputs together with the drive\u{2019}s own parameters; the band holds \
                 95 % of a bootstrap of time blocks. A band that contains zero everywhere shows \
                 nothing missing. One effect shows over several variables, for they move together: \
                 the table above says over which it is told best."
                    .to_owned(),
            )],
            ),
            curves(compared, "curve"),
        ],
    });
    let each = compared.recordings.iter().enumerate();
    let each = each.flat_map(|(place, it)| recording(it, &setting.clocks[place], place));
    blocks.push(Block::Section {
        id: "recordings",
        title: "Each recording",
        blocks: each.collect(),
    });
    blocks.push(Block::Section {
        id: "residual",
        title: "Is the residual white",
        blocks: tables::residuals(compared),
    });
    blocks.push(Block::In(
        HTML,
        vec![Block::Section {
            id: "setting",
            title: "What this rests on",
            blocks: tables::setting(compared, setting),
        }],
    ));
    blocks
}

/// What is to be seen first.
pub(crate) fn summary(compared: &Comparison, setting: &Setting) -> Vec<Block> {
    let (about, words) = (named(&setting.drive), verdict(compared));
    let remark = remark(compared, setting.step);
    vec![Block::Verdict { about, words, remark }, tiles(compared, setting)]
}

/// A stretch of a recording, with the errors on what it is fitted to and on what only judges, as far
/// as the stretch has them.
pub(crate) fn part(compared: &Comparison, errors: &[(&str, f64)]) -> Vec<Block> {
    let each: Vec<String> =
        errors.iter().map(|(of, value)| format!("{} on {of}", error(*value))).collect();
    let mut words = verdict(compared);
    if !each.is_empty() {
        words += &format!(" Its error is {}, in units of the noise.", each.join(" and "));
    }
    let mut blocks = vec![Block::Sentence(words), curves(compared, "within")];
    // A number that no recording of the page has.
    blocks.extend(compared.recordings.first().map(|it| correlations(it, 1000)));
    blocks
}

/// Share of the excess beyond which the values of the parameters are what fails, and not a load beside.
const MOST: f64 = 0.5;

/// The answer in a sentence.
fn verdict(compared: &Comparison) -> String {
    let Some(first) = compared.findings.first() else {
        let words = if explains(compared) {
            "The model explains these recordings down to their noise."
        } else if compared.is_unfitted() && compared.by_parameters > MOST {
            "The model fails by the values of its parameters; beside them it depends on no variable \
             that was tested."
        } else {
            "The error is above the noise, but it depends on no variable that was tested: it \
             looks like a random load."
        };
        return words.to_owned();
    };
    let others: Vec<&str> = compared.findings.iter().skip(1).map(|it| it.variable).collect();
    let also = match others.as_slice() {
        [] => String::new(),
        some => format!(" Then over {}.", some.join(", ")),
    };
    format!("The model fails over {}: {}.{also}", first.variable, first.words)
}

/// The second sentence: what the error is, and what fitting could do.
fn remark(compared: &Comparison, step: Option<OfStep>) -> String {
    let floor = if compared.observer_hz > 0.0 {
        format!("; {} is the floor with the observer", error(compared.floor))
    } else {
        "; 1 is the noise floor".to_owned()
    };
    let own = step.map_or(compared.error, |step| step.estimation_error);
    let on = if step.is_some() { " on what it is fitted to" } else { "" };
    let mut text = format!("Its error{on} is {} in units of the noise{floor}.", error(own));
    // Whoever fitted it to a part need not do so again because the rest would have it otherwise.
    let fitted = step.is_some_and(|step| step.fitted);
    if compared.is_unfitted() && !fitted {
        text += &format!(
            " Its parameters are not those that fit all of these recordings best: others would take \
             {:.0} % of the excess away, to about {}. Fit it to all of them first: what is said here \
             is what they could not explain.",
            100.0 * compared.by_parameters,
            error(compared.error_if_fitted)
        );
    }
    if compared.by_balances && compared.parameters_matter && !fitted {
        text += &format!(
            " Its values are those of least squares on the balances: others would follow the \
             observed motion closer, to about {}, and explain no more of the torque.",
            error(compared.error_if_fitted)
        );
    }
    text
}

/// What is missing over each variable: the variables that were found first, then those whose curve
/// leaves zero out most. The names of the pictures begin with that.
pub(crate) fn curves(compared: &Comparison, id: &str) -> Block {
    let rank = |curve: &Curve| {
        let found = compared.findings.iter().position(|it| {
            it.variable == curve.variable
                || (it.variable == "omega_sign" && curve.variable == "omega")
        });
        let share = pictures::outside(curve) as f64 / curve.x.len().max(1) as f64;
        (found.unwrap_or(usize::MAX), -share)
    };
    let mut order: Vec<usize> = (0..compared.curves.len()).collect();
    order.sort_by(|a, b| {
        let (a, b) = (rank(&compared.curves[*a]), rank(&compared.curves[*b]));
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
    let panel = |number: usize| {
        let curve = &compared.curves[number];
        let figure = pictures::curve(curve, &format!("{id}-{number}"));
        let caption = pictures::caption(curve);
        let data =
            Block::Details { summary: "Data".to_owned(), blocks: vec![tables::curve(curve)] };
        let below = vec![Block::In(PAGE, vec![data])];
        (Picture { plot: Plot::Figure(figure), caption }, below)
    };
    Block::Panels(order.into_iter().map(panel).collect())
}

/// A recording: the model beside it, and when the model fails.
fn recording(it: &RecordingComparison, clock: &Clock, place: usize) -> Vec<Block> {
    let caption = "Measured in the colour of text, model in blue; below, the residual in units of \
                   the noise. Shaded: spans in which the error is above what noise allows."
        .to_owned();
    let plot = Plot::Figure(pictures::recording(it, clock, place));
    let heading = Block::Heading(format!("{}: error {}", it.name, error(it.error)));
    vec![heading, Block::Figure(Picture { plot, caption }), spans(it)]
}

/// When the model fails.
pub(crate) fn spans(it: &RecordingComparison) -> Block {
    if it.spans.is_empty() {
        return Block::In(HTML, vec![Block::Note("No span of time stands out.".to_owned())]);
    }
    let item = |span: &Span| Item {
        key: Some(Key::Span { from: span.from, to: span.to, sentence: span.sentence.clone() }),
        code: false,
        head: span.sentence.clone(),
        note: format!("error {}", error(span.error)),
    };
    Block::List(it.spans.iter().map(item).collect())
}

/// Whether the residual of a recording is white, to be unfolded.
pub(crate) fn whiteness(it: &RecordingComparison, place: usize) -> Block {
    let each = it.outputs.iter().map(|output| {
        let [white, input] = tables::tests(output);
        let input = if input == "yes" { ", it knows the input" } else { "" };
        format!(" {}: {white}{input}.", output.name)
    });
    Block::Details {
        summary: format!("Is the residual white?{}", each.collect::<String>()),
        blocks: vec![correlations(it, place)],
    }
}

/// The residual's correlations.
fn correlations(it: &RecordingComparison, place: usize) -> Block {
    let caption = "Correlation of the residual with itself and with the input; within the bands, \
                   nothing was found."
        .to_owned();
    Block::Figure(Picture { plot: Plot::Figure(pictures::correlations(it, place)), caption })
}
