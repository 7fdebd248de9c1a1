//! `simulate`: a run of a drive, from typed signals or from a recording.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use drivescope_discovery::{driving, with_canonical_names};
use drivescope_plant::drive::{Drive, Motion};
use drivescope_plant::sampled::speed_bound;
use drivescope_recording::{MOST_NUMBERS, Quantity, Recording, rounded};
use serde::Serialize;

use super::Run;
use super::recording_options::RecordingOptions;
use crate::drive_source;
use crate::expression::SignalOverTime;
use crate::failure::{Ending, Failure, into_report};
use crate::next::Next;
use crate::session::Session;
use crate::simulation::fault::FaultOverTime;
use crate::simulation::replay::{Fit, fits, replay, start};
use crate::simulation::typed::{self, Driven};
use crate::simulation::{speed, tacho_unit, without_noise};

/// Run the model of a drive and write a recording.
#[derive(Debug, Args)]
pub(crate) struct Simulate {
    /// Drive file, or a built-in drive (`dr300`, `emps`).
    drive: String,
    /// Recording to write (.csv).
    #[arg(short, long, value_name = "REC")]
    output: PathBuf,
    /// Drive the model by the u of this recording and compare with what it measured.
    #[arg(long, value_name = "REC", conflicts_with_all = ["reference", "input", "duration", "load", "fault", "period"])]
    measured: Option<PathBuf>,
    /// Speed for the controller to follow, a law in t: rad/s (m/s), or as in `2000 [rpm]`; by
    /// default about half the no-load speed.
    #[arg(long, value_name = "EXPR", conflicts_with = "input", allow_hyphen_values = true)]
    reference: Option<String>,
    /// u, a law in t: the loop stays open.
    #[arg(long, value_name = "EXPR", allow_hyphen_values = true)]
    input: Option<String>,
    /// Length of the run, s.
    #[arg(long, value_name = "S", default_value_t = 5.0, allow_negative_numbers = true)]
    duration: f64,
    /// Load torque (force), a law in t, N m (N).
    #[arg(long, value_name = "EXPR", allow_hyphen_values = true)]
    load: Option<String>,
    /// A fault, such as `tacho=5%@2..3`; may be given several times. It acts with full size, or as
    /// its profile says: `:ramp=5` grows for 5 s, `:pulses=0.1/1` acts for 0.1 s of every 1 s,
    /// `:intermittent=0.5/2` comes for 0.5 s and goes for 2 s on average.
    #[arg(long, value_name = "KIND=SIZE[@FROM[..[TO]]][:PROFILE]")]
    fault: Vec<FaultOverTime>,
    /// Sampling time, s; by default that of the controller, or 1 ms.
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    period: Option<f64>,
    /// Noise and quantisation of the sensors, disturbances.
    #[arg(long, value_name = "ON|OFF", default_value = "on", hide_possible_values = true)]
    noise: Switch,
    #[command(flatten)]
    reading: RecordingOptions,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Switch {
    On,
    Off,
}

/// Sampling time without a controller, s.
const USUAL_PERIOD: f64 = 1e-3;
/// Columns of a recording, time and a load included.
const MOST_COLUMNS: usize = 10;
/// Samples beyond which a recording would be too large to be read again.
const MOST_SAMPLES: usize = MOST_NUMBERS / MOST_COLUMNS;

#[derive(Debug, Serialize)]
struct Simulated {
    drive: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    output: Option<PathBuf>,
    samples: usize,
    start: f64,
    period: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    reference: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    seed: Option<u64>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    fit: Vec<Fit>,
}

impl Run for Simulate {
    fn run(self, session: &Session) -> miette::Result<Ending> {
        let drive = drive_source::drive(&self.drive)?;
        session.check_writable(&[&self.output])?;
        match &self.measured {
            Some(measured) => self.replayed(&drive, measured, session)?,
            None => self.typed(drive, session)?,
        }
        Ok(Ending::Done)
    }
}

impl Simulate {
    fn replayed(&self, drive: &Drive, measured: &Path, session: &Session) -> miette::Result<()> {
        let (measured, report) = self.reading.read(measured, session)?;
        let (what, driver) = driving(drive, &measured).map_err(into_report)?;
        let load = measured.signal("T_l").map(|load| load.name.as_str());
        let needed: Vec<&str> = [Some(driver.name.as_str()), load].into_iter().flatten().collect();
        report.require(&measured, &needed).map_err(into_report)?;
        if let Some(remark) = what.remark() {
            session.remark(format_args!("{}: {remark}", measured.name));
        }
        let measured = with_canonical_names(drive, measured);
        let drive = without_noise(drive);
        let start = start(&drive, &measured)?;
        let bar = session.progress(measured.len() as u64, "simulating");
        let model = replay(&drive, &measured, start, &bar)?;
        let fit = fits(&measured, &model);
        let mut text = format!("{}, driven by {}\n", title(&drive), measured.name);
        for Fit { signal, percent, rms, unit } in &fit {
            let percent =
                percent.map_or("constant".to_owned(), |percent| format!("{percent:.2} %"));
            text.push_str(&format!(
                "  {signal:<8} fit {percent:>9}   rms difference {rms:.4} {unit}\n"
            ));
        }
        if fit.is_empty() {
            text.push_str(
                "  nothing to compare: the recording has no current, speed or position\n",
            );
        }
        self.answer(text, &drive, model, fit, (None, None), session)
    }

