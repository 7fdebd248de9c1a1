//! The detectors of a diagnoser over rows of one signal set, in memory that grows only with declarations.

use std::sync::Arc;

use drivescope_diagnoser::{
    Band, Confidence, Data, Detector, Diagnoser, KnownFaults, LagRun, ModelRun, Naming,
    OperatingRange, RangeWatch, RunRule, ThresholdRun, WindowWatch,
};
use miette::Result;

use super::answer::{Declared, Fault, Found};
use super::declaration::Declaration;
use super::method::Method;
use super::outside::Outside;
use crate::failure::{Failure, told};

/// A detector with what it found so far.
struct Watching {
    detector: Detector<ModelRun, ThresholdRun>,
    rule: RunRule,
    /// Its error model explains nothing: it is not used.
    refused: bool,
    /// What the residual of this machine and day is off by.
    offset: f64,
    /// Time of the last sample outside.
    last_outside: f64,
    counted: Outside,
    found: Found,
    standing: bool,
}

/// Windows of the residual at work.
struct OfWindows {
    watch: WindowWatch,
    model: LagRun,
    /// Time of the last window outside.
    last_outside: f64,
    counted: Outside,
    found: Found,
    standing: bool,
}

/// The methods at work, and the naming of what the one that was asked for declares.
pub(super) struct Watch {
    watching: Vec<Watching>,
    windows: Option<OfWindows>,
    range: Option<RangeWatch>,
    asked: Method,
    known: Option<Arc<KnownFaults>>,
    /// T of (27).
    threshold: Band,
    /// Symptoms of the fault that stands declared.
    naming: Option<Naming>,
    window: usize,
    period_s: f64,
    /// Samples that settle the models of a segment.
    settling: usize,
    /// Samples that settle the models, of all segments.
    run_up: usize,
    samples: usize,
    /// Samples beyond the operating range, run-up excluded.
    beyond: usize,
    /// Samples of the segment at hand.
    of_segment: usize,
}

/// What a sample brought.
pub(super) enum Event {
    /// A method declares a fault.
    Declared(Method),
    /// A window after the declaration, what the fault is.
    Named(Fault),
}

/// What all methods found.
pub(super) struct Finished {
    pub(super) samples: usize,
    pub(super) run_up: usize,
    pub(super) beyond: usize,
    pub(super) methods: Vec<Found>,
}

fn found(method: Method, beta: Option<f64>) -> Found {
    Found {
        method,
        beta,
        verdict: "not_judged",
        judged: 0,
        outside: 0,
        exceedance_rate: None,
        declared: Vec::new(),
        declarations: Vec::new(),
    }
}

impl OfWindows {
    /// Takes a sample, of that number. Whether a fault is declared with it.
    fn step(&mut self, (u, y, time): (&[f64], f64, f64), (sample, beyond): (usize, bool)) -> bool {
        let residual = y - self.model.step(u);
        if beyond {
            self.watch.reset();
        }
        let Some(outside) = self.watch.step(residual).filter(|_| !beyond) else {
            end(&mut self.found, self.last_outside, &mut self.standing);
            return false;
        };
        self.counted.step(1, usize::from(outside));
        let mut was_standing = std::mem::replace(&mut self.standing, outside);
        let begins = outside && !was_standing;
        if begins {
            self.found.declared.push(Declared { sample, time, fault: None });
            self.found.declarations.push(Declaration::unknown(time, time));
        }
        if outside {
            self.last_outside = time;
        } else {
            end(&mut self.found, self.last_outside, &mut was_standing);
        }
        begins
    }

    /// A new segment begins.
    fn begin(&mut self) {
        self.watch.reset();
        self.model.reset();
        end(&mut self.found, self.last_outside, &mut self.standing);
    }
}

