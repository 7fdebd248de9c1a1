//! The bank at work, a row at a time, in fixed memory.
//!
//! ```text
//! watching -- a statistic above its limit --> gathering -- horizon rows after the onset --> judged
//!    ^                                                                                        |
//!    +--- the named fault acts in the process from now on: its end is the next change --------+
//! ```

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

use super::frozen::Frozen;
use super::hypothesis::Case;
use super::judge::{Cause, Judgement, TWO_SIDED_95};
use super::named::Named;
use super::onsets::{OLDEST, Onsets};
use super::process::{Belief, Process, Row, SENSORS};
use super::squares::Squares;
use crate::memory::{Memory, MemoryError, Walk};

/// Rows that are kept beyond those of an alarm's oldest onset: a fault that grows began before it,
/// and is weighed again with the rows that follow its name.
const BEFORE: usize = 256;

/// Limits of the statistics, designed for a mean time between false alarms.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    /// Of the generalised likelihood ratio over mechanism and onset, and of stuck sensors.
    pub ratio: f64,
    /// Of the cumulative sum of squares.
    pub squares: f64,
}

/// What an alarm rests on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Symptom {
    /// The innovations look like those of this mechanism.
    Mechanism(usize),
    /// A sensor repeats itself.
    Frozen(usize),
    /// The innovations are larger than the process makes them.
    Excess,
}

/// A statistic went over its limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Alarm {
    /// Sample at which it did.
    pub sample: usize,
    /// First sample that contributed.
    pub onset: usize,
    /// What it rests on; the judgement that follows may name something else.
    pub symptom: Symptom,
}

/// What a row brought.
#[derive(Debug, Clone, PartialEq)]
pub enum Event {
    /// Something changed.
    Alarm(Alarm),
    Judged(Judgement),
    /// What was unknown, or a stuck sensor, is over; the last sample of it.
    Ended(usize),
}

/// The statistics of a row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Statistics {
    /// Of the likeliest mechanism and onset, or of a stuck sensor.
    pub ratio: f64,
    /// Of the likeliest mechanism and onset alone.
    pub mechanisms: f64,
    /// Cumulative sum of squares.
    pub squares: f64,
    /// Sensors that showed something.
    pub measured: usize,
    /// Of these, outside their 95 % band.
    pub outside: usize,
    /// What each sensor showed less what was predicted, in standard deviations; 0 where it showed
    /// nothing.
    pub innovation: [f64; SENSORS],
}

#[derive(Debug, Clone, Copy)]
enum Mode {
    Watching,
    Gathering {
        onset: usize,
    },
    /// The sensor shows this value since it is stuck.
    Stuck {
        sensor: usize,
        value: f64,
    },
    /// Something unknown was last heard of at that sample.
    Holding {
        last: usize,
    },
}

/// A bank that watches one machine.
#[derive(Debug, Clone)]
pub struct Watch<const N: usize, P> {
    healthy: P,
    /// The process as it acts: healthy, or with the fault that was named.
    acting: P,
    /// The fault that acts in it: mechanism and size.
    fault: Option<(usize, f64)>,
    /// It followed health: its rows, by the numbers of their samples.
    named: Option<Named>,
    belief: Belief<N>,
    limits: Limits,
    horizon: usize,
    onsets: Onsets<N>,
    frozen: Frozen,
    squares: Squares,
    /// The last rows, each with the belief before it.
    kept: VecDeque<(Belief<N>, Row)>,
    now: usize,
    mode: Mode,
    statistics: Statistics,
}

impl<const N: usize, P: Process<N>> Watch<N, P> {
    /// A bank over a process whose machine was learned; judgements rest on `horizon` rows from the
    /// onset on.
    pub(crate) fn new(process: P, belief: Belief<N>, limits: Limits, horizon: usize) -> Self {
        let onsets = Onsets::new(process.mechanisms(), N - process.learned().len());
        Self {
            acting: process.clone(),
            healthy: process,
            fault: None,
            named: None,
            belief,
            limits,
            horizon,
            onsets,
            frozen: Frozen::new(),
            squares: Squares::default(),
            kept: VecDeque::with_capacity(BEFORE + OLDEST.max(horizon) + 1),
            now: 0,
            mode: Mode::Watching,
            statistics: Statistics {
                ratio: 0.0,
                mechanisms: 0.0,
                squares: 0.0,
                measured: 0,
                outside: 0,
                innovation: [0.0; SENSORS],
            },
        }
    }

    /// A watch over a process of whose machine nothing was learned: one that another's memory is
    /// restored into.
    pub fn unlearned(process: P, limits: Limits, horizon: usize) -> Self {
        let belief = process.begin(&Row::NOTHING);
        Self::new(process, belief, limits, horizon)
    }

