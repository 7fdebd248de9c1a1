//! Integrates a Model Exchange instance over a communication step: Dormand-Prince 5(4) from
//! `ode_solvers` between events, time events at their time, state events located by bisection
//! (FMI 2.0 section 3.2, FMI 3.0 section 3.2).
//!
//! The solver sees z = x / nominal, so that one absolute tolerance fits all states. Its output is
//! sparse: accepted steps only. A time event that falls on a communication point is handled at the
//! start of the next step, after the inputs have been set: a sampled controller then sees the inputs of
//! its sampling time.

use std::cell::RefCell;

use ode_solvers::dop_shared::OutputType;
use ode_solvers::{DVector, Dopri5, System};

use super::description::{Description, Kind};
use super::error::IntegrationProblem;
use super::handle::Handle;
use super::status::Status;

/// Relative tolerance if nobody states one.
const TOLERANCE: f64 = 1e-6;
/// Updates of the discrete states at one event; a proper model needs a few.
const UPDATES: usize = 1000;
/// Events in a row, each closer to the one before than [`CLOSE`] of the communication step.
const ZENO: usize = 1000;
/// Share of the communication step below which two events do not count as progress.
const CLOSE: f64 = 1e-9;
/// Accepted and rejected steps of the solver within one communication step.
const SOLVER_STEPS: u32 = 1_000_000;
/// Spans shorter than this many units in the last place are too short for the solver, which takes them
/// for an underflow of its step size; one explicit Euler step errs by less than rounding there.
const SHORT_ULPS: f64 = 128.0;
/// Times closer than this many units in the last place are the same time.
const SAME_TIME_ULPS: f64 = 16.0;

/// Why an integration failed.
pub(super) enum Failure {
    /// An FMI function did.
    Call(&'static str, Status),
    /// The solver or the event handling did, at this time.
    Problem(f64, IntegrationProblem),
}

/// The state of the integration that the FMU does not hold.
#[derive(Debug, Clone)]
pub(super) struct Integrator {
    tolerance: f64,
    announces: bool,
    event_mode: bool,
    /// Event mode was entered for new inputs, and the update is still due.
    update_due: bool,
    next_event: Option<f64>,
    states: Vec<f64>,
    nominals: Vec<f64>,
    /// Event indicators after the last event.
    indicators: Vec<f64>,
    /// The solver's last step size, s: the first guess for the next step.
    guess: f64,
    ends: bool,
}

impl Integrator {
    pub(super) fn new(description: &Description) -> Integrator {
        let structure = &description.structure;
        let capabilities = description.capabilities(Kind::ModelExchange);
        Integrator {
            tolerance: description.default_experiment.tolerance.unwrap_or(TOLERANCE),
            announces: capabilities.is_some_and(|c| c.needs_completed_step),
            event_mode: false,
            update_due: false,
            next_event: None,
            states: vec![0.0; structure.derivatives.len()],
            nominals: vec![1.0; structure.derivatives.len()],
            indicators: vec![0.0; structure.event_indicators],
            guess: 0.0,
            ends: false,
        }
    }

    pub(super) fn set_tolerance(&mut self, tolerance: f64) {
        self.tolerance = tolerance;
    }

    /// After the initialisation: the FMU is in event mode, and its first update is due.
    pub(super) fn start(&mut self, fmu: &mut Handle) -> Result<(), Failure> {
        if let Some((states, indicators)) = fmu.sizes() {
            self.states.resize(states, 0.0);
            self.nominals.resize(states, 1.0);
            self.indicators.resize(indicators, 0.0);
        }
        self.event_mode = true;
        self.update_due = true;
        good("GetNominalsOfContinuousStates", self.read_nominals(fmu))
    }

    /// Enters event mode at the present time, for inputs that are about to change.
    pub(super) fn enter_event_mode(&mut self, fmu: &mut Handle) -> Status {
        self.update_due = true;
        if self.event_mode {
            return Status::Ok;
        }
        let status = fmu.enter_event_mode();
        self.event_mode = status.is_good();
        status
    }

