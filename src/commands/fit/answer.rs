//! What `fit` answers: its JSON, and the same as text.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::PathBuf;

use drivescope_discovery::signals::SignalFinding;
use drivescope_discovery::{
    BothUnexplained, Estimate, Evaluated, Evidence, Fit, Fitted, NotIdentifiable, OutputFits,
    Setting, USUAL_BAND_HZ, output_fits, relative_force_error, unexplained, with_own,
};
use drivescope_plant::drive::{Drive, Motion};
use serde::Serialize;

use crate::evidence::Gathered;
use crate::read_evidence::{KnownNoise, unusable};
use crate::report::words::{balances, fit_percent, in_units_of_noise};

/// Correlation from which on two parameters are named together.
const STRONG: f64 = 0.9;
/// Standard error over value from which on the recordings hardly tell a parameter.
const HARDLY_TOLD: f64 = 0.5;

/// Errors of a drive on some recordings.
#[derive(Debug)]
pub(super) struct Judged {
    error: f64,
    each: Vec<f64>,
    own: Vec<Vec<Estimate>>,
    force: Option<f64>,
    fits: OutputFits,
}

impl Judged {
    pub(super) fn new(
        drive: &Drive,
        evidence: &Evidence,
        setting: &Setting,
        judged: &Evaluated,
    ) -> Self {
        Self::of((drive, setting), evidence, judged.squares.error(), &judged.recordings)
    }

    pub(super) fn of_fit(fitted: &Fitted, evidence: &Evidence, setting: &Setting) -> Self {
        Self::of((&fitted.drive, setting), evidence, fitted.squares.error(), &fitted.recordings)
    }

    fn of(
        (drive, setting): (&Drive, &Setting),
        evidence: &Evidence,
        error: f64,
        fits: &[Fit],
    ) -> Self {
        let pairs = evidence.recordings.iter().zip(fits);
        let forces: Option<Vec<f64>> = pairs
            .map(|(it, fit)| relative_force_error(&with_own(drive, fit), it, USUAL_BAND_HZ))
            .collect();
        Self {
            error,
            each: fits.iter().map(|fit| fit.squares.error()).collect(),
            own: fits.iter().map(|fit| fit.own.clone()).collect(),
            force: forces.map(|all| mean_square(&all)),
            fits: output_fits(drive, evidence, setting, fits),
        }
    }
}

fn mean_square(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64).sqrt()
}

/// The errors of the drive as it was given.
#[derive(Debug, Serialize)]
struct Before {
    error: Option<f64>,
    validation_error: Option<f64>,
}

#[derive(Debug, Serialize)]
struct Correlation {
    names: Vec<String>,
    matrix: Vec<Vec<f64>>,
    /// Pairs that can hardly be told apart.
    strong: Vec<(String, String, f64)>,
}

/// Of a force-driven drive: |K_m u - inverse dynamics| / |K_m u|.
#[derive(Debug, Serialize)]
struct ForceError {
    band_hz: f64,
    before: Option<f64>,
    after: f64,
    validation_before: Option<f64>,
    validation_after: Option<f64>,
}

/// Something of the drive as it was given and fitted, on the recordings of the fit and on those
/// that judge.
#[derive(Debug, Serialize)]
struct BeforeAndAfter<T> {
    before: T,
    after: T,
    validation_before: T,
    validation_after: T,
}

#[derive(Debug, Serialize)]
struct OfRecording {
    file: String,
    /// Whether it served to judge and not to fit.
    held_out: bool,
    values: usize,
    error: f64,
    noise: Vec<KnownNoise>,
    /// Parameters of this recording alone.
    own: Vec<Estimate>,
}

