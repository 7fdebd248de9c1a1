//! The stretch between two events: Dormand-Prince 5(4) from `ode_solvers`, stopped where an event
//! indicator changes its domain, and the bisection that finds this point.
//!
//! The solver sees z = x / nominal, so that one absolute tolerance fits all states. Its output is
//! sparse: accepted steps only.

use std::cell::RefCell;

use ode_solvers::dop_shared::OutputType;
use ode_solvers::{DVector, Dopri5, System};

use super::handle::Handle;
use super::problem::IntegrationProblem;
use super::status::Status;

/// Accepted and rejected steps of the solver within one communication step.
const SOLVER_STEPS: u32 = 1_000_000;
/// Spans shorter than this many units in the last place are too short for the solver, which takes them
/// for an underflow of its step size; one explicit Euler step errs by less than rounding there.
const SHORT_ULPS: f64 = 128.0;
/// Times closer than this many units in the last place are the same time.
pub(super) const SAME_TIME_ULPS: f64 = 16.0;

/// Why an integration failed.
pub(super) enum Failure {
    /// An FMI function did.
    Call(&'static str, Status),
    /// The solver or the event handling did, at this time.
    Problem(f64, IntegrationProblem),
}

/// Where and how to integrate.
pub(super) struct Start<'a> {
    pub(super) time: f64,
    pub(super) states: &'a [f64],
    pub(super) nominals: &'a [f64],
    /// Event indicators after the last event.
    pub(super) indicators: &'a [f64],
    /// Whether accepted steps are announced to the FMU.
    pub(super) announces: bool,
    pub(super) tolerance: f64,
    /// First guess of the step size, s; 0 for none.
    pub(super) guess: f64,
}

/// Where the integration ended.
pub(super) struct Reached {
    pub(super) time: f64,
    pub(super) states: Vec<f64>,
    /// The last accepted step size, s.
    pub(super) step: f64,
    /// Whether an event (of an indicator or asked for by the FMU) is due.
    pub(super) event: bool,
    /// Whether the FMU asks to end the simulation.
    pub(super) ends: bool,
}

/// Integrates to `stop` or to just after the first event before it, and leaves the FMU there.
pub(super) fn solve_until(fmu: &mut Handle, start: &Start, stop: f64) -> Result<Reached, Failure> {
    let probe = RefCell::new(Probe {
        fmu,
        nominals: start.nominals,
        before: start.indicators,
        after: start.indicators.to_vec(),
        x: start.states.to_vec(),
        dx: vec![0.0; start.states.len()],
        announces: start.announces,
        crossed: false,
        step_event: false,
        ends: false,
        failure: None,
    });
    let from = Point { time: start.time, z: probe.borrow().scaled(start.states) };
    let (last, mut reached) = solve(&probe, &from, stop, start.tolerance, start.guess)?;
    let step = reached.time - last.time;
    let crossed = probe.borrow().crossed;
    if crossed {
        reached = bisect(&probe, last, reached, start.tolerance)?;
    }
    let mut probe = probe.into_inner();
    probe.place(reached.time, &reached.z);
    if crossed {
        probe.announce();
    }
    probe.take_failure()?;
    let Probe { x, step_event, ends, .. } = probe;
    Ok(Reached { time: reached.time, states: x, step, event: crossed || step_event, ends })
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
/// first point after the event.
fn bisect(
    probe: &RefCell<Probe>,
    mut low: Point,
    mut high: Point,
    tolerance: f64,
) -> Result<Point, Failure> {
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
    Ok(high)
}
