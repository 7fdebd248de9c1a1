//! From the tables of a plan file to a plan: the rules between keys.

mod detector;
mod fault;
mod foreign;

use std::path::Path;

use drivescope_plant::drive::Drive;
use drivescope_plant::sampled::speed_bound;
use toml::Spanned;

use self::detector::detector;
use self::fault::fault;
use self::foreign::foreign;
use super::error::{Flaw, Problem};
use super::layout::{Given, Layout};
use super::quantity::Quantity;
use super::{DetectorPlan, MOST_SCENARIOS, Plan};
use crate::drives::{BUILT_IN, built_in};
use crate::experiment::Experiment;

/// What a plan need not say.
const RUN_UP_S: f64 = 5.0;
const DESIGN_SAMPLES: u64 = 300_000;
/// Samples of a scenario, and of a design, at most.
const MOST_SAMPLES: f64 = 1e7;
/// Samples of a design at least: its filters have forty coefficients.
const FEWEST_DESIGNED: u64 = 20_000;

pub(super) fn plan(text: &str, folder: &Path) -> Result<Plan, Flaw> {
    let layout: Layout = toml::from_str(text).map_err(|error| {
        let reason = error.message().to_owned();
        Flaw::new(Problem::Form { reason }, error.span().unwrap_or(0..0))
    })?;
    if *layout.schema.get_ref() != 1 {
        return Err(at(&layout.schema, Problem::Schema { found: *layout.schema.get_ref() }));
    }
    let drive = drive(&layout.drive, folder)?;
    let experiment = Experiment::new(drive, layout.seed)
        .map_err(|error| at(&layout.drive, Problem::Experiment(error)))?;
    let period_s = experiment.period_s;
    let duration_s = *layout.duration.get_ref();
    let steps = (duration_s / period_s).round();
    let run_up_s = layout.detector.run_up.as_ref().map_or(RUN_UP_S, |it| *it.get_ref());
    let run_up = (run_up_s / period_s).round();
    if !(1.0..=MOST_SAMPLES).contains(&steps) {
        let allowed = format!("a time of 1 to {MOST_SAMPLES} samples of {period_s} s");
        return Err(out_of_range(&layout.duration, "duration", duration_s, allowed));
    }
    if !(run_up >= 0.0 && run_up < steps) {
        let allowed = format!("a time that leaves something of the run of {duration_s} s");
        let span = layout.detector.run_up.as_ref().map_or(layout.duration.span(), Spanned::span);
        let key = "detector.run_up".to_owned();
        return Err(Flaw::new(Problem::OutOfRange { key, value: run_up_s, allowed }, span));
    }
    let (samples, run_up) = (steps as usize, run_up as usize);
    let traces = share(layout.keep_traces.as_ref(), "keep_traces", 0.0)?;
    let speed = speed_bound(&experiment.drive);
    let set_point = match &layout.set_point {
        None => Quantity::fixed(experiment.set_point),
        Some(given) => within("set_point", given, (-speed, speed), "a speed that it reaches")?,
    };
    let noise_seed = layout
        .noise_seed
        .as_ref()
        .map(|given| within("noise_seed", given, (0.0, 9e15), "a whole number of 0 or more"));
    let noise_seed = noise_seed.transpose()?;
    let parameters = parameters(&layout, &experiment.drive)?;
    let faults = layout.fault.iter().enumerate().map(|(k, table)| {
        let key = if k == 0 { "fault".to_owned() } else { format!("fault {}", k + 1) };
        fault(&key, table.get_ref(), (run_up as f64 * period_s, samples as f64 * period_s))
    });
    let faults = faults.collect::<Result<Vec<_>, _>>()?;
    let (methods, detector) = detector(&layout.detector, &experiment, run_up)?;
    let design_seed = layout.design.seed.as_ref().map(|it| *it.get_ref());
    if let Some(seed) = layout.design.seed.as_ref().filter(|it| *it.get_ref() == layout.seed) {
        return Err(at(seed, Problem::SameSeed));
    }
    let design_samples = layout.design.samples.as_ref().map_or(DESIGN_SAMPLES, |it| *it.get_ref());
    if let Some(it) = &layout.design.samples
        && !(FEWEST_DESIGNED..=MOST_SAMPLES as u64).contains(&design_samples)
    {
        let allowed = format!("{FEWEST_DESIGNED} to {MOST_SAMPLES}");
        return Err(out_of_range(it, "design.samples", design_samples as f64, allowed));
    }
    let said: toml::Table = toml::from_str(text).unwrap_or_default();
    let digest = super::digest(&[&said.to_string(), &experiment.drive.to_toml()]);
    let mut plan = Plan {
        name: layout.name.clone(),
        seed: layout.seed,
        samples,
        run_up,
        methods,
        design_seed: design_seed.unwrap_or(layout.seed.wrapping_add(1)),
        design_samples: design_samples as usize,
        digest,
        text: text.to_owned(),
        draws: *layout.draws.get_ref(),
        points: 1,
        traces,
        set_point,
        noise_seed,
        parameters,
        faults,
        detector,
        experiment,
        drive_name: layout.drive.get_ref().clone(),
        foreign: None,
    };
    plan.foreign = foreign(&layout, &plan, folder)?;
    if let Some(foreign) = &plan.foreign {
        plan.digest = super::digest(&[&plan.digest, &foreign.digest]);
    }
    let points = plan.all_points();
    let count = points.saturating_mul(u128::from(plan.draws));
    if plan.draws == 0 {
        let allowed = "1 or more".to_owned();
        return Err(out_of_range(&layout.draws, "draws", 0.0, allowed));
    }
    if count > u128::from(MOST_SCENARIOS) {
        let (draws, most) = (plan.draws, MOST_SCENARIOS);
        return Err(at(&layout.draws, Problem::TooMany { count, points, draws, most }));
    }
    plan.points = points as u64;
    Ok(plan)
}