    /// The process without a fault, with the machine that was learned.
    pub fn process(&self) -> &P {
        &self.healthy
    }

    /// What is known of the state before the next row.
    pub fn belief(&self) -> &Belief<N> {
        &self.belief
    }

    /// The statistics of the last row.
    pub fn statistics(&self) -> Statistics {
        self.statistics
    }

    /// The same bank with other limits.
    #[must_use]
    pub fn with_limits(mut self, limits: Limits) -> Self {
        self.limits = limits;
        self
    }

    /// Rows that a judgement rests on.
    pub(super) fn horizon(&self) -> usize {
        self.horizon
    }

    /// After a gap: the state is unknown, the machine is the same. The sample number goes on.
    pub fn resume(&mut self, row: &Row) {
        let fresh = self.acting.begin(row);
        let moving = N - self.healthy.learned().len();
        for r in 0..N {
            if r < moving {
                self.belief.mean[r] = fresh.mean[r];
            }
            for c in 0..N {
                if r.min(c) < moving {
                    self.belief.covariance[r][c] = fresh.covariance[r][c];
                }
            }
        }
        self.forget();
        if let Mode::Gathering { .. } = self.mode {
            self.mode = Mode::Watching;
        }
    }

    fn forget(&mut self) {
        self.forget_statistics();
        self.named = None;
        self.kept.clear();
    }

    fn forget_statistics(&mut self) {
        self.onsets.clear();
        self.frozen = Frozen::new();
        self.squares = Squares::default();
    }

    /// Rows that are kept at most.
    fn most_kept(&self) -> usize {
        BEFORE + OLDEST.max(self.horizon)
    }

    /// Takes in a row.
    #[inline]
    pub fn step(&mut self, row: &Row) -> Option<Event> {
        let mut row = *row;
        if let Mode::Stuck { sensor, value } = self.mode {
            if row.shown[sensor] != value {
                self.mode = Mode::Watching;
                let ended = Event::Ended(self.now.saturating_sub(1));
                self.resume(&row);
                self.take_in(&row);
                return Some(ended);
            }
            row.shown[sensor] = f64::NAN;
        }
        self.take_in(&row);
        let now = self.now - 1;
        match self.mode {
            Mode::Watching | Mode::Stuck { .. } => {
                let alarm = self.alarm(now)?;
                self.mode = Mode::Gathering { onset: alarm.onset };
                Some(Event::Alarm(alarm))
            }
            Mode::Gathering { onset } if self.now >= onset + self.horizon => {
                Some(Event::Judged(self.judged(onset)))
            }
            Mode::Gathering { .. } => None,
            Mode::Holding { last } => self.hold(now, last),
        }
    }

    /// Filters a row and brings the statistics up to it.
    #[inline]
    fn take_in(&mut self, row: &Row) {
        if self.kept.len() == self.most_kept() {
            self.kept.pop_front();
        }
        self.kept.push_back((self.belief, *row));
        let sensed = self.acting.sense(&self.belief.mean, row);
        let correction = self.belief.correct(&sensed, row);
        let advanced = self.acting.advance(&self.belief, row);
        self.onsets.open(self.now);
        self.onsets.step(&sensed, &correction, &advanced);
        self.frozen.step(self.now, row, &correction, &self.acting.quanta());
        self.squares.step(self.now, &correction);
        self.belief = self.belief.moved(&advanced);
        self.now += 1;
        let mechanisms = self.onsets.peak().map_or(0.0, |peak| peak.ratio);
        self.statistics = Statistics {
            ratio: mechanisms.max(self.frozen.peak().0),
            mechanisms,
            squares: self.squares.ratio,
            measured: correction.measured(),
            outside: correction.innovation.iter().filter(|w| w.abs() > TWO_SIDED_95).count(),
            innovation: correction.innovation,
        };
    }

    fn alarm(&self, sample: usize) -> Option<Alarm> {
        let Statistics { ratio, squares, .. } = self.statistics;
        if ratio <= self.limits.ratio && squares <= self.limits.squares {
            return None;
        }
        let (stuck, sensor, since) = self.frozen.peak();
        let peak = self.onsets.peak();
        let (symptom, onset) = if stuck > self.limits.ratio {
            (Symptom::Frozen(sensor), since)
        } else if let Some(peak) = peak.filter(|peak| peak.ratio > self.limits.ratio) {
            (Symptom::Mechanism(peak.mechanism), peak.onset)
        } else {
            (Symptom::Excess, self.squares.onset)
        };
        let first = self.now - self.kept.len();
        Some(Alarm { sample, onset: onset.max(first), symptom })
    }