    /// Integrates from `time` to `end`; whether the FMU asks to end the simulation.
    pub(super) fn advance(
        &mut self,
        fmu: &mut Handle,
        time: f64,
        end: f64,
    ) -> Result<bool, Failure> {
        let resolution = SAME_TIME_ULPS * f64::EPSILON * time.abs().max(end.abs());
        let mut now = time;
        if self.update_due || self.next_event.is_some_and(|event| event <= now + resolution) {
            good("SetTime", if self.event_mode { Status::Ok } else { fmu.set_time(now) })?;
            self.handle_event(fmu, now)?;
        }
        let mut stuck = 0;
        while now < end - resolution && !self.ends {
            let stop = self.next_event.map_or(end, |event| event.min(end));
            let (reached, state_event) = self.integrate(fmu, now, stop)?;
            stuck = if reached > now + CLOSE * (end - time) { 0 } else { stuck + 1 };
            if stuck > ZENO {
                return Err(Failure::Problem(now, IntegrationProblem::Zeno(stuck)));
            }
            now = reached;
            let time_event = self.next_event.is_some_and(|event| event <= now + resolution);
            if state_event || (time_event && now < end - resolution) {
                self.handle_event(fmu, now)?;
            }
        }
        Ok(self.ends)
    }

    /// Event mode: updates until the discrete states settle, then back to continuous time.
    fn handle_event(&mut self, fmu: &mut Handle, now: f64) -> Result<(), Failure> {
        if !self.event_mode {
            good("EnterEventMode", fmu.enter_event_mode())?;
        }
        let (mut nominals_changed, mut updates) = (false, 0);
        loop {
            let (status, info) = fmu.update_discrete_states();
            good("UpdateDiscreteStates", status)?;
            nominals_changed |= info.nominals_changed != 0;
            self.next_event = (info.next_time_defined != 0).then_some(info.next_time);
            self.ends |= info.terminate != 0;
            updates += 1;
            if info.again == 0 || self.ends {
                break;
            }
            if updates == UPDATES {
                return Err(Failure::Problem(now, IntegrationProblem::EventIteration(updates)));
            }
        }
        good("EnterContinuousTimeMode", fmu.enter_continuous_time_mode())?;
        (self.event_mode, self.update_due) = (false, false);
        good("GetContinuousStates", self.read_states(fmu))?;
        if nominals_changed {
            good("GetNominalsOfContinuousStates", self.read_nominals(fmu))?;
        }
        good("GetEventIndicators", self.read_indicators(fmu))
    }

    /// Integrates to `stop` or to the first event before it; the time reached, and whether an event
    /// (of an indicator or asked for by the FMU) is due there.
    fn integrate(&mut self, fmu: &mut Handle, now: f64, stop: f64) -> Result<(f64, bool), Failure> {
        let probe = RefCell::new(Probe {
            x: self.states.clone(),
            dx: vec![0.0; self.states.len()],
            after: self.indicators.clone(),
            before: &self.indicators,
            nominals: &self.nominals,
            announces: self.announces,
            failure: None,
            crossed: false,
            step_event: false,
            ends: false,
            fmu,
        });
        let from = Point { time: now, z: probe.borrow().scaled(&self.states) };
        let (mut last, mut reached) = solve(&probe, &from, stop, self.tolerance, self.guess)?;
        self.guess = reached.time - last.time;
        let crossed = probe.borrow().crossed;
        if crossed {
            (last, reached) = bisect(&probe, last, reached, self.tolerance)?;
        }
        let _ = last;
        let mut probe = probe.into_inner();
        probe.place(reached.time, &reached.z);
        if crossed {
            probe.announce();
        }
        probe.take_failure()?;
        self.ends |= probe.ends;
        let event = crossed || probe.step_event;
        let Probe { x, .. } = probe;
        self.states = x;
        Ok((reached.time, event))
    }

    fn read_states(&mut self, fmu: &mut Handle) -> Status {
        if self.states.is_empty() { Status::Ok } else { fmu.continuous_states(&mut self.states) }
    }

