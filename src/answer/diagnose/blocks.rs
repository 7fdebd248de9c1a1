//! A diagnosis in blocks: the verdict, what was declared, and what every method says.

use drivescope_monitor::{Declared, Found};

use super::{Answer, BaselineAnswer, words};
use crate::answer::block::{Align, Block, Column, Table};
use crate::report::words::percent;

impl Answer {
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
        let columns = vec![
            Column::new(Align::Number, "From [s]"),
            Column::new(Align::Number, "To [s]"),
            Column::new(Align::Number, "Noticed [s]"),
            Column::new(Align::Words, "Mechanism and size, 95 % interval"),
            Column::new(Align::Words, "It cannot be told from"),
        ];
        let mut table = Table::new("Declared faults", columns);
        let at = |time: f64| format!("{time:.3}");
        for it in &self.declarations {
            table.push(vec![
                at(it.from).into(),
                it.to.map_or("stands".to_owned(), at).into(),
                at(it.noticed).into(),
                words::alone(it).into(),
                words::others(it).join(", ").into(),
            ]);
        }
        Block::Table(table)
    }

    /// What every method says.
    fn methods(&self) -> Block {
        let columns = vec![
            Column::new(Align::Name, "Method"),
            Column::new(Align::Name, "Verdict"),
            Column::new(Align::Number, "Values judged"),
            Column::new(Align::Number, "Outside"),
            Column::new(Align::Number, "Outside in health"),
            Column::new(Align::Words, "Declared at"),
        ];
        let mut table = Table::new("Every method", columns);
        let share =
            |share: Option<f64>| share.map_or("-".to_owned(), |it| format!("{} %", percent(it, 2)));
        for it in &self.methods {
            table.push(vec![
                it.method.label().into(),
                it.verdict.replace('_', " ").into(),
                it.judged.to_string().into(),
                share(it.exceedance_rate).into(),
                share(it.beta).into(),
                declared(it).into(),
            ]);
        }
        Block::Table(table)
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