impl Watch {
    /// The methods of a diagnoser; `baseline` is a healthy run of the machine or day, and its name.
    pub(super) fn new(
        diagnoser: &Diagnoser,
        asked: Method,
        beta: Option<f64>,
        baseline: Option<(&str, &Data)>,
    ) -> Result<Self> {
        let confidence = match beta {
            Some(beta) => Confidence::new(beta).map_err(told)?,
            None => diagnoser.confidence,
        };
        let has = |method: &Method| match method {
            Method::MemRecurrent => diagnoser.recurrent_error.is_some(),
            Method::Gmdh => diagnoser.gmdh.is_some(),
            _ => true,
        };
        let methods = Method::OF_PAPER.into_iter().filter(has);
        let watching = methods.filter_map(|method| Some((method, method.of_paper()?.kind())));
        let watching = watching.map(|(method, kind)| {
            let mut detector = diagnoser.detector_at(kind, confidence).map_err(told)?;
            let beta = (method != Method::Gmdh).then_some(confidence.beta());
            let offset = match baseline {
                Some((_, data)) => offset(&mut detector, data, diagnoser.run_up)?,
                None => 0.0,
            };
            detector.reset();
            Ok(Watching {
                refused: !diagnoser.explains(kind) && method != asked,
                detector,
                rule: RunRule::new(diagnoser.window),
                offset,
                last_outside: 0.0,
                counted: Outside::default(),
                found: found(method, beta),
                standing: false,
            })
        });
        let watching = watching.collect::<Result<_>>()?;
        let windows = diagnoser.windows.as_ref().zip(baseline).map(|(windows, (name, data))| {
            let of_baseline = match windows.baseline_of(data) {
                Ok(of_baseline) => of_baseline,
                // What others are asked for may begin from rest.
                Err(_) if asked != Method::Windows => return Ok(None),
                Err(error) => {
                    return Err(Failure::Usage {
                        what: format!("{name}: {error}"),
                        instead: "give a --baseline of this machine that runs healthily, about \
                                  4 s of it"
                            .to_owned(),
                    });
                }
            };
            Ok(Some(OfWindows {
                watch: windows.watch(of_baseline),
                model: LagRun::new(windows.model.clone()),
                last_outside: 0.0,
                counted: Outside::default(),
                found: found(Method::Windows, None),
                standing: false,
            }))
        });
        let windows = windows.transpose()?.flatten();
        let window = diagnoser.window;
        let of_baseline = baseline.and_then(|(_, data)| {
            let begun = if starts_up(data.len(), diagnoser.run_up) { diagnoser.run_up } else { 0 };
            OperatingRange::of(&[&data.settled(begun)], window)
        });
        let range = diagnoser.range.as_ref().map(|range| match &of_baseline {
            Some(other) => range.and(other),
            None => range.clone(),
        });
        Ok(Self {
            watching,
            windows,
            range: range.map(OperatingRange::watch),
            asked,
            known: diagnoser.faults.clone(),
            threshold: diagnoser.constant.band(diagnoser.confidence),
            naming: None,
            window,
            period_s: diagnoser.interface.period_s,
            settling: diagnoser.run_up,
            run_up: 0,
            samples: 0,
            beyond: 0,
            of_segment: 0,
        })
    }

    /// A new segment begins: the models settle anew, what was found stays.
    pub(super) fn begin(&mut self) {
        self.close();
        for Watching { rule, standing, found, last_outside, .. } in &mut self.watching {
            rule.reset();
            end(found, *last_outside, standing);
        }
        if let Some(windows) = &mut self.windows {
            windows.begin();
        }
        self.range.iter_mut().for_each(RangeWatch::reset);
        self.naming = None;
    }

    fn close(&mut self) {
        self.run_up += self.settling.min(self.of_segment);
        self.of_segment = 0;
    }

    /// Takes a sample.
    pub(super) fn step(&mut self, u: &[f64], y: f64, time: f64) -> Result<Vec<Event>> {
        let mut events = Vec::new();
        let (mut residual, mut stands) = (f64::NAN, false);
        let settled = self.of_segment >= self.settling;
        let beyond = self.range.as_mut().is_some_and(|range| range.step(u, y));
        self.beyond += usize::from(beyond && settled);
        let first = self.of_segment == 0;
        for watching in &mut self.watching {
            let Watching {
                detector,
                rule,
                offset,
                last_outside,
                counted,
                found,
                standing,
                refused,
            } = watching;
            if *refused {
                continue;
            }
            if first {
                detector.settle(u).map_err(told)?;
            }
            let verdict = detector.step(u, y - *offset).map_err(told)?;
            let exceeds = verdict.exceeds && !beyond;
            if settled && !beyond {
                counted.step(1, usize::from(exceeds));
            }
            if exceeds {
                *last_outside = time;
            }
            let declared = rule.step(exceeds);
            if declared && !*standing {
                let sample = self.samples + 1;
                found.declared.push(Declared { sample, time, fault: None });
                let from = time - (self.window as f64 - 1.0) * self.period_s;
                found.declarations.push(Declaration::unknown(from, time));
                events.push(Event::Declared(found.method));
                if found.method == self.asked {
                    self.naming =
                        self.known.clone().map(|known| Naming::new(known, self.threshold));
                }
            }
            if declared {
                *standing = true;
            } else {
                end(found, *last_outside, standing);
            }
            // Symptoms are residuals of the process model; a GMDH network has others.
            if found.method == Method::Constant {
                residual = verdict.residual;
            }
            stands |= declared && verdict.exceeds && found.method == self.asked;
        }
        if let Some(windows) = &mut self.windows {
            let declared = windows.step((u, y, time), (self.samples + 1, beyond));
            events.extend(declared.then_some(Event::Declared(Method::Windows)));
        }
        self.samples += 1;
        self.of_segment += 1;
        if stands {
            events.extend(self.name(u, residual)?);
        }
        Ok(events)
    }

