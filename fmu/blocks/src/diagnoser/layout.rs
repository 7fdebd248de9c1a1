//! The variables of an exported diagnoser, in their order.

use drivescope_diagnoser::bank::{BankDesign, SENSORS, TWO_SIDED_95};
use drivescope_diagnoser::{Channel, Diagnoser};
use drivescope_monitor::bank::{CURRENTS, DRIVING};
use drivescope_monitor::{Method, Monitor, STUCK, Standing, UNKNOWN};

/// Code of a fault that is none of the known ones.
pub(super) const UNKNOWN_CODE: f64 = -1.0;
/// Faults that the bits of a set stand for.
pub(super) const BITS: usize = 30;

/// What a variable is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Of {
    /// A signal that is measured.
    Signal(usize),
    Valid,
    Beta,
    HasCurrent,
    Rows,
    RowTime,
    Decision,
    Declared,
    Alarms,
    Mechanism,
    Set,
    Size,
    Lower,
    Upper,
    Onset,
    Noticed,
    /// Of a detector of the residual.
    Detector(Method, Part),
    /// Of a sensor of the bank.
    Innovation(usize, Part),
    Ratio,
    RatioLimit,
    Squares,
    SquaresLimit,
}

/// A part of what a detector shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Part {
    Residual,
    Lower,
    Upper,
    Outside,
    Declared,
}

impl Part {
    pub(super) const OF_DETECTOR: [Self; 5] =
        [Self::Residual, Self::Lower, Self::Upper, Self::Outside, Self::Declared];
    pub(super) const OF_SENSOR: [Self; 3] = [Self::Residual, Self::Lower, Self::Upper];
}

/// Signals, variables and codes of a diagnoser.
#[derive(Debug)]
pub(super) struct Layout {
    /// Name and unit of each signal.
    pub(super) signals: Vec<(String, String)>,
    /// Which of them is the current of the bank.
    pub(super) current: Option<usize>,
    /// The method whose decisions are the outputs.
    pub(super) asked: Method,
    /// Faults by their codes, from 1 on.
    pub(super) faults: Vec<String>,
    /// Unit of the sizes of each fault.
    pub(super) units: Vec<String>,
    pub(super) of: Vec<Of>,
}

impl Layout {
    pub(super) fn new(diagnoser: &Diagnoser, baseline: bool) -> Self {
        let asked = Method::best(diagnoser, baseline);
        let interface = &diagnoser.interface;
        let channels = interface.inputs.iter().chain([&interface.output]);
        let mut signals: Vec<(String, String)> =
            channels.map(|Channel { name, unit }| (name.clone(), unit.clone())).collect();
        let mut current = None;
        if let Some(bank) = &diagnoser.bank {
            let mut need = |names: &[&str], unit: &str| {
                let at = signals.iter().position(|(name, _)| names.contains(&&**name));
                at.unwrap_or_else(|| {
                    signals.push((names[0].to_owned(), unit.to_owned()));
                    signals.len() - 1
                })
            };
            need(&DRIVING, "V");
            current = bank.limits_without_current.map(|_| need(&CURRENTS, "A"));
        }
        let known = diagnoser.faults.as_ref().map(|known| known.isolator.faults.clone());
        let (faults, units) = match &diagnoser.bank {
            Some(bank) if asked == Method::Bank => of_bank(bank),
            _ => known.map_or_else(Default::default, |faults| {
                let units = vec![String::new(); faults.len()];
                (faults, units)
            }),
        };
        let mut of: Vec<Of> = (0..signals.len()).map(Of::Signal).collect();
        of.extend([Of::Valid, Of::Beta]);
        of.extend(current.map(|_| Of::HasCurrent));
        of.extend([Of::Rows, Of::RowTime, Of::Decision, Of::Declared, Of::Alarms, Of::Mechanism]);
        of.extend([Of::Set, Of::Size, Of::Lower, Of::Upper, Of::Onset, Of::Noticed]);
        for method in Method::all() {
            let used = match method {
                // It has outputs of its own.
                Method::Bank => false,
                Method::Windows => true,
                Method::Residual(kind) => method == asked || diagnoser.explains(kind),
            };
            if used && method.is_held(diagnoser, baseline) {
                of.extend(Part::OF_DETECTOR.map(|part| Of::Detector(method, part)));
            }
        }
        if diagnoser.bank.is_some() {
            // Where the control effort is known, the voltage is not looked at.
            for sensor in 0..SENSORS - 1 {
                if sensor == 0 || current.is_some() {
                    of.extend(Part::OF_SENSOR.map(|part| Of::Innovation(sensor, part)));
                }
            }
            of.extend([Of::Ratio, Of::RatioLimit, Of::Squares, Of::SquaresLimit]);
        }
        Self { signals, current, asked, faults, units, of }
    }