/// The answer of `fit`.
#[derive(Debug, Serialize)]
pub(super) struct Answer {
    drive: String,
    #[serde(skip)]
    motion: Motion,
    #[serde(skip_serializing_if = "Option::is_none")]
    output: Option<PathBuf>,
    parameters: BTreeMap<String, Estimate>,
    #[serde(skip)]
    order: Vec<String>,
    correlation: Correlation,
    not_identifiable: Vec<String>,
    kept: Vec<NotIdentifiable>,
    error: f64,
    validation_error: f64,
    before: Before,
    /// What the balances leave unexplained.
    unexplained: BeforeAndAfter<BothUnexplained>,
    /// Fit of each output, %; nothing of a drive that overflows.
    fit_percent: BeforeAndAfter<OutputFits>,
    /// Noise of the first recording, by output; each recording has its own below.
    noise: BTreeMap<&'static str, f64>,
    noise_source: BTreeMap<&'static str, drivescope_discovery::NoiseSource>,
    recordings: Vec<OfRecording>,
    split: String,
    /// What is wrong with the signals of the recordings, the gravest first.
    signals: Vec<SignalFinding>,
    doubts: Vec<String>,
    observer_hz: f64,
    noise_floor: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    relative_force_error: Option<ForceError>,
    block_s: f64,
    starts: usize,
    /// Whether the values are those of least squares on the balances.
    by_balances: bool,
    seed: u64,
}

impl Answer {
    pub(super) fn new(
        base: &Drive,
        output: Option<PathBuf>,
        gathered: &Gathered,
        fitted: &Fitted,
        setting: &Setting,
        (before, after): ([Option<Judged>; 2], [Judged; 2]),
        seed: u64,
    ) -> Self {
        let [validated, fitted_to] = [&after[1].fits, &after[0].fits].map(Clone::clone);
        let fits = |judged: &Option<Judged>| {
            judged.as_ref().map(|judged| judged.fits.clone()).unwrap_or_default()
        };
        let fit_percent = BeforeAndAfter {
            before: fits(&before[0]),
            after: fitted_to,
            validation_before: fits(&before[1]),
            validation_after: validated,
        };
        let error = |judged: &Option<Judged>| judged.as_ref().map(|judged| judged.error);
        let force = |judged: &Option<Judged>| judged.as_ref().and_then(|judged| judged.force);
        let relative_force_error = after[0].force.map(|now| ForceError {
            band_hz: USUAL_BAND_HZ,
            before: force(&before[0]),
            after: now,
            validation_before: force(&before[1]),
            validation_after: after[1].force,
        });
        let evidence = [&gathered.estimation, &gathered.validation];
        let all = base.parameters();
        // Also where the fitted drive was judged: before is what the user gave.
        let own = |own: &[Estimate]| {
            let given = |it: &Estimate| all.iter().find(|p| p.name == it.name).map(|p| p.value);
            own.iter()
                .map(|it| Estimate { before: given(it).unwrap_or(it.before), ..it.clone() })
                .collect()
        };
        let mut recordings = Vec::new();
        for (held_out, (evidence, judged)) in
            [false, true].into_iter().zip(evidence.into_iter().zip(&after))
        {
            for (k, measured) in evidence.recordings.iter().enumerate() {
                recordings.push(OfRecording {
                    file: measured.name.clone(),
                    held_out,
                    values: measured.values(),
                    error: judged.each[k],
                    noise: gathered.noise[recordings.len()].clone(),
                    own: own(&judged.own[k]),
                });
            }
        }
        let floors = gathered.estimation.recordings.iter().map(|it| setting.observer.floor(it));
        let of = |it: &Estimate| (it.name.clone(), it.clone());
        Self {
            drive: base.name.clone(),
            motion: base.motion,
            output,
            parameters: fitted.parameters.iter().map(of).collect(),
            order: fitted.parameters.iter().map(|it| it.name.clone()).collect(),
            correlation: correlation(fitted),
            not_identifiable: fitted
                .not_identifiable
                .iter()
                .map(|it| it.parameter.clone())
                .collect(),
            kept: fitted.not_identifiable.clone(),
            error: after[0].error,
            validation_error: after[1].error,
            before: Before { error: error(&before[0]), validation_error: error(&before[1]) },
            unexplained: BeforeAndAfter {
                before: unexplained(base, &gathered.estimation).into(),
                after: unexplained(&fitted.drive, &gathered.estimation).into(),
                validation_before: unexplained(base, &gathered.validation).into(),
                validation_after: unexplained(&fitted.drive, &gathered.validation).into(),
            },
            fit_percent,
            noise: gathered.noise[0].iter().map(|noise| (noise.name, noise.sd)).collect(),
            noise_source: gathered.noise[0]
                .iter()
                .map(|noise| (noise.name, noise.source))
                .collect(),
            recordings,
            split: gathered.split.clone(),
            signals: gathered.signals.clone(),
            doubts: gathered.doubts.clone(),
            observer_hz: setting.observer.hz,
            noise_floor: mean_square(&floors.collect::<Vec<_>>()),
            relative_force_error,
            block_s: fitted.block_s,
            starts: fitted.starts_tried,
            by_balances: fitted.by_balances,
            seed,
        }
    }

