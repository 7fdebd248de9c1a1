//! The rows of a campaign: one a scenario, in plain columns.

use drivescope_recording::dataset::{Column, Values};

use super::bank::{BankFound, Named};
use super::block::{Found, Outcome};
use super::columns::{STATUS, columns};
use super::plan::{Method, Plan, Scenario};

/// How a scenario ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Status {
    /// All its samples were simulated and judged.
    Done,
    /// Its state grew without bound.
    NotFinite,
    /// It ended the process that ran it, or a foreign FMU gave no result.
    Aborted,
}

impl Status {
    fn word(self) -> &'static str {
        match self {
            Self::Done => "done",
            Self::NotFinite => "not_finite",
            Self::Aborted => "aborted",
        }
    }
}

/// Rows of some scenarios, in the order of their numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Rows {
    /// The columns, of one length.
    pub columns: Vec<Column>,
}

impl Rows {
    /// No rows of that plan: the columns alone.
    pub fn none(plan: &Plan) -> Self {
        Self { columns: columns(plan) }
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.columns.first().map_or(0, |column| column.values.len())
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Adds the rows of later scenarios of the same plan; false where the columns differ.
    #[must_use]
    pub fn append(&mut self, more: Self) -> bool {
        let same = self.columns.len() == more.columns.len()
            && self.columns.iter().zip(&more.columns).all(|(a, b)| a.name == b.name);
        same && self.columns.iter_mut().zip(more.columns).all(|(a, b)| a.values.append(b.values))
    }

    /// Takes the first rows away.
    pub(super) fn split_front(&mut self, rows: usize) -> Self {
        let columns = self
            .columns
            .iter_mut()
            .map(|column| Column { values: column.values.split_front(rows), ..column.clone() });
        Self { columns: columns.collect() }
    }

    /// Numbers of the scenarios.
    pub fn scenarios(&self) -> &[i64] {
        match self.columns.first().map(|column| &column.values) {
            Some(Values::Integers(numbers)) => numbers,
            _ => &[],
        }
    }

    /// Scenarios that ended the process, or the thread, that ran them.
    pub fn aborted(&self) -> Vec<u64> {
        let status = self.columns.iter().find(|column| column.name == STATUS);
        let Some(Column { values: Values::Texts(words), .. }) = status else { return Vec::new() };
        let rows = self.scenarios().iter().zip(words);
        let aborted = rows.filter(|(_, word)| *word == Status::Aborted.word());
        aborted.filter_map(|(scenario, _)| u64::try_from(*scenario).ok()).collect()
    }

    /// Adds the row of one scenario: what became of it, or why there is no result.
    pub(super) fn push(
        &mut self,
        plan: &Plan,
        scenario: &Scenario,
        outcome: Result<&Outcome, &str>,
    ) {
        let status = match outcome {
            Ok(outcome) if outcome.finite => Status::Done,
            Ok(_) => Status::NotFinite,
            Err(_) => Status::Aborted,
        };
        let judged = outcome.ok().filter(|it| it.finite);
        let period_s = plan.experiment.period_s;
        let mut row = Row { columns: &mut self.columns, at: 0 };
        row.integer(scenario.index);
        row.text(status.word());
        if plan.foreign.is_some() {
            row.text(outcome.err().unwrap_or("none"));
        }
        row.number(scenario.set_point);
        if plan.has_noise_seed() {
            row.integer(scenario.noise_seed.unwrap_or(0));
        }
        scenario.parameters.iter().for_each(|value| row.number(*value));
        for fault in &scenario.faults {
            row.text(fault.map_or("none", |it| it.kind()));
            row.number(fault.map_or(f64::NAN, |it| it.size));
            row.number(fault.map_or(f64::NAN, |it| it.from as f64 * period_s));
            row.number(fault.map_or(f64::NAN, |it| it.until as f64 * period_s));
            row.text(&fault.map_or_else(|| "none".to_owned(), |it| it.profile.to_string()));
        }
        let settings = scenario.settings;
        row.number(settings.beta);
        row.integer(settings.window);
        row.number(settings.arl_0);
        row.number(settings.kappa);
        let samples = plan.samples as u64;
        let (from, until) = scenario
            .faulty()
            .map_or((samples, samples), |(from, until)| (from as u64, until as u64));
        let healthy = from.saturating_sub(plan.run_up as u64);
        row.number(healthy as f64 * period_s);
        if plan.tests_residual() {
            row.number(judged.map_or(f64::NAN, |it| it.residual));
        }
        let faulty = from < samples;
        for (number, method) in plan.methods.iter().enumerate() {
            let bank = judged.and_then(|it| it.bank.as_ref()).filter(|_| *method == Method::Bank);
            // A bank that learned no machine judges nothing.
            let judges = bank.is_none_or(|bank| bank.refused.is_none());
            let found = judged.filter(|_| judges).map(|it| it.found[number]);
            let [in_health, in_fault] = bank.map_or([healthy, until - from], |bank| bank.measured);
            let of = |value: &dyn Fn(&Found) -> f64| found.as_ref().map_or(f64::NAN, value);
            let share = |outside: u64, of: u64| {
                if of > 0 { outside as f64 / of as f64 } else { f64::NAN }
            };
            row.flag(found.filter(|_| faulty).map(|it| it.t_dt.is_some()));
            let t_dt = found.and_then(|it| it.t_dt).map(|it| it as f64);
            row.number(t_dt.map_or(f64::NAN, |it| it * period_s));
            row.number(t_dt.map_or(f64::NAN, |it| (it - from as f64) * period_s));
            row.number(of(&|it| it.false_alarms as f64));
            row.number(of(&|it| share(it.outside_healthy, in_health)));
            row.number(of(&|it| {
                if faulty { share(it.outside_fault, in_fault) } else { f64::NAN }
            }));
            if *method == Method::Bank {
                row.bank(bank, scenario);
            }
        }
    }
}

/// The row that is being written, column by column.
struct Row<'a> {
    columns: &'a mut [Column],
    at: usize,
}