    /// Code of a fault: its place from 1 on.
    fn code(&self, name: &str) -> f64 {
        let at = self.faults.iter().position(|fault| fault == name);
        at.map_or(UNKNOWN_CODE, |at| (at + 1) as f64)
    }

    /// The value of an output; 0 before the run.
    pub(super) fn value(&self, of: Of, monitor: Option<&Monitor>) -> f64 {
        let Some(monitor) = monitor else { return 0.0 };
        match of {
            Of::Detector(method, part) => {
                let Some(shown) = monitor.shown(method) else { return 0.0 };
                match part {
                    Part::Residual => shown.residual,
                    Part::Lower => shown.lower,
                    Part::Upper => shown.upper,
                    Part::Outside => f64::from(u8::from(shown.outside)),
                    Part::Declared => f64::from(u8::from(shown.standing)),
                }
            }
            Of::Innovation(sensor, part) => {
                let Some((statistics, _)) = monitor.statistics() else { return 0.0 };
                match part {
                    Part::Lower => -TWO_SIDED_95,
                    Part::Upper => TWO_SIDED_95,
                    _ => statistics.innovation[sensor],
                }
            }
            Of::Ratio | Of::RatioLimit | Of::Squares | Of::SquaresLimit => {
                let Some((statistics, limits)) = monitor.statistics() else { return 0.0 };
                match of {
                    Of::Ratio => statistics.ratio,
                    Of::RatioLimit => limits.ratio,
                    Of::Squares => statistics.squares,
                    _ => limits.squares,
                }
            }
            _ => monitor.standing(self.asked).map_or(0.0, |standing| self.standing(of, &standing)),
        }
    }

    fn standing(&self, of: Of, standing: &Standing) -> f64 {
        let Standing { state, declared, declaration } = *standing;
        match of {
            Of::Decision => return state.code() as f64,
            // It stands while a further alarm is being judged, too.
            Of::Declared => return f64::from(u8::from(declaration.is_some())),
            Of::Alarms => return declared as f64,
            _ => {}
        }
        let Some(declaration) = declaration else { return 0.0 };
        let interval = declaration.interval.unwrap_or_default();
        match of {
            // A class of several faults that look alike is told by the first.
            Of::Mechanism if declaration.mechanism == UNKNOWN => UNKNOWN_CODE,
            Of::Mechanism => {
                let first = declaration.set.first().unwrap_or(&declaration.mechanism);
                let named = self.code(&declaration.mechanism);
                if named == UNKNOWN_CODE { self.code(first) } else { named }
            }
            Of::Set => {
                let codes = declaration.set.iter().map(|name| self.code(name) as usize);
                let bits = codes.filter(|code| (1..=BITS).contains(code));
                bits.fold(0, |all: u32, code| all | 1 << (code - 1)).into()
            }
            Of::Size => declaration.size.unwrap_or(0.0),
            Of::Lower => interval[0],
            Of::Upper => interval[1],
            Of::Onset => declaration.from,
            Of::Noticed => declaration.noticed,
            _ => 0.0,
        }
    }
}

/// What the bank of a design names, and in which unit its sizes are.
fn of_bank(design: &BankDesign) -> (Vec<String>, Vec<String>) {
    let mechanisms = drivescope_monitor::bank::mechanisms(design);
    let stuck = STUCK.iter().map(|name| ((*name).to_owned(), String::new()));
    mechanisms.into_iter().map(|it| (it.id, it.unit)).chain(stuck).unzip()
}