    /// The answer for a person.
    pub(super) fn text(&self) -> String {
        let mut text = unusable(&self.signals);
        self.setting(&mut text);
        self.table(&mut text);
        self.errors(&mut text);
        if self.by_balances {
            text.push_str(
                "the values are those of least squares on the balances: the least error of the \
                 observed motion would leave more torque unexplained\n",
            );
        }
        for it in &self.kept {
            let NotIdentifiable { parameter, kept, with } = it;
            let why = match with.as_slice() {
                [] => "nothing in the recordings depends on it".to_owned(),
                some => format!("only together with {}", some.join(", ")),
            };
            let _ = writeln!(text, "not identifiable: {parameter}, kept at {kept}: {why}");
        }
        for (name, share) in self.hardly_told() {
            let share = 100.0 * share;
            let _ = writeln!(
                text,
                "{name} is hardly told: its standard error is {share:.0} % of its value"
            );
        }
        for (a, b, rho) in &self.correlation.strong {
            let _ = writeln!(text, "{a} and {b} are hardly told apart: correlation {rho:.3}");
        }
        if !self.kept.is_empty() {
            let names = self.kept.iter().map(|it| it.parameter.as_str()).collect::<Vec<_>>();
            let _ = writeln!(
                text,
                "all other values and standard errors hold only if the kept {} right",
                match names.as_slice() {
                    [one] => format!("{one} is"),
                    some => format!("{} are", some.join(", ")),
                }
            );
        }
        if let Some(output) = &self.output {
            let _ = writeln!(text, "written: {}", output.display());
        }
        text
    }

    /// Parameters of the motor, which are positive, whose standard errors are that large a share
    /// of them.
    fn hardly_told(&self) -> impl Iterator<Item = (&str, f64)> {
        let of_motor = self.order.iter().filter(|name| !name.contains('.'));
        of_motor.filter_map(|name| {
            let Estimate { value, std_error, .. } = self.parameters.get(name)?;
            let share = std_error / value.abs();
            (share >= HARDLY_TOLD).then_some((name.as_str(), share))
        })
    }

    fn setting(&self, text: &mut String) {
        let files = |held_out: bool| {
            let some = self.recordings.iter().filter(|it| it.held_out == held_out);
            some.map(|it| it.file.as_str()).collect::<Vec<_>>().join(", ")
        };
        let name = if self.drive.is_empty() { "the drive" } else { &self.drive };
        let _ = writeln!(text, "{name}, fitted to {}", files(false));
        let _ = writeln!(text, "{}", self.split);
        for it in &self.recordings {
            for KnownNoise { name, sd, unit, source } in &it.noise {
                let how = format!("{source:?}").to_lowercase();
                let _ = writeln!(text, "noise of {name} in {}: {sd:.4e} {unit} ({how})", it.file);
            }
        }
        let _ = match self.observer_hz {
            0.0 => writeln!(text, "free run from u; the noise floor of the error is 1"),
            hz => writeln!(
                text,
                "observer of {hz} Hz, frozen; the noise floor of the error is {:.3}",
                self.noise_floor
            ),
        };
    }