    /// Judges what was gathered and goes on under what is named.
    fn judged(&mut self, onset: usize) -> Judgement {
        let first = self.now - self.kept.len();
        let kept: &[_] = self.kept.make_contiguous();
        // Of what began before the rows that are kept nothing new is told.
        let named = self.named.filter(|named| named.onset >= first);
        let named = named.map(|named| named.counted(|sample| sample - first)).unwrap_or_default();
        let case = Case::new((&self.healthy, &self.acting), self.fault, kept, named);
        let judged = case.judge(onset.saturating_sub(first), first);
        let last = kept.last().map_or(Row::NOTHING, |(_, row)| *row);
        self.belief = judged.end;
        self.fault = None;
        self.mode = Mode::Watching;
        match judged.named {
            Some(named) => {
                self.forget_statistics();
                self.named = Some(named.counted(|row| first + row));
            }
            None => self.forget(),
        }
        match judged.judgement.cause {
            Cause::Healthy => {}
            Cause::Mechanism(mechanism) => {
                let named = judged.judgement.candidates.first();
                self.fault = named.map(|of| (mechanism, of.size));
            }
            Cause::Frozen(sensor) => {
                self.mode = Mode::Stuck { sensor, value: last.shown[sensor] };
            }
            Cause::Unknown => self.mode = Mode::Holding { last: self.now },
        }
        self.acting = self.process_under(self.fault);
        judged.judgement
    }

    /// The process under that fault.
    fn process_under(&self, fault: Option<(usize, f64)>) -> P {
        let healthy = || self.healthy.clone();
        fault.map_or_else(healthy, |(mechanism, size)| self.healthy.with_fault(mechanism, size))
    }

    /// Waits until nothing is heard of the unknown for a horizon.
    fn hold(&mut self, now: usize, last: usize) -> Option<Event> {
        if self.alarm(now).is_some() {
            self.mode = Mode::Holding { last: now };
            self.onsets.clear();
            self.squares = Squares::default();
        } else if now >= last + self.horizon {
            self.mode = Mode::Watching;
            return Some(Event::Ended(last));
        }
        None
    }
}

impl Mode {
    /// Its number, and what it holds.
    fn parts(self) -> (usize, usize, f64) {
        match self {
            Self::Watching => (0, 0, 0.0),
            Self::Gathering { onset } => (1, onset, 0.0),
            Self::Stuck { sensor, value } => (2, sensor, value),
            Self::Holding { last } => (3, last, 0.0),
        }
    }
}

impl Memory for Mode {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        let (mut number, mut sample, mut value) = self.parts();
        walk.each([&mut number, &mut sample])?;
        value.walk(walk)?;
        *self = match number {
            0 => Self::Watching,
            1 => Self::Gathering { onset: sample },
            2 if sample < SENSORS => Self::Stuck { sensor: sample, value },
            3 => Self::Holding { last: sample },
            _ => return Err(MemoryError),
        };
        Ok(())
    }
}

impl Memory for Statistics {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        walk.each([&mut self.ratio, &mut self.mechanisms, &mut self.squares])?;
        walk.each([&mut self.measured, &mut self.outside])?;
        self.innovation.walk(walk)
    }
}

impl<const N: usize, P: Process<N>> Memory for Watch<N, P> {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        self.healthy.walk_machine(walk)?;
        walk.maybe(&mut self.fault, || (0, 0.0))?;
        walk.maybe(&mut self.named, Named::default)?;
        if self.fault.is_some_and(|(j, _)| j >= self.healthy.mechanisms().len()) {
            return Err(MemoryError);
        }
        if walk.restores() {
            self.acting = self.process_under(self.fault);
        }
        self.belief.walk(walk)?;
        self.onsets.walk(walk)?;
        self.frozen.walk(walk)?;
        self.squares.walk(walk)?;
        let most = self.most_kept();
        let blank = (self.belief, Row::NOTHING);
        walk.list(&mut self.kept, most, || blank)?;
        self.now.walk(walk)?;
        let is_ordered =
            |it: Named| it.onset <= it.healthy && it.healthy <= it.since && it.since <= self.now;
        if self.now < self.kept.len() || !self.named.is_none_or(is_ordered) {
            return Err(MemoryError);
        }
        self.mode.walk(walk)?;
        let kept = self.now - self.kept.len()..=self.now;
        if let Mode::Gathering { onset } = self.mode
            && !kept.contains(&onset)
        {
            return Err(MemoryError);
        }
        if self.onsets.latest().is_some_and(|sample| sample > self.now) {
            return Err(MemoryError);
        }
        self.statistics.walk(walk)
    }
}
