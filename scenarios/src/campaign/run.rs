//! Runs scenarios of a plan: rayon over blocks of lanes.

use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};

use drivescope_recording::Recording;
use rayon::prelude::*;

use super::block::{Blocks, LANES};
use super::design::Design;
use super::plan::Plan;
use super::rows::Rows;
use crate::cosimulated::RunError;

/// Scenarios that a thread takes at once: some blocks, so that those that stand alone balance.
const TASK: u64 = 4 * LANES as u64;

/// Scenarios of a part, as runs split a campaign: a second's work or less.
pub const PART: u64 = 2048;

/// Scenarios of a foreign FMU that a thread takes at once: each is heard of when it is over.
const TASK_OF_FOREIGN: u64 = 1;

/// Why a scenario has no result that did not say.
const ENDED: &str = "it ended the process that ran it";

/// A plan with its detectors.
#[derive(Debug)]
pub struct Campaign {
    plan: Plan,
    design: Design,
    design_digest: String,
}

impl Campaign {
    /// A campaign of that plan with detectors that were designed for it.
    pub fn new(plan: Plan, design: Design) -> Self {
        let design_digest = design.digest();
        Self { plan, design, design_digest }
    }

    /// Its plan.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Its detectors.
    pub fn design(&self) -> &Design {
        &self.design
    }

    /// Digest of its detectors.
    pub fn design_digest(&self) -> &str {
        &self.design_digest
    }

    /// Runs the scenarios of a range, in parallel; nothing where `stop` answers true, which is asked
    /// after each few of them (each one of a foreign FMU) with the number that was done.
    ///
    /// # Panics
    /// If the range reaches beyond the plan's scenarios (an error of the calling code).
    pub fn run(&self, range: Range<u64>, stop: &(dyn Fn(u64) -> bool + Sync)) -> Option<Rows> {
        assert!(range.end <= self.plan.scenarios(), "{} scenarios", self.plan.scenarios());
        let blocks = Blocks::new(&self.plan, &self.design);
        let task = if self.plan.foreign.is_some() { TASK_OF_FOREIGN } else { TASK };
        let tasks: Vec<u64> = range.clone().step_by(task as usize).collect();
        let done: Option<Vec<Rows>> = tasks
            .into_par_iter()
            .map(|first| {
                let last = (first + task).min(range.end);
                let rows = self.some_of(&blocks, first..last);
                (!stop(last - first)).then_some(rows)
            })
            .collect();
        let mut rows = Rows::none(&self.plan);
        for more in done? {
            let _ = rows.append(more);
        }
        Some(rows)
    }

    /// The rows of some scenarios; where one of them panics, each alone, that one without result.
    fn some_of(&self, blocks: &Blocks<'_>, range: Range<u64>) -> Rows {
        let tried = |range: Range<u64>| {
            // Nothing is shared but what is only read.
            catch_unwind(AssertUnwindSafe(|| self.some(blocks, range)))
        };
        tried(range.clone()).unwrap_or_else(|_| {
            let mut rows = Rows::none(&self.plan);
            for one in range {
                let _ = rows.append(tried(one..one + 1).unwrap_or_else(|_| self.aborted(one)));
            }
            rows
        })
    }

    fn some(&self, blocks: &Blocks<'_>, range: Range<u64>) -> Rows {
        drill::fault(&range);
        let ready: Vec<_> = range.map(|index| blocks.ready(index)).collect();
        let outcomes = blocks.run(&ready);
        let mut rows = Rows::none(&self.plan);
        for (ready, outcome) in ready.iter().zip(&outcomes) {
            rows.push(&self.plan, ready.scenario(), outcome.as_ref().map_err(String::as_str));
        }
        rows
    }

    /// The signals of a scenario, the same bits as its row was made from.
    ///
    /// # Errors
    /// A foreign FMU gave none.
    ///
    /// # Panics
    /// If the plan has no such scenario (an error of the calling code).
    pub fn trace(&self, scenario: u64) -> Result<Recording, RunError> {
        assert!(scenario < self.plan.scenarios(), "{} scenarios", self.plan.scenarios());
        let blocks = Blocks::new(&self.plan, &self.design);
        blocks.trace(&blocks.ready(scenario))
    }

    /// The row of a scenario that ends the process which runs it: what it is, and no result.
    pub fn aborted(&self, scenario: u64) -> Rows {
        self.without_result(scenario, ENDED)
    }

    /// The row of a scenario of a foreign FMU that took longer than the plan allows.
    pub fn given_up(&self, scenario: u64) -> Rows {
        let limit_s = self.plan.foreign.as_ref().map_or(0.0, |it| it.time_limit().as_secs_f64());
        self.without_result(scenario, &format!("it took longer than {limit_s} s (fmu_time_limit)"))
    }

    fn without_result(&self, scenario: u64, why: &str) -> Rows {
        let mut rows = Rows::none(&self.plan);
        rows.push(&self.plan, &self.plan.scenario(scenario), Err(why));
        rows
    }
}

/// Scenarios that fail because somebody wants to see what comes of it: on a cluster, or in the tests.
mod drill {
    use std::ops::Range;

    /// Ends the process, or the thread, at the scenario of `DRIVESCOPE_ABORT_AT` or
    /// `DRIVESCOPE_PANIC_AT`.
    pub(super) fn fault(range: &Range<u64>) {
        let asked = |name: &str| std::env::var(name).ok()?.parse::<u64>().ok();
        if asked("DRIVESCOPE_ABORT_AT").is_some_and(|it| range.contains(&it)) {
            std::process::abort();
        }
        assert!(
            !asked("DRIVESCOPE_PANIC_AT").is_some_and(|it| range.contains(&it)),
            "a scenario that was asked to fail (DRIVESCOPE_PANIC_AT)"
        );
    }
}