    fn typed(&self, drive: Drive, session: &Session) -> miette::Result<()> {
        let drive = if self.noise == Switch::Off { without_noise(&drive) } else { drive };
        let closed = drive.controller.is_some() && self.input.is_none();
        let period_s = self.period_s(&drive, closed)?;
        let samples = self.samples(period_s)?;
        self.check_faults(samples, period_s)?;
        let quantity = match drive.motion {
            Motion::Rotary => (Quantity::AngularSpeed, Quantity::Torque),
            Motion::Linear => (Quantity::Speed, Quantity::Force),
        };
        let (driven, reference) = match (&self.input, &self.reference) {
            (Some(text), _) => {
                let u = SignalOverTime::parse("--input", text, Quantity::Voltage)?;
                (Driven::Input(u.sampled("--input", period_s, samples)?), None)
            }
            (None, _) if !closed => {
                let what =
                    format!("{} has no controller that could follow a reference", title(&drive));
                return Err(usage(what, "say what u is: --input 'EXPR', or --measured REC"));
            }
            (None, given) => {
                let text = given.clone().unwrap_or_else(|| usual_reference(&drive));
                let speed = SignalOverTime::parse("--reference", &text, quantity.0)?;
                (
                    Driven::Reference(speed.sampled("--reference", period_s, samples)?),
                    Some(speed.text),
                )
            }
        };
        let load = self.load.as_deref().map(|text| {
            SignalOverTime::parse("--load", text, quantity.1)?.sampled("--load", period_s, samples)
        });
        let run = typed::Run {
            load: load.transpose()?,
            faults: self.fault.clone(),
            period_s,
            seed: session.seed,
            driven,
            drive,
        };
        let recording = run.simulate(&session.progress(samples as u64, "simulating"))?;
        let how = match &reference {
            Some(text) if self.reference.is_none() => format!("reference {text} (by default)"),
            Some(text) => format!("reference {text}"),
            None => format!("open loop, u = {}", self.input.as_deref().unwrap_or_default()),
        };
        let text = format!("{}, {how}\n", title(&run.drive));
        let drawn = (self.noise == Switch::On).then_some(session.seed);
        self.answer(text, &run.drive, recording, Vec::new(), (reference, drawn), session)
    }

    fn period_s(&self, drive: &Drive, closed: bool) -> miette::Result<f64> {
        let own = drive.controller.filter(|_| closed).and_then(|controller| controller.period);
        match (self.period, own) {
            (Some(period), _) if !(period.is_finite() && period > 0.0) => Err(usage(
                format!("--period {period}: not a time above 0 s"),
                "give seconds, such as 0.001",
            )),
            (Some(period), Some(own)) if period != own => Err(usage(
                format!(
                    "--period {period}: the controller samples every {own} s, and the recording with it"
                ),
                "leave --period out, or change the controller's period in the drive file",
            )),
            (given, own) => Ok(given.or(own).unwrap_or(USUAL_PERIOD)),
        }
    }

    fn samples(&self, period_s: f64) -> miette::Result<usize> {
        let steps = (self.duration / period_s).round();
        if !(1.0..MOST_SAMPLES as f64).contains(&steps) {
            let what = format!(
                "--duration {}: {} samples of {} s",
                rounded(self.duration),
                rounded(steps),
                rounded(period_s)
            );
            return Err(usage(what, &format!("between 1 and {MOST_SAMPLES} can be recorded")));
        }
        // Both ends are recorded.
        Ok(steps as usize + 1)
    }

    /// A fault that never acts would be a healthy run under the name of a faulty one.
    fn check_faults(&self, samples: usize, period_s: f64) -> miette::Result<()> {
        let beside = self.fault.iter().find(|fault| !fault.is_within(samples, period_s));
        beside.map_or(Ok(()), |fault| {
            let (from, duration) = (rounded(fault.from_s), rounded(self.duration));
            let to = fault.to_s.is_finite().then(|| format!("..{}", rounded(fault.to_s)));
            let what = format!(
                "--fault {}={}@{from}{}: no sample of the run of {duration} s lies there",
                fault.mechanism.id,
                rounded(fault.size),
                to.unwrap_or_default()
            );
            Err(usage(what, "let it begin earlier, or make the run longer: --duration S"))
        })
    }

    /// Writes the recording and tells of it.
    fn answer(
        &self,
        text: String,
        drive: &Drive,
        recording: Recording,
        fit: Vec<Fit>,
        (reference, seed): (Option<String>, Option<u64>),
        session: &Session,
    ) -> miette::Result<()> {
        let (samples, period) = (recording.len(), recording.period_s);
        let start = recording.start_s;
        session.write_recording(&self.output, recording)?;
        let output = session.named(&self.output);
        let file = output.as_ref().map_or(String::new(), |it| format!(": {}", it.display()));
        let text = format!("{text}{samples} samples every {} s{file}\n", rounded(period));
        let drive = drive.name.clone();
        let measured = self.measured.as_ref().unwrap_or(&self.output);
        let next = Next::new("compare").with(&self.drive).files([measured]);
        session.wrote(
            &text,
            &Simulated { drive, output, samples, start, period, reference, seed, fit },
            &next,
        )?;
        Ok(())
    }
}

fn title(drive: &Drive) -> &str {
    if drive.name.is_empty() { "the drive" } else { &drive.name }
}

fn usage(what: String, instead: &str) -> miette::Report {
    Failure::Usage { what, instead: instead.to_owned() }.into()
}

/// Half the no-load speed to one digit, in the unit of the tachometer.
fn usual_reference(drive: &Drive) -> String {
    let per_si = drive.sensors.tacho_unit.per_si();
    let half = 0.5 * speed_bound(drive) * per_si;
    let scale = 10f64.powf(half.log10().floor());
    let rounded = (half / scale).round() * scale;
    let unit = if per_si == 1.0 { speed(drive).1 } else { tacho_unit(drive) };
    format!("{rounded} [{unit}]")
}