    fn table(&self, text: &mut String) {
        let row = |name: &str, value: &str, error: &str, before: &str, unit: &str| {
            format!("  {name:<20} {value:>13} {error:>12} {before:>13}  {unit}")
                .trim_end()
                .to_owned()
                + "\n"
        };
        text.push_str(&row("parameter", "value", "std error", "before", "unit"));
        let line = |it: &Estimate, name: &str| {
            let error = match it.at_bound {
                true => "at its bound".to_owned(),
                false => format!("{:.2e}", it.std_error),
            };
            row(name, &short(it.value), &error, &short(it.before), &it.unit)
        };
        for name in &self.order {
            text.push_str(&line(&self.parameters[name], name));
        }
        for it in &self.recordings {
            for own in &it.own {
                let _ = write!(text, "{}", line(own, &own.name));
                let _ = writeln!(text, "    in {}", it.file);
            }
        }
    }

    fn errors(&self, text: &mut String) {
        let told = self.left(text);
        let in_reach = in_units_of_noise(self.error) && in_units_of_noise(self.validation_error);
        if told && !in_reach {
            return;
        }
        let mut line = |what: &str, before, after| compared(text, what, before, after);
        line("error in units of the noise, estimation", self.before.error, self.error);
        line(
            "error in units of the noise, validation",
            self.before.validation_error,
            self.validation_error,
        );
    }

    /// What people know first, what is left of torque, voltage and force; whether there is any.
    fn left(&self, text: &mut String) -> bool {
        let already = text.len();
        let it = &self.unexplained;
        let all = [it.before, it.after, it.validation_before, it.validation_after];
        let [before, after, validation_before, validation_after] =
            all.map(|it| balances(self.motion, &it));
        for place in 0..before.len() {
            let balance = before[place].0;
            for (data, before, after) in [
                ("estimation", before[place].1, after[place].1),
                ("validation", validation_before[place].1, validation_after[place].1),
            ] {
                let Some((before, after)) = before.zip(after) else { continue };
                let what = format!("unexplained {balance}, {data}");
                let [before, after] = [before, after].map(|it| 100.0 * it.share);
                let _ = writeln!(text, "{what:<42} {before:>8.1} % -> {after:.1} %");
            }
        }
        let it = &self.fit_percent;
        for (data, before, after) in [
            ("estimation", &it.before, &it.after),
            ("validation", &it.validation_before, &it.validation_after),
        ] {
            for (name, after) in after.iter().filter_map(|(name, fit)| Some((name, (*fit)?))) {
                let before = before.get(name).copied().flatten().unwrap_or(f64::NEG_INFINITY);
                let what = format!("fit of {name}, {data}");
                let [before, after] = [before, after].map(fit_percent);
                let _ = writeln!(text, "{what:<42} {before:>10} -> {after}");
            }
        }
        let mut line = |what: &str, before, after| compared(text, what, before, after);
        if let Some(force) = &self.relative_force_error {
            let what = |of: &str| format!("relative force error below {} Hz, {of}", force.band_hz);
            line(&what("estimation"), force.before, force.after);
            if let Some(after) = force.validation_after {
                line(&what("validation"), force.validation_before, after);
            }
        }
        text.len() > already
    }
}

/// A line: an error before and after.
fn compared(text: &mut String, what: &str, before: Option<f64>, after: f64) {
    let before = before.map_or("overflow".to_owned(), |before| format!("{before:.4}"));
    let _ = writeln!(text, "{what:<42} {before:>10} -> {after:.4}");
}

/// A value with the digits that a table has room for.
fn short(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 || (1e-3..1e5).contains(&size) {
        format!("{value:.6}")
    } else {
        format!("{value:.5e}")
    }
}

fn correlation(fitted: &Fitted) -> Correlation {
    let names: Vec<String> = fitted.parameters.iter().map(|it| it.name.clone()).collect();
    let matrix: Vec<Vec<f64>> =
        fitted.correlation.row_iter().map(|row| row.iter().copied().collect()).collect();
    let mut strong = Vec::new();
    for (j, row) in matrix.iter().enumerate() {
        for (k, rho) in row.iter().enumerate().take(j) {
            if rho.abs() >= STRONG {
                strong.push((names[k].clone(), names[j].clone(), *rho));
            }
        }
    }
    Correlation { names, matrix, strong }
}
