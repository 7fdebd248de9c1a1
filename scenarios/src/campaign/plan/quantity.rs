//! What may differ from scenario to scenario: on a grid, or drawn.

use drivescope_numerics::elementary::exp;
use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};

use super::layout::{Given, GivenTable, GivenWords, WordsTable};

/// Values of a regular grid at most.
const MOST_STEPS: u32 = 1_000_000;

/// How a number is chosen.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Law {
    Fixed(f64),
    Grid(Vec<f64>),
    Choice(Vec<f64>),
    Uniform(f64, f64),
    LogUniform(f64, f64),
    Normal { mean: f64, deviation: f64 },
}

/// A number of a plan.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Quantity {
    law: Law,
    either_sign: bool,
    /// Whether it multiplies the value of the drive file.
    pub(super) relative: bool,
}

impl Quantity {
    pub(super) fn fixed(value: f64) -> Self {
        Self { law: Law::Fixed(value), either_sign: false, relative: false }
    }

    /// From what the file says; else what is wrong with it.
    pub(super) fn of(given: &Given) -> Result<Self, String> {
        let table = match given {
            Given::Number(value) if value.is_finite() => return Ok(Self::fixed(*value)),
            Given::Number(value) => return Err(format!("{value} is not a finite number")),
            Given::Table(table) => table,
        };
        Ok(Self { law: law(table)?, either_sign: table.either_sign, relative: table.relative })
    }

    /// Points of the grid that it spans.
    pub(super) fn points(&self) -> u64 {
        match &self.law {
            Law::Grid(values) => values.len() as u64,
            _ => 1,
        }
    }

    /// Whether it has one value in all scenarios.
    pub(super) fn is_fixed(&self) -> bool {
        matches!(self.law, Law::Fixed(_)) && !self.either_sign
    }

    /// Least and greatest value; infinite for a normal distribution.
    pub(super) fn bounds(&self) -> (f64, f64) {
        let (low, high) = match &self.law {
            Law::Fixed(value) => (*value, *value),
            Law::Grid(values) | Law::Choice(values) => {
                let low = values.iter().copied().fold(f64::INFINITY, f64::min);
                (low, values.iter().copied().fold(f64::NEG_INFINITY, f64::max))
            }
            Law::Uniform(low, high) | Law::LogUniform(low, high) => (*low, *high),
            Law::Normal { .. } => (f64::NEG_INFINITY, f64::INFINITY),
        };
        if !self.either_sign {
            return (low, high);
        }
        let most = low.abs().max(high.abs());
        (-most, most)
    }

    /// Its middle, for a check of what a normal distribution is about.
    pub(super) fn middle(&self) -> f64 {
        match self.law {
            Law::Normal { mean, .. } => mean,
            _ => 0.5 * (self.bounds().0 + self.bounds().1),
        }
    }

    /// Its value at a point of its grid; what is drawn lies in the range, from which a normal
    /// distribution is cut off.
    pub(super) fn value(&self, point: u64, random: &mut impl Rng, range: (f64, f64)) -> f64 {
        let value = match &self.law {
            Law::Fixed(value) => *value,
            Law::Grid(values) => values[point as usize],
            Law::Choice(values) => values[random.random_range(0..values.len())],
            Law::Uniform(low, high) => low + (high - low) * random.random::<f64>(),
            Law::LogUniform(low, high) => low * exp((high / low).ln() * random.random::<f64>()),
            Law::Normal { mean, deviation } => normal(*mean, *deviation, random, range),
        };
        if self.either_sign && random.random::<bool>() { -value } else { value }
    }
}

/// A normal number within the range: drawn anew where it lies outside, and the mean after a hundred
/// draws (the plan was refused if its mean lies outside).
fn normal(mean: f64, deviation: f64, random: &mut impl Rng, (low, high): (f64, f64)) -> f64 {
    for _ in 0..100 {
        let standard: f64 = StandardNormal.sample(random);
        let value = mean + deviation * standard;
        if low <= value && value <= high {
            return value;
        }
    }
    mean
}

