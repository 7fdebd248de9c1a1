//! The rows of a campaign as the summary takes them: counts of all, details of some.

use drivescope_recording::dataset::{Column, Values};

use super::super::rows::Rows;
use super::naming::Names;
use super::table::Table;

/// Scenarios whose details are kept, at most.
const MOST: u64 = 500_000;
/// Scenarios that are named where something went wrong, at most.
const NAMED: usize = 100;
/// The first column behind what the plan chose.
const FIRST_RESULT: &str = "healthy_time";
/// Columns that say no choice of their own.
const NO_INPUT: [&str; 2] = ["scenario", "status"];

/// What a plan chose, one value a kept scenario.
#[derive(Debug, Clone)]
pub(super) struct Input {
    pub(super) name: String,
    /// The column that it is read from, and the one that it is counted from.
    pub(super) column: String,
    pub(super) onset: Option<String>,
    /// Numbers, or numbers of words.
    pub(super) values: Vec<f64>,
    pub(super) words: Vec<String>,
}

/// A kept scenario.
#[derive(Debug, Clone)]
pub(super) struct Kept {
    pub(super) scenario: u64,
    /// Number of its kind of fault; nothing for health.
    pub(super) kind: Option<usize>,
    /// Magnitude of its first fault.
    pub(super) size: f64,
    pub(super) methods: Vec<Judged>,
}

/// What a method found of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Judged {
    pub(super) detected: Option<bool>,
    pub(super) delay_s: f64,
    pub(super) false_alarms: f64,
    pub(super) outside_healthy: f64,
    pub(super) outside_fault: f64,
}

impl Judged {
    /// Whether the method watched the scenario: a bank that learned no machine does not.
    fn is_judged(&self) -> bool {
        self.false_alarms.is_finite()
    }
}

/// Counts over all scenarios.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Counts {
    pub(super) faulty: usize,
    pub(super) detected: usize,
    pub(super) judged: usize,
    pub(super) silent: usize,
    pub(super) false_alarms: u64,
    /// Judged time before faults, s.
    pub(super) healthy_s: f64,
}

/// All of it.
#[derive(Debug)]
pub(super) struct Gathered {
    pub(super) scenarios: u64,
    pub(super) healthy: u64,
    pub(super) not_finite: Vec<u64>,
    pub(super) aborted: Vec<u64>,
    pub(super) every: u64,
    pub(super) methods: Vec<String>,
    pub(super) counts: Vec<Counts>,
    /// What each method named, if it names faults.
    pub(super) names: Vec<Option<Names>>,
    pub(super) kinds: Vec<String>,
    pub(super) kept: Vec<Kept>,
    pub(super) inputs: Vec<Input>,
}

impl Gathered {
    pub(super) fn new(planned: u64) -> Self {
        Self {
            scenarios: 0,
            healthy: 0,
            not_finite: Vec::new(),
            aborted: Vec::new(),
            every: planned.div_ceil(MOST).max(1),
            methods: Vec::new(),
            counts: Vec::new(),
            names: Vec::new(),
            kinds: Vec::new(),
            kept: Vec::new(),
            inputs: Vec::new(),
        }
    }

    /// Takes some rows.
    pub(super) fn take(&mut self, rows: &Rows) {
        let table = Table::of(&rows.columns);
        if self.methods.is_empty() {
            let names = rows.columns.iter().filter_map(|it| it.name.strip_suffix("_detected"));
            self.methods = names.map(str::to_owned).collect();
            self.counts = vec![Counts::default(); self.methods.len()];
            self.names = self.methods.iter().map(|name| Names::of(name, &table)).collect();
            let chosen = rows.columns.iter().take_while(|it| it.name != FIRST_RESULT);
            let chosen = chosen.filter(|it| !NO_INPUT.contains(&it.name.as_str()));
            let input = |column: &Column| {
                // An end follows its onset: what was chosen is the time between them.
                let onset = column.name.strip_suffix("_end").map(|fault| format!("{fault}_onset"));
                let name = column.name.replace("_end", "_duration");
                let name = if onset.is_some() { name } else { column.name.clone() };
                let column = column.name.clone();
                Input { name, column, onset, values: vec![], words: vec![] }
            };
            self.inputs = chosen.map(input).collect();
        }
        for (k, scenario) in rows.scenarios().iter().enumerate() {
            let scenario = u64::try_from(*scenario).unwrap_or(0);
            self.scenarios += 1;
            let named = match table.text("status", k) {
                "not_finite" => Some(&mut self.not_finite),
                "aborted" => Some(&mut self.aborted),
                _ => None,
            };
            if let Some(named) = named {
                if named.len() < NAMED {
                    named.push(scenario);
                }
                continue;
            }
            self.row(&table, k, scenario);
        }
    }

    fn row(&mut self, table: &Table<'_>, k: usize, scenario: u64) {
        let kind = table.kind(k);
        self.healthy += u64::from(kind.is_none());
        let healthy_s = table.number("healthy_time", k);
        let methods: Vec<Judged> =
            self.methods.iter().map(|name| Judged::of(table, name, k)).collect();
        for (counts, found) in self.counts.iter_mut().zip(&methods) {
            if !found.is_judged() {
                continue;
            }
            counts.healthy_s += healthy_s;
            counts.faulty += usize::from(found.detected.is_some());
            counts.detected += usize::from(found.detected == Some(true));
            counts.judged += 1;
            counts.silent += usize::from(found.false_alarms == 0.0);
            counts.false_alarms += found.false_alarms as u64;
        }
        for names in self.names.iter_mut().flatten() {
            names.take(table, k, kind.as_deref());
        }
        if !scenario.is_multiple_of(self.every) {
            return;
        }
        let kind = kind.map(|kind| number_of(&mut self.kinds, &kind));
        let size = table.number("fault_size", k).abs();
        self.kept.push(Kept { scenario, kind, size, methods });
        for input in &mut self.inputs {
            let since = input.onset.as_ref().map_or(0.0, |onset| table.number(onset, k));
            let value = match table.column(&input.column) {
                Some(Column { values: Values::Texts(words), .. }) => {
                    number_of(&mut input.words, &words[k]) as f64
                }
                _ => table.number(&input.column, k) - since,
            };
            input.values.push(value);
        }
    }
}

/// The number of a word, which is given one if it is new.
fn number_of(words: &mut Vec<String>, word: &str) -> usize {
    words.iter().position(|known| known == word).unwrap_or_else(|| {
        words.push(word.to_owned());
        words.len() - 1
    })
}

impl Judged {
    /// What a method says in row `k`.
    fn of(table: &Table<'_>, method: &str, k: usize) -> Self {
        let number = |what: &str| table.number(&format!("{method}_{what}"), k);
        Self {
            detected: table.flag(&format!("{method}_detected"), k),
            delay_s: number("delay"),
            false_alarms: number("false_alarms"),
            outside_healthy: number("outside_healthy"),
            outside_fault: number("outside_fault"),
        }
    }
}
