//! Detectors over lanes of scenarios, while the drives run: what [`drivescope_diagnoser::Detector`]
//! does with one run, without storing its signals.

use drivescope_diagnoser::{Confidence, CusumLanes, Diagnoser, ModelLanes, threshold_for};
use drivescope_plant::effects::law::OutputLanes;
use drivescope_plant::sampled::{InputLanes, Samples, SignalLanes};

use super::super::bank::{BankFound, Lanes};
use super::super::design::Design;
use super::super::noise::NoiseLanes;
use super::super::plan::{Method, Plan, Settings};
use super::tally::{Found, Phase, Tally};

/// What a scenario's detectors need to know of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Watched {
    pub(super) settings: Settings,
    /// First and last faulty sample; past the end where nothing fails.
    pub(super) from: u64,
    pub(super) until: u64,
}

/// What became of a scenario.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::campaign) struct Outcome {
    /// Whether all its signals were finite.
    pub(in crate::campaign) finite: bool,
    /// What each method of the plan found, in the plan's order.
    pub(in crate::campaign) found: Vec<Found>,
    /// What the bank found beside, if the plan has one.
    pub(in crate::campaign) bank: Option<BankFound>,
    /// Mean of the residual over the fault, unit of T; over health where nothing fails; 0 where no
    /// method tests it.
    pub(in crate::campaign) residual: f64,
}

/// Noise into the drives, their signals into the detectors.
pub(super) struct Watch<'a, const N: usize> {
    noise: NoiseLanes<N>,
    inputs: InputLanes<f64, N>,
    process: ModelLanes<N>,
    error: ModelLanes<N>,
    cusum: CusumLanes<N>,
    /// Which methods are at work.
    methods: [bool; 3],
    /// Constant thresholds.
    lower: [f64; N],
    upper: [f64; N],
    /// Half width of the bands.
    half: [f64; N],
    tallies: [Tally<N>; 3],
    bank: Option<Lanes<'a>>,
    run_up: u64,
    from: [u64; N],
    until: [u64; N],
    /// 0 while everything is finite, else not a number.
    finite: [f64; N],
    residuals: [f64; N],
}

impl<'a, const N: usize> Watch<'a, N> {
    /// Detectors at their start; nothing if the design holds models without lanes.
    pub(super) fn new(
        (plan, design): (&Plan, &Design),
        lanes: [Watched; N],
        (inputs, noise): (InputLanes<f64, N>, NoiseLanes<N>),
        bank: Option<Lanes<'a>>,
    ) -> Option<Self> {
        let Diagnoser { model, model_error, constant, .. } = &design.diagnoser;
        let t_beta = lanes
            .map(|lane| Confidence::new(lane.settings.beta).map_or(f64::NAN, |it| it.t_beta()));
        let threshold = lanes.map(|it| threshold_for(it.settings.arl_0, it.settings.kappa));
        let kappa = lanes.map(|it| it.settings.kappa);
        let (from, window) = (lanes.map(|it| it.from), lanes.map(|it| it.settings.window));
        Some(Self {
            noise,
            inputs,
            process: ModelLanes::new(model)?,
            error: ModelLanes::new(&model_error.model)?,
            cusum: CusumLanes::new(&design.cusum, threshold, kappa),
            methods: Method::OF_RESIDUAL.map(|method| plan.methods.contains(&method)),
            lower: t_beta.map(|t_beta| constant.mean - t_beta * constant.deviation),
            upper: t_beta.map(|t_beta| constant.mean + t_beta * constant.deviation),
            half: t_beta.map(|t_beta| t_beta * model_error.deviation),
            tallies: [Tally::new(window, from), Tally::new(window, from), Tally::new([1; N], from)],
            bank,
            run_up: plan.run_up as u64,
            from,
            until: lanes.map(|it| it.until),
            finite: [0.0; N],
            residuals: [0.0; N],
        })
    }

    /// What became of lane `l`.
    pub(super) fn outcome(&mut self, l: usize, plan: &Plan) -> Outcome {
        let bank = self.bank.as_mut().and_then(|bank| bank.finish(l));
        let of = |method: &Method| match method {
            Method::Bank => bank.as_ref().map_or_else(Found::default, |bank| bank.counts),
            _ => self.tallies[*method as usize].found(l),
        };
        let samples = plan.samples as u64;
        let (from, until) = (self.from[l].min(samples), self.until[l].min(samples));
        let judged = if from < samples { until - from } else { samples - self.run_up };
        Outcome {
            finite: self.finite[l] == 0.0,
            found: plan.methods.iter().map(of).collect(),
            bank,
            residual: self.residuals[l] / judged as f64,
        }
    }

    /// The detectors take C_m, T and I_m of sample `k`.
    #[inline(always)]
    pub(super) fn take(&mut self, k: u64, [c_m, t, i_m]: [&[f64; N]; 3]) {
        self.judge(k, c_m, t);
        if let Some(bank) = &mut self.bank {
            bank.take(k, [c_m, t, i_m]);
        }
    }

    /// What tests the residual.
    #[inline(always)]
    fn judge(&mut self, k: u64, c_m: &[f64; N], t: &[f64; N]) {
        for l in 0..N {
            self.finite[l] += 0.0 * t[l];
        }
        let [constant, bands, cusum] = self.methods;
        if !(constant || bands || cusum) {
            return;
        }
        let modelled = self.process.step(c_m);
        let mut residual = [0.0; N];
        for l in 0..N {
            residual[l] = t[l] - modelled[l];
        }
        let judged = u64::from(k >= self.run_up);
        let mut phase = Phase { healthy: [0; N], faulty: [0; N] };
        for l in 0..N {
            phase.healthy[l] = judged & u64::from(k < self.from[l]);
            phase.faulty[l] = u64::from(k >= self.from[l]) & u64::from(k < self.until[l]);
            self.residuals[l] += residual[l] * (phase.faulty[l] as f64);
        }
        if constant {
            let mut exceeds = [0; N];
            for l in 0..N {
                let inside = (self.lower[l] <= residual[l]) & (residual[l] <= self.upper[l]);
                exceeds[l] = judged & u64::from(!inside);
            }
            self.tallies[0].step(k, &exceeds, &phase);
        }
        if !(bands || cusum) {
            return;
        }
        let expected = self.error.step(c_m);
        let mut left = [0.0; N];
        let mut exceeds = [0; N];
        for l in 0..N {
            left[l] = residual[l] - expected[l];
            let (lower, upper) = (expected[l] - self.half[l], expected[l] + self.half[l]);
            let inside = (lower <= residual[l]) & (residual[l] <= upper);
            exceeds[l] = judged & u64::from(!inside);
        }
        if bands {
            self.tallies[1].step(k, &exceeds, &phase);
        }
        if cusum {
            let step = self.cusum.step(&left);
            if judged == 0 {
                self.cusum.restart_all();
            } else {
                self.tallies[2].step(k, &step.exceeds, &phase);
            }
        }
    }
}

impl<const N: usize> Samples<N> for Watch<'_, N> {
    #[inline(always)]
    fn inputs(&mut self, _: usize) -> &InputLanes<f64, N> {
        self.noise.fill(&mut self.inputs);
        &self.inputs
    }

    #[inline(always)]
    fn keep(&mut self, k: usize, signals: &SignalLanes<f64, N>, _: &OutputLanes<f64, N>) {
        self.take(k as u64, [&signals.c_m, &signals.t, &signals.i_m]);
    }
}