    /// Takes a symptom of the fault that stands declared.
    fn name(&mut self, u: &[f64], residual: f64) -> Result<Option<Event>> {
        let (Some(naming), Some(known)) = (&mut self.naming, &self.known) else { return Ok(None) };
        naming.step(u, residual).map_err(told)?;
        let Some(named) = naming.named() else { return Ok(None) };
        let fault = Fault::new(known, &named);
        let of_asked =
            self.watching.iter_mut().find(|watching| watching.found.method == self.asked);
        if let Some(found) = of_asked.map(|watching| &mut watching.found) {
            if let Some(declared) = found.declared.last_mut() {
                declared.fault = Some(fault.clone());
            }
            if let Some(declaration) = found.declarations.last_mut() {
                declaration.set = fault.names();
                declaration.mechanism.clone_from(&fault.class);
            }
        }
        Ok((named.samples == self.window).then_some(Event::Named(fault)))
    }

    /// What every method found.
    pub(super) fn finish(mut self) -> Finished {
        self.close();
        let (samples, run_up, beyond) = (self.samples, self.run_up, self.beyond);
        // Most of the run was never shown.
        let unknown = 2 * beyond > samples.saturating_sub(run_up);
        let of_paper = self.watching.into_iter().map(|watching| (watching.found, watching.counted));
        let windows = self.windows.into_iter().map(|windows| (windows.found, windows.counted));
        let methods = windows.chain(of_paper).map(|(mut found, counted)| {
            found.judged = counted.judged;
            found.outside = counted.outside;
            found.exceedance_rate = counted.share();
            found.verdict = if !found.declarations.is_empty() {
                "fault"
            } else if unknown || counted.judged == 0 {
                "not_judged"
            } else if found.beta.is_some_and(|beta| counted.is_abnormal(beta)) {
                "abnormal"
            } else {
                "healthy"
            };
            found
        });
        Finished { samples, run_up, beyond, methods: methods.collect() }
    }
}

/// Ends the declaration that stands, if one does, with its last sample outside.
fn end(found: &mut Found, last_outside: f64, standing: &mut bool) {
    if std::mem::take(standing)
        && let Some(last) = found.declarations.last_mut()
    {
        last.to = Some(last_outside.max(last.from));
    }
}

/// Whether a healthy run is long enough to leave out what may be its start from rest.
fn starts_up(samples: usize, run_up: usize) -> bool {
    samples > 2 * run_up
}

/// What the middle of a detector's band is off the residual by, over a baseline.
fn offset(
    detector: &mut Detector<ModelRun, ThresholdRun>,
    data: &Data,
    run_up: usize,
) -> Result<f64> {
    let (mut sum, mut taken) = (0.0, 0.0);
    let mut u = vec![0.0; data.inputs().len()];
    for segment in data.segments() {
        for k in segment.clone() {
            u.iter_mut().zip(data.inputs()).for_each(|(u, column)| *u = column.values[k]);
            if k == segment.start {
                detector.settle(&u).map_err(told)?;
            }
            let verdict = detector.step(&u, data.output().values[k]).map_err(told)?;
            if !starts_up(segment.len(), run_up) || k - segment.start >= run_up {
                sum += verdict.residual - 0.5 * (verdict.lower + verdict.upper);
                taken += 1.0;
            }
        }
    }
    Ok(sum / f64::max(taken, 1.0))
}
