//! What runs cost, beside what they cost in other people's programs and what the machine could do.
//!
//! Every ratio is of pieces of work that take turns in this process, on this machine, now; the work
//! is the same for all: a DC motor under the control signal of a recorded closed loop.

mod clock;
mod dopri5;
mod growth;
mod machine;
mod ours;
mod peers;

use std::f64::consts::TAU;
use std::hint::black_box;

use drivescope_plant::drive::Drive;
use drivescope_scenarios::campaign::Campaign;
use drivescope_scenarios::drives::built_in;
use drivescope_scenarios::experiment::{Experiment, Stream};
use drivescope_scenarios::native::{ClosedLoops, OneClosedLoop, closed_loop};
use miette::IntoDiagnostic as _;
use serde::Serialize;

use crate::failure::into_report;
use crate::interrupt;
use clock::{least, least_of};
use dopri5::Peer;
use ours::PERIOD_S;

pub(crate) use growth::Growth;
pub(crate) use machine::Machine;
pub(crate) use peers::Peers;

/// Samples of a scenario, as in the study.
pub(crate) const SAMPLES: usize = 5000;
/// Samples of a recorded loop before the motor is at speed, which are left out.
const RUN_UP: usize = 400;
/// Lanes of a block.
const LANES: usize = 32;
/// Additions and multiplications of an exact step: three rows of state, inputs and constant (15 each
/// of both), and the test that the shaft goes on turning.
const STEP_FLOPS: f64 = 35.0;

/// What acts on a motor, sample by sample, from a state at speed on.
#[derive(Debug, Clone)]
struct Held {
    /// Voltage, V, and load torque, N m.
    inputs: Vec<[f64; 2]>,
    /// Current, A, and speed, rad/s.
    start: [f64; 2],
    period_s: f64,
}

/// Seconds, on one core where nothing else is said; shares and factors where there is no unit.
#[derive(Debug, Serialize)]
pub(crate) struct Speed {
    pub(crate) machine: Machine,
    /// A sample of one drive alone, by the exact step.
    pub(crate) step_s: f64,
    /// A sample of a drive among 32 side by side.
    pub(crate) lane_s: f64,
    /// Additions and multiplications of a lane's step at the machine's best.
    pub(crate) lane_bound_s: f64,
    /// A sample of Dopri5 at 1e-6 under the same inputs.
    pub(crate) dopri5_s: f64,
    /// Greatest error of the speed, rad/s, of the program and of Dopri5.
    pub(crate) errors: [f64; 2],
    /// A closed loop of 5000 samples, its noise drawn before.
    pub(crate) closed_loop_s: f64,
    /// Twelve of them side by side, and with the drawing of the noise.
    pub(crate) twelve_s: [f64; 2],
    /// A sample that sticks and slips.
    pub(crate) stick_slip_s: f64,
    /// A scenario of 5000 samples with noise in a campaign, without detectors and with bands and CUSUM.
    pub(crate) scenario_s: [f64; 2],
    /// Threads, and how many times as fast a campaign is on them as on one.
    pub(crate) threads: usize,
    pub(crate) threads_gain: f64,
    /// Programs of other people.
    pub(crate) peers: Peers,
    pub(crate) growth: Vec<Growth>,
}

/// How large the timed campaigns are: scenarios.
const CAMPAIGN: usize = 4096;
/// The same where a quick look is enough.
const SHORT_CAMPAIGN: usize = 512;

impl Speed {
    /// Times everything; `tick` is called after each part of [`PARTS`].
    ///
    /// # Errors
    /// Interrupted, or an internal error.
    pub(crate) fn measure(short: bool, tick: &dyn Fn()) -> miette::Result<Self> {
        let part = || {
            tick();
            interrupt::check()
        };
        let drive =
            built_in("dr300").ok_or_else(|| miette::miette!("no dr300"))?.map_err(into_report)?;
        let experiment = Experiment::new(drive.clone(), 1).map_err(into_report)?;
        let held = held(&experiment);
        let machine = Machine::measure();
        part()?;
        let peer = Peer::new(&drive);
        let [step, lane, dopri5] = least([
            &mut || drop(black_box(ours::alone(&drive, &held))),
            &mut || ours::lanes::<LANES>(&drive, &held),
            &mut || drop(black_box(peer.run(&held))),
        ]);
        let reference = peer.reference(&held);
        let errors = [ours::alone(&drive, &held), peer.run(&held)].map(|run| {
            let apart = run.iter().zip(&reference).map(|(a, b)| (a[1] - b[1]).abs());
            apart.fold(0.0, f64::max)
        });
        part()?;
        let (closed_loop_s, twelve_s) = loops(&experiment);
        let stick_slip_s = stick_slip(&drive);
        part()?;
        let count = if short { SHORT_CAMPAIGN } else { CAMPAIGN };
        let bare = ours::campaign(count, SAMPLES, "")?;
        let judged = ours::campaign(count, SAMPLES, "\"bands\", \"cusum\"")?;
        let (scenario_s, threads, threads_gain) = campaigns(&bare, &judged, count)?;
        part()?;
        let peers = Peers::measure(&drive, &held, short);
        part()?;
        let growth = growth::measure(&drive, &held, short)?;
        part()?;
        let samples = held.inputs.len() as f64;
        Ok(Self {
            machine,
            step_s: step / samples,
            lane_s: lane / samples / LANES as f64,
            lane_bound_s: STEP_FLOPS / machine.flops,
            dopri5_s: dopri5 / samples,
            errors,
            closed_loop_s,
            twelve_s,
            stick_slip_s,
            scenario_s,
            threads,
            threads_gain,
            peers,
            growth,
        })
    }