impl Row<'_> {
    fn next(&mut self) -> Option<&mut Values> {
        self.at += 1;
        self.columns.get_mut(self.at - 1).map(|column| &mut column.values)
    }

    fn integer(&mut self, value: u64) {
        if let Some(Values::Integers(values)) = self.next() {
            values.push(i64::try_from(value).unwrap_or(i64::MAX));
        }
    }

    fn number(&mut self, value: f64) {
        if let Some(Values::Numbers(values)) = self.next() {
            values.push(value);
        }
    }

    fn flag(&mut self, value: Option<bool>) {
        if let Some(Values::Flags(values)) = self.next() {
            values.push(value);
        }
    }

    /// What a bank says beside; nothing is known of a scenario without result.
    fn bank(&mut self, found: Option<&BankFound>, scenario: &Scenario) {
        let named = found.and_then(|it| it.named.as_ref());
        self.text(found.map_or("none", BankFound::baseline));
        self.text(found.map_or("none", BankFound::told));
        let set = named.map(|it| it.set.join(" ")).filter(|set| !set.is_empty());
        self.text(set.as_deref().unwrap_or("none"));
        let acted = |named: &Named| -> Vec<&str> {
            let faults = scenario.faults.iter().flatten();
            faults.filter(|it| it.from as u64 <= named.sample).map(|it| it.kind()).collect()
        };
        let truth = named.map(|named| (named, acted(named))).filter(|(_, kinds)| !kinds.is_empty());
        self.flag(truth.map(|(named, kinds)| named.set.iter().any(|id| kinds.contains(&&**id))));
        let [size, low, high] = named.and_then(|it| it.size).unwrap_or([f64::NAN; 3]);
        [size, low, high].into_iter().for_each(|it| self.number(it));
    }

    fn text(&mut self, value: &str) {
        if let Some(Values::Texts(values)) = self.next() {
            values.push(value.to_owned());
        }
    }
}