    fn read_nominals(&mut self, fmu: &mut Handle) -> Status {
        if self.nominals.is_empty() {
            return Status::Ok;
        }
        let status = fmu.nominals(&mut self.nominals);
        // A nominal of zero or worse would make the solver's scaling meaningless.
        for nominal in &mut self.nominals {
            *nominal = nominal.abs();
            if !(nominal.is_finite() && *nominal > 0.0) {
                *nominal = 1.0;
            }
        }
        status
    }

    fn read_indicators(&mut self, fmu: &mut Handle) -> Status {
        if self.indicators.is_empty() {
            Status::Ok
        } else {
            fmu.event_indicators(&mut self.indicators)
        }
    }
}

fn good(function: &'static str, status: Status) -> Result<(), Failure> {
    if status.is_good() { Ok(()) } else { Err(Failure::Call(function, status)) }
}

/// A point of the solution: time and scaled states.
#[derive(Clone)]
struct Point {
    time: f64,
    z: DVector<f64>,
}

/// The FMU as the solver sees it: derivatives at any point, and what happens at accepted ones.
struct Probe<'a> {
    fmu: &'a mut Handle,
    nominals: &'a [f64],
    before: &'a [f64],
    after: Vec<f64>,
    x: Vec<f64>,
    dx: Vec<f64>,
    announces: bool,
    crossed: bool,
    step_event: bool,
    ends: bool,
    failure: Option<(&'static str, Status)>,
}

impl Probe<'_> {
    fn scaled(&self, x: &[f64]) -> DVector<f64> {
        DVector::from_iterator(x.len(), x.iter().zip(self.nominals).map(|(x, nominal)| x / nominal))
    }

    fn note(&mut self, function: &'static str, status: Status) {
        if !status.is_good() && self.failure.is_none() {
            self.failure = Some((function, status));
        }
    }

    fn take_failure(&mut self) -> Result<(), Failure> {
        self.failure
            .take()
            .map_or(Ok(()), |(function, status)| Err(Failure::Call(function, status)))
    }

    /// Puts the FMU at a point.
    fn place(&mut self, time: f64, z: &DVector<f64>) {
        let status = self.fmu.set_time(time);
        self.note("SetTime", status);
        for ((x, z), nominal) in self.x.iter_mut().zip(z.iter()).zip(self.nominals) {
            *x = z * nominal;
        }
        if !self.x.is_empty() {
            let status = self.fmu.set_continuous_states(&self.x);
            self.note("SetContinuousStates", status);
        }
    }

    fn rate(&mut self, time: f64, z: &DVector<f64>, dz: &mut DVector<f64>) {
        self.place(time, z);
        match self.fmu.derivatives(&mut self.dx) {
            status if status.is_good() => {
                for ((dz, dx), nominal) in dz.iter_mut().zip(&self.dx).zip(self.nominals) {
                    *dz = dx / nominal;
                }
            }
            // The solver answers a derivative that is not a number with a smaller step.
            Status::Discard => dz.fill(f64::NAN),
            bad => {
                self.note("GetDerivatives", bad);
                dz.fill(f64::NAN);
            }
        }
    }

    /// Whether an event indicator has changed its domain (positive or not) since the last event.
    fn crosses(&mut self, time: f64, z: &DVector<f64>) -> bool {
        self.place(time, z);
        if self.before.is_empty() {
            return false;
        }
        let status = self.fmu.event_indicators(&mut self.after);
        self.note("GetEventIndicators", status);
        self.before.iter().zip(&self.after).any(|(before, after)| (*before > 0.0) != (*after > 0.0))
    }

    fn announce(&mut self) {
        if self.announces {
            let (status, event, ends) = self.fmu.completed_integrator_step();
            self.note("CompletedIntegratorStep", status);
            self.step_event |= event;
            self.ends |= ends;
        }
    }
}

struct Watched<'a, 'b>(&'a RefCell<Probe<'b>>);

impl System<f64, DVector<f64>> for Watched<'_, '_> {
    fn system(&self, time: f64, z: &DVector<f64>, dz: &mut DVector<f64>) {
        self.0.borrow_mut().rate(time, z, dz);
    }