    /// How many times as fast as Dopri5 a sample is, alone and among lanes.
    pub(crate) fn gains(&self) -> [f64; 2] {
        [self.dopri5_s / self.step_s, self.dopri5_s / self.lane_s]
    }
}

/// Parts of a measurement.
pub(crate) const PARTS: u64 = 6;

/// The voltages and loads of a recorded closed loop, once it is at speed.
fn held(experiment: &Experiment) -> Held {
    let inputs = experiment.closed_loop(SAMPLES + RUN_UP, Stream::Healthy(0), None);
    let run = closed_loop(&experiment.drive, &inputs);
    let values = |of: &drivescope_recording::Recording, name: &str| {
        of.signal(name).map_or_else(|| vec![0.0; of.len()], |it| it.values.clone())
    };
    let (control, load) = (values(&run, "C_m"), values(&inputs, "noise_T_l"));
    let start = ["i", "omega"].map(|name| values(&run, name)[RUN_UP - 1]);
    let amplified = |control: f64| {
        experiment.drive.amplifier.as_ref().map_or(control, |amplifier| {
            let limit = amplifier.limit.unwrap_or(f64::INFINITY);
            (amplifier.gain * control).clamp(-limit, limit)
        })
    };
    let both = control.iter().zip(&load).skip(RUN_UP);
    Held {
        inputs: both.map(|(control, load)| [amplified(*control), *load]).collect(),
        start,
        period_s: PERIOD_S,
    }
}

/// A closed loop; twelve faulty ones side by side, without and with the drawing of their noise.
fn loops(experiment: &Experiment) -> (f64, [f64; 2]) {
    let faults =
        drivescope_scenarios::faults::twelve(drivescope_scenarios::results::TorqueReading::Flux);
    let drawn = || -> Vec<_> {
        let streams = faults.iter().zip(0..);
        streams
            .map(|(it, k)| experiment.closed_loop(SAMPLES, Stream::Faulty(k), Some(it)))
            .collect()
    };
    let inputs = drawn();
    // In memory that is taken once: fresh memory costs as much as a run.
    let mut single = OneClosedLoop::new(&experiment.drive);
    let mut twelve = ClosedLoops::new(&experiment.drive);
    let mut again = twelve.clone();
    let [one, side_by_side, all] = least([
        &mut || {
            black_box(single.run(&inputs[0]));
        },
        &mut || {
            black_box(twelve.run(&inputs));
        },
        &mut || {
            black_box(again.run(&drawn()));
        },
    ]);
    (one, [side_by_side, all])
}

/// A sample under a slow sine that hardly moves the shaft.
fn stick_slip(drive: &Drive) -> f64 {
    let inputs: Vec<[f64; 2]> =
        (0..SAMPLES).map(|k| [2.0 * (TAU * 0.5 * k as f64 * PERIOD_S).sin(), 0.0]).collect();
    let slow = Held { inputs, start: [0.0; 2], period_s: PERIOD_S };
    least_of(&mut || drop(black_box(ours::alone(drive, &slow)))) / SAMPLES as f64
}

/// Seconds of a scenario on one thread, bare and judged; the threads there are, and what they gain.
fn campaigns(
    bare: &Campaign,
    judged: &Campaign,
    count: usize,
) -> miette::Result<([f64; 2], usize, f64)> {
    let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let threads = rayon::current_num_threads();
    let (one, all) = (pool(1).into_diagnostic()?, pool(threads).into_diagnostic()?);
    let [bare_s, judged_s, all_s] = least([
        &mut || one.install(|| ours::scenarios(bare)),
        &mut || one.install(|| ours::scenarios(judged)),
        &mut || all.install(|| ours::scenarios(judged)),
    ]);
    Ok(([bare_s / count as f64, judged_s / count as f64], threads, judged_s / all_s))
}
