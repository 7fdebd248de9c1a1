//! The bank of a campaign: designed once for the plan, learned on the machine of each scenario from
//! the end of its run-up, at work while the drives run.

mod design;
mod found;
mod lane;
#[cfg(test)]
mod tests;

use drivescope_monitor::bank::{AnyProcess, process, with_noise};

use super::plan::{Plan, Settings};
use crate::seen::row;
pub use design::DesignedBank;
pub(super) use found::{BankFound, LEARNED, Named};
use lane::Lane;

/// What the banks of all scenarios share.
pub(super) struct Bank<'a> {
    process: Box<dyn AnyProcess>,
    design: &'a DesignedBank,
    run_up: u64,
    per_si: f64,
}

impl<'a> Bank<'a> {
    /// The bank of a plan; nothing if its drive makes no process, which a plan with a bank is refused
    /// for.
    pub(super) fn new(plan: &Plan, design: &'a DesignedBank) -> Option<Self> {
        let drive = plan.drive();
        let known = with_noise(drive, &design.noise);
        Some(Self {
            process: process(&known, plan.experiment.period_s, &[]).ok()?,
            design,
            run_up: plan.run_up as u64,
            per_si: drive.sensors.tacho_unit.per_si(),
        })
    }

    /// Banks over scenarios side by side: the settings of each, and its first and last faulty sample.
    pub(super) fn lanes(&self, of: impl Iterator<Item = (Settings, (u64, u64))>) -> Lanes<'_> {
        let lane = |(settings, faulty): (Settings, (u64, u64))| {
            Lane::new(self.design.tails.limits(settings.arl_0), faulty, self)
        };
        Lanes { bank: self, lanes: of.map(lane).collect() }
    }
}

/// Banks over scenarios side by side.
pub(super) struct Lanes<'a> {
    bank: &'a Bank<'a>,
    lanes: Vec<Lane>,
}

impl Lanes<'_> {
    /// Takes C_m, T and I_m of sample `k`; lanes that are left over belong to no scenario.
    #[inline(never)]
    pub(super) fn take<const N: usize>(&mut self, k: u64, [c_m, t, i_m]: [&[f64; N]; 3]) {
        for (l, lane) in self.lanes.iter_mut().enumerate() {
            lane.take(k, row([c_m[l], t[l], i_m[l]], self.bank.per_si), self.bank);
        }
    }

    /// What was found of scenario `l`.
    pub(super) fn finish(&mut self, l: usize) -> Option<BankFound> {
        let bank = self.bank;
        self.lanes.get_mut(l).map(|lane| lane.finish(bank))
    }
}