impl Plan {
    /// Points of the product of all grids.
    fn all_points(&self) -> u128 {
        let DetectorPlan { beta, window, arl_0, kappa } = &self.detector;
        let of_faults = self.faults.iter().flat_map(|fault| {
            let duration = fault.duration_s.as_ref().map_or(1, Quantity::points);
            let own = [fault.size.points(), fault.onset_s.points(), duration];
            own.into_iter().chain([fault.kind.points(), fault.profile.points()])
        });
        let quantities = [&self.set_point, beta, window, arl_0, kappa].into_iter();
        let quantities = quantities.chain(&self.noise_seed);
        let quantities = quantities.chain(self.parameters.iter().map(|(_, quantity)| quantity));
        let points = quantities.map(Quantity::points).chain(of_faults);
        points.fold(1u128, |product, points| product.saturating_mul(u128::from(points)))
    }
}

fn at<T>(place: &Spanned<T>, problem: Problem) -> Flaw {
    Flaw::new(problem, place.span())
}

fn out_of_range<T>(place: &Spanned<T>, key: &str, value: f64, allowed: String) -> Flaw {
    at(place, Problem::OutOfRange { key: key.to_owned(), value, allowed })
}

fn share(given: Option<&Spanned<f64>>, key: &str, usual: f64) -> Result<f64, Flaw> {
    let Some(given) = given else { return Ok(usual) };
    match *given.get_ref() {
        share if (0.0..=1.0).contains(&share) => Ok(share),
        other => Err(out_of_range(given, key, other, "a share from 0 to 1".to_owned())),
    }
}

fn drive(given: &Spanned<String>, folder: &Path) -> Result<Drive, Flaw> {
    let name = given.get_ref();
    let file = super::places(name, folder).into_iter().find(|path| path.is_file());
    let read = match file {
        Some(path) => Some(Drive::read(path)),
        None => built_in(name),
    };
    let unknown = || {
        let known = BUILT_IN.map(|(name, _)| name).join(", ");
        at(given, Problem::UnknownDrive { name: name.clone(), known })
    };
    read.ok_or_else(unknown)?.map_err(|error| at(given, Problem::Drive(error)))
}

fn quantity(key: &str, given: &Spanned<Given>) -> Result<Quantity, Flaw> {
    let value = |what| at(given, Problem::Value { key: key.to_owned(), what });
    Quantity::of(given.get_ref()).map_err(value)
}

/// A quantity whose values all lie in a range.
fn within(
    key: &str,
    given: &Spanned<Given>,
    (low, high): (f64, f64),
    allowed: &str,
) -> Result<Quantity, Flaw> {
    let quantity = quantity(key, given)?;
    if quantity.relative {
        let what = "`relative` is for parameters of the drive alone".to_owned();
        return Err(at(given, Problem::Value { key: key.to_owned(), what }));
    }
    let (least, most) = quantity.bounds();
    let wrong = if least < low { Some(least) } else { (most > high).then_some(most) };
    match wrong {
        Some(value) => Err(out_of_range(given, key, value, allowed.to_owned())),
        None => Ok(quantity),
    }
}

fn parameters(
    layout: &Layout,
    drive: &Drive,
) -> Result<Vec<(drivescope_plant::parameters::NamedParameter, Quantity)>, Flaw> {
    let all = drive.parameters();
    let mut made = Vec::new();
    for (name, given) in &layout.parameters {
        let quantity = quantity(name.get_ref(), given)?;
        let known = all.iter().find(|parameter| parameter.name == *name.get_ref());
        let own = known.filter(|_| quantity.relative).map_or(1.0, |parameter| parameter.value);
        let (low, high) = quantity.bounds();
        let ends = [low, high, quantity.middle()].into_iter().filter(|end| end.is_finite());
        for end in ends {
            let place = if known.is_some() { given.span() } else { name.span() };
            let mut tried = drive.clone();
            tried
                .set(name.get_ref(), own * end)
                .map_err(|error| Flaw::new(Problem::Parameter(error), place))?;
        }
        if name.get_ref() == "controller.period" && !quantity.is_fixed() {
            let what = "the sampling time is that of all scenarios: give one value".to_owned();
            return Err(at(given, Problem::Value { key: name.get_ref().clone(), what }));
        }
        made.extend(known.cloned().map(|parameter| (parameter, quantity)));
    }
    Ok(made)
}