    fn solout(&mut self, time: f64, z: &DVector<f64>, _: &DVector<f64>) -> bool {
        let mut probe = self.0.borrow_mut();
        if probe.crosses(time, z) {
            probe.crossed = true;
        } else {
            probe.announce();
        }
        probe.crossed || probe.step_event || probe.ends || probe.failure.is_some()
    }
}

/// The right-hand side alone, for the short integrations within the bisection.
struct Unwatched<'a, 'b>(&'a RefCell<Probe<'b>>);

impl System<f64, DVector<f64>> for Unwatched<'_, '_> {
    fn system(&self, time: f64, z: &DVector<f64>, dz: &mut DVector<f64>) {
        self.0.borrow_mut().rate(time, z, dz);
    }
}

/// Integrates until `stop` or until the probe stops it: the last two accepted points.
fn solve(
    probe: &RefCell<Probe>,
    from: &Point,
    stop: f64,
    tolerance: f64,
    guess: f64,
) -> Result<(Point, Point), Failure> {
    if from.z.is_empty() {
        // Nothing to integrate: only indicators of time and inputs can cross.
        let end = Point { time: stop, z: from.z.clone() };
        Watched(probe).solout(stop, &end.z, &end.z);
        probe.borrow_mut().take_failure()?;
        return Ok((from.clone(), end));
    }
    run(Watched(probe), probe, from, stop, tolerance, guess)
}

fn run<S: System<f64, DVector<f64>>>(
    mut system: S,
    probe: &RefCell<Probe>,
    from: &Point,
    stop: f64,
    tolerance: f64,
    guess: f64,
) -> Result<(Point, Point), Failure> {
    let span = stop - from.time;
    let mut rate = from.z.clone();
    system.system(from.time, &from.z, &mut rate);
    probe.borrow_mut().take_failure()?;
    if !rate.iter().all(|rate| rate.is_finite()) {
        return Err(Failure::Problem(from.time, IntegrationProblem::NotFinite));
    }
    if span <= SHORT_ULPS * f64::EPSILON * stop.abs().max(from.time.abs()) {
        let end = Point { time: stop, z: &from.z + &rate * span };
        system.solout(stop, &end.z, &rate);
        return Ok((from.clone(), end));
    }
    let mut solver = Dopri5::from_param(
        system,
        from.time,
        stop,
        span,
        from.z.clone(),
        tolerance,
        tolerance,
        0.9,
        0.04,
        0.2,
        10.0,
        span,
        guess.min(span),
        SOLVER_STEPS,
        1000,
        OutputType::Sparse,
    );
    let solved = solver.integrate();
    probe.borrow_mut().take_failure()?;
    solved.map_err(|error| {
        Failure::Problem(solver.x_out().last().copied().unwrap_or(from.time), error.into())
    })?;
    let (times, states) = solver.results().get();
    let point = |k: usize| Point { time: times[k], z: states[k].clone() };
    let last = times.len() - 1;
    Ok((point(last.saturating_sub(1)), point(last)))
}

/// Halves the accepted step in which an indicator crossed until it is as short as time can tell; the
/// last point before the event and the first one after it.
fn bisect(
    probe: &RefCell<Probe>,
    mut low: Point,
    mut high: Point,
    tolerance: f64,
) -> Result<(Point, Point), Failure> {
    let resolution = SAME_TIME_ULPS * f64::EPSILON * low.time.abs().max(high.time.abs());
    while high.time - low.time > resolution {
        let time = low.time + 0.5 * (high.time - low.time);
        let middle = match low.z.is_empty() {
            true => Point { time, z: low.z.clone() },
            false => run(Unwatched(probe), probe, &low, time, tolerance, time - low.time)?.1,
        };
        let crosses = probe.borrow_mut().crosses(middle.time, &middle.z);
        probe.borrow_mut().take_failure()?;
        if crosses { high = middle } else { low = middle }
    }
    Ok((low, high))
}
