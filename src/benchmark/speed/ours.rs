//! The pieces of the program that are timed.

use std::hint::black_box;

use drivescope_plant::drive::Drive;
use drivescope_plant::integrate::{Block, Integrator, State};
use drivescope_plant::model::{Applied, CURRENT, Model, SPEED};
use drivescope_plant::sampled::speed_bound;
use drivescope_scenarios::campaign::{Campaign, Design, Plan};

use super::Held;
use crate::failure::into_report;

/// Current and speed after every sample of one drive under held inputs, from its integrator.
pub(super) fn alone(drive: &Drive, held: &Held) -> Vec<[f64; 2]> {
    let mut integrator = Integrator::new(drive.model(), speed_bound(drive));
    let mut state = started(integrator.model(), held);
    let mut made = Vec::with_capacity(held.inputs.len());
    for [u, load] in &held.inputs {
        integrator.advance(&mut state, &applied(*u, *load), held.period_s);
        made.push([state.x[CURRENT][0], state.x[SPEED][0]]);
    }
    made
}

/// The same of `N` drives side by side, whose states nobody keeps.
pub(super) fn lanes<const N: usize>(drive: &Drive, held: &Held) {
    let model = drive.model();
    let mut block = Block::new(Model::side_by_side([&model; N]), speed_bound(drive));
    let mut state = started(block.model(), held);
    for [u, load] in &held.inputs {
        block.advance(&mut state, &applied(*u, *load), held.period_s);
    }
    black_box(&state);
}

fn applied<const N: usize>(u: f64, load: f64) -> Applied<f64, N> {
    Applied { u: [u; N], load: [load; N], time: 0.0 }
}

fn started<const N: usize>(model: &Model<f64, N>, held: &Held) -> State<f64, N> {
    let mut state = State::at_rest(model);
    for l in 0..N {
        state.x[CURRENT][l] = held.start[0];
        state.set_speed(model, l, held.start[1]);
    }
    state
}

/// A campaign with noise on the built-in drive: that many scenarios of `samples`, half of them faulty,
/// with those detectors.
///
/// # Errors
/// An internal error only.
pub(super) fn campaign(
    scenarios: usize,
    samples: usize,
    detectors: &str,
) -> miette::Result<Campaign> {
    let text = format!(
        "schema = 1\nname = \"speed\"\ndrive = \"dr300\"\nseed = 1\ndraws = {scenarios}\n\
         duration = {}\n[[fault]]\nkind = {{ choice = [\"tacho\", \"flux\"] }}\n\
         size = {{ uniform = [0.01, 0.2] }}\nonset = {}\nprobability = 0.5\n\
         [detector]\nrun_up = {}\nmethods = [{detectors}]\n",
        samples as f64 * PERIOD_S,
        0.5 * samples as f64 * PERIOD_S,
        0.25 * samples as f64 * PERIOD_S,
    );
    let plan = Plan::parse(&text, "plan", std::path::Path::new("")).map_err(into_report)?;
    let design = Design::new(&plan).map_err(into_report)?;
    Ok(Campaign::new(plan, design))
}

/// Sampling time of the built-in drive, s.
pub(super) const PERIOD_S: f64 = 0.005;

/// Runs all scenarios of a campaign.
pub(super) fn scenarios(campaign: &Campaign) {
    black_box(campaign.run(0..campaign.plan().scenarios(), &|_| false));
}
