//! Noise of scenarios, lane beside lane: as [`drivescope_plant::noise`] has it, from streams that are
//! drawn in vector code.

mod ziggurat;

use drivescope_numerics::elementary::exp;
use drivescope_plant::drive::NoiseData;
use drivescope_plant::sampled::InputLanes;
use ziggurat::Normals;

/// Which noises a plan has: what no scenario has is not drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Channels {
    pub(super) reference: bool,
    pub(super) omega: bool,
    pub(super) i: bool,
    pub(super) torque: bool,
}

impl Channels {
    /// Those of a drive.
    pub(super) fn of(noise: &NoiseData) -> Self {
        Self {
            reference: noise.reference > 0.0,
            omega: noise.omega > 0.0,
            i: noise.i > 0.0,
            torque: noise.torque > 0.0,
        }
    }

    /// All of them: where the plan changes them.
    pub(super) const ALL: Self = Self { reference: true, omega: true, i: true, torque: true };
}

/// What each lane's noise is like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LaneNoise {
    pub(super) seed: u64,
    pub(super) deviations: NoiseData,
}

/// The noise of `N` scenarios.
#[derive(Debug, Clone)]
pub(super) struct NoiseLanes<const N: usize> {
    normals: Normals<N>,
    channels: Channels,
    reference: [f64; N],
    tacho: [f64; N],
    i: [f64; N],
    /// Of the disturbance torque: deviation, memory over a sample, what refreshes it, its value.
    torque: [f64; N],
    memory: [f64; N],
    refresh: [f64; N],
    now: [f64; N],
    begun: bool,
}

impl<const N: usize> NoiseLanes<N> {
    /// Streams at their start; `per_si` is T of 1 rad/s.
    pub(super) fn new(
        lanes: [LaneNoise; N],
        channels: Channels,
        period_s: f64,
        per_si: f64,
    ) -> Self {
        let of = |value: &dyn Fn(&NoiseData) -> f64| lanes.map(|lane| value(&lane.deviations));
        let memory = of(&|it| {
            if it.torque_time > 0.0 { exp(-period_s / it.torque_time) } else { 0.0 }
        });
        let torque = of(&|it| it.torque);
        Self {
            normals: Normals::new(lanes.map(|lane| lane.seed)),
            channels,
            reference: of(&|it| it.reference),
            tacho: of(&|it| it.omega * per_si),
            i: of(&|it| it.i),
            torque,
            memory,
            refresh: std::array::from_fn(|l| torque[l] * (1.0 - memory[l] * memory[l]).sqrt()),
            now: [0.0; N],
            begun: false,
        }
    }

    /// Puts the noise of the next sample into the inputs.
    #[inline(always)]
    pub(super) fn fill(&mut self, inputs: &mut InputLanes<f64, N>) {
        if self.channels.reference {
            scaled(&self.reference, &self.normals.next(), &mut inputs.noise_reference);
        }
        if self.channels.omega {
            scaled(&self.tacho, &self.normals.next(), &mut inputs.noise_t);
        }
        if self.channels.i {
            scaled(&self.i, &self.normals.next(), &mut inputs.noise_i_m);
        }
        if self.channels.torque {
            let fresh = self.normals.next();
            if self.begun {
                for l in 0..N {
                    self.now[l] = self.memory[l] * self.now[l] + self.refresh[l] * fresh[l];
                }
            } else {
                scaled(&self.torque, &fresh, &mut self.now);
                self.begun = true;
            }
            inputs.load = self.now;
        }
    }
}

#[inline(always)]
fn scaled<const N: usize>(deviation: &[f64; N], normal: &[f64; N], to: &mut [f64; N]) {
    for l in 0..N {
        to[l] = deviation[l] * normal[l];
    }
}
