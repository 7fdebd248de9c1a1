//! A diagnosis in blocks: the verdict, what was declared, and what every method says.

use drivescope_monitor::{Declaration, Declared, Found};

use super::{BaselineAnswer, DiagnoseAnswer, words};
use crate::answer::block::{Align, Block, Cell, Column, Said, Table};
use crate::report::words::percent;

impl DiagnoseAnswer {
    /// The answer for a terminal: the verdict where the eye is when the program ends.
    pub(crate) fn blocks(&self) -> Vec<Block> {
        let samples = format!("{}: {} samples", self.recording, self.samples);
        let mut blocks = vec![Block::Sentence(samples)];
        blocks.extend(self.rests_on());
        blocks.push(self.methods());
        blocks.push(self.declarations());
        blocks.push(self.verdict());
        blocks
    }

    /// The answer for the page, with the figure of the recording behind the verdict.
    pub(crate) fn with_figure(&self, figure: Option<Block>) -> Vec<Block> {
        let mut blocks = vec![self.verdict()];
        blocks.extend(figure);
        blocks.extend(self.rests_on());
        blocks.push(self.declarations());
        blocks.push(self.methods());
        blocks
    }

    /// The answer in a sentence.
    fn verdict(&self) -> Block {
        let last = self.declarations.last();
        let since = last.map(|it| format!("since {:.3} s: {}", it.from, words::what(it)));
        let count = self.declarations.len();
        let verdict = match (self.verdict, since) {
            ("fault", Some(since)) if count == 1 => format!("fault {since}"),
            ("fault", Some(since)) => format!("fault: {count} declared, the last {since}"),
            ("abnormal", _) => "abnormal: far more lies outside than in health".to_owned(),
            (other, _) => other.replace('_', " "),
        };
        let named = self.fault.as_ref();
        let named = named.map(|fault| format!("known as {}", words::fault(fault)));
        let remarks: Vec<String> = self.why.clone().into_iter().chain(named).collect();
        Block::Verdict {
            about: format!("verdict ({})", self.method.label()),
            words: verdict,
            remark: remarks.join("; "),
        }
    }

    /// What the machine was learned from, and what was not judged.
    fn rests_on(&self) -> Vec<Block> {
        let learned = self.baseline.as_ref().map(|it| {
            let BaselineAnswer { recording, samples, machine } = it;
            let differs: Vec<String> =
                machine.iter().map(|(name, by)| format!("{name} {:+.1} %", 100.0 * by)).collect();
            let differs = differs.join(", ");
            Block::Note(format!("machine learned from {samples} samples of {recording}: {differs}"))
        });
        let beyond = (self.beyond_range > 0).then(|| {
            Block::Note(format!(
                "{} samples at operating points that were never shown: not judged there, but by \
                 the bank",
                self.beyond_range
            ))
        });
        learned.into_iter().chain(beyond).collect()
    }

    /// What was declared by the method that was asked for.
    fn declarations(&self) -> Block {
        fn at(time: f64) -> String {
            format!("{time:.3}")
        }
        let number = |heading| Column::new(Align::Number, heading);
        let sentence = |heading| Column::new(Align::Words, heading);
        let columns: &[(Column, Said<&Declaration>)] = &[
            (number("From [s]"), |it| at(it.from).into()),
            (number("To [s]"), |it| it.to.map_or("stands".to_owned(), at).into()),
            (number("Noticed [s]"), |it| at(it.noticed).into()),
            (sentence("Mechanism and size, 95 % interval"), |it| words::alone(it).into()),
            (sentence("It cannot be told from"), |it| words::others(it).join(", ").into()),
        ];
        Block::Table(Table::of("Declared faults", columns, &self.declarations))
    }

    /// What every method says.
    fn methods(&self) -> Block {
        fn share(share: Option<f64>) -> Cell {
            share.map_or("-".to_owned(), |it| format!("{} %", percent(it, 2))).into()
        }
        let name = |heading| Column::new(Align::Name, heading);
        let number = |heading| Column::new(Align::Number, heading);
        let columns: &[(Column, Said<&Found>)] = &[
            (name("Method"), |it| it.method.label().into()),
            (name("Verdict"), |it| it.verdict.replace('_', " ").into()),
            (number("Values judged"), |it| it.judged.to_string().into()),
            (number("Outside"), |it| share(it.exceedance_rate)),
            (number("Outside in health"), |it| share(it.beta)),
            (Column::new(Align::Words, "Declared at"), |it| declared(it).into()),
        ];
        Block::Table(Table::of("Every method", columns, &self.methods))
    }
}

/// When a method declared a fault.
fn declared(found: &Found) -> String {
    let at = |it: &Declared| format!("{:.3} s (sample {})", it.time, it.sample);
    let times: Vec<String> = found.declared.iter().map(at).collect();
    let earlier = match found.dropped {
        0 => String::new(),
        more => format!(", and {more} times before"),
    };
    times.join(", ") + &earlier
}