fn law(table: &GivenTable) -> Result<Law, String> {
    let list = |values: &Vec<f64>| match values.as_slice() {
        [] => Err("its list is empty: give at least one value".to_owned()),
        some if some.iter().all(|value| value.is_finite()) => Ok(some.to_vec()),
        _ => Err("its list holds a value that is no finite number".to_owned()),
    };
    let range = |[low, high]: [f64; 2]| {
        if low.is_finite() && high.is_finite() && low < high {
            Ok((low, high))
        } else {
            Err(format!("the range from {low} to {high} is empty: give the lower end first"))
        }
    };
    let mut found = Vec::new();
    if let Some(values) = &table.grid {
        found.push(list(values).map(Law::Grid));
    }
    if table.from.is_some() || table.to.is_some() || table.steps.is_some() {
        found.push(steps(table).map(Law::Grid));
    }
    if let Some(values) = &table.choice {
        found.push(list(values).map(Law::Choice));
    }
    if let Some(ends) = table.uniform {
        found.push(range(ends).map(|(low, high)| Law::Uniform(low, high)));
    }
    if let Some(ends) = table.log_uniform {
        found.push(range(ends).and_then(|(low, high)| match low > 0.0 {
            true => Ok(Law::LogUniform(low, high)),
            false => Err(format!("a logarithm needs values above 0, not {low}")),
        }));
    }
    if let Some([mean, deviation]) = table.normal {
        found.push(match mean.is_finite() && deviation.is_finite() && deviation > 0.0 {
            true => Ok(Law::Normal { mean, deviation }),
            false => {
                Err(format!("normal = [{mean}, {deviation}]: give a mean and a deviation above 0"))
            }
        });
    }
    if table.logarithmic && table.from.is_none() {
        return Err("`logarithmic` goes with `from`, `to` and `steps`".to_owned());
    }
    match found.len() {
        1 => found.swap_remove(0),
        0 => Err(format!("it says no value: give one of {WAYS}")),
        _ => Err(format!("it says its value twice: give one of {WAYS}")),
    }
}

const WAYS: &str = "grid, from with to and steps, choice, uniform, log_uniform, normal";

fn steps(table: &GivenTable) -> Result<Vec<f64>, String> {
    let (Some(from), Some(to), Some(steps)) = (table.from, table.to, table.steps) else {
        return Err("a regular grid takes `from`, `to` and `steps`".to_owned());
    };
    if !(from.is_finite() && to.is_finite() && from < to) {
        return Err(format!("the range from {from} to {to} is empty: give the lower end first"));
    }
    if !(2..=MOST_STEPS).contains(&steps) {
        return Err(format!("`steps` = {steps}: give 2 to {MOST_STEPS}"));
    }
    if table.logarithmic && from <= 0.0 {
        return Err(format!("a logarithm needs values above 0, not {from}"));
    }
    let at = |k: u32| {
        let share = f64::from(k) / f64::from(steps - 1);
        if table.logarithmic { from * (to / from).powf(share) } else { from + (to - from) * share }
    };
    Ok((0..steps).map(at).collect())
}

/// A word of a plan, as what it stands for.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Words<T> {
    values: Vec<T>,
    grid: bool,
}

impl<T: Clone> Words<T> {
    pub(super) fn fixed(value: T) -> Self {
        Self { values: vec![value], grid: false }
    }

    /// From what the file says, each word read by `parse`; else what is wrong.
    pub(super) fn of<E>(
        given: &GivenWords,
        parse: impl Fn(&str) -> Result<T, E>,
    ) -> Result<Result<Self, E>, String> {
        let (words, grid) = match given {
            GivenWords::Word(word) => (std::slice::from_ref(word), false),
            GivenWords::Table(WordsTable { grid: Some(words), choice: None }) => (&words[..], true),
            GivenWords::Table(WordsTable { grid: None, choice: Some(words) }) => {
                (&words[..], false)
            }
            GivenWords::Table(_) => return Err("give one of grid and choice".to_owned()),
        };
        if words.is_empty() {
            return Err("its list is empty: give at least one word".to_owned());
        }
        let values = words.iter().map(|word| parse(word)).collect::<Result<Vec<T>, E>>();
        Ok(values.map(|values| Self { values, grid }))
    }

    pub(super) fn points(&self) -> u64 {
        if self.grid { self.values.len() as u64 } else { 1 }
    }

    pub(super) fn values(&self) -> &[T] {
        &self.values
    }

    pub(super) fn value(&self, point: u64, random: &mut impl Rng) -> &T {
        match (self.grid, self.values.len()) {
            (true, _) => &self.values[point as usize],
            (false, 1) => &self.values[0],
            (false, n) => &self.values[random.random_range(0..n)],
        }
    }
}
