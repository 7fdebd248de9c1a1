//! The balance of torques of all recordings as one linear table: a row a window, a column for each
//! parameter of the drive and for what no parameter describes.

use drivescope_plant::drive::EffectData;
use drivescope_plant::effects::law::Variable;
use drivescope_plant::model::SPEED;
use nalgebra::DMatrix;

use super::super::base::{FLAT, NEAR_ZERO, OFFSET, ZERO_SPEED};
use super::super::gram::Products;
use super::super::marginal::{Terms, log_evidence};
use super::super::scene::{Recorded, Scene};
use super::noise::{Bounds, Course, TorqueNoise};
use super::torques::{Torques, gains};
use super::windows::Windows;
use crate::rms::rms;

/// Standard deviation of what explains nothing, of the balance's size.
const NOTHING: f64 = 1e-9;

/// Factor by which the noise that grows with the speed may be greater than what a position shows by itself.
const MORE: f64 = 2.0;

/// Columns of one recording, not whitened.
#[derive(Debug, Clone)]
struct Sheet {
    background: DMatrix<f64>,
    judged: DMatrix<f64>,
    missing: DMatrix<f64>,
    course: Course,
    /// What positions that are read a moment sooner or later make of the inertia's torque, over the speed.
    jitter: f64,
    held_out: bool,
    /// ln of what the laws over the driving signal take of its density ([`gains`]).
    feedback: f64,
}

/// Columns of all recordings.
#[derive(Debug, Clone)]
pub(super) struct Table {
    sheets: Vec<Sheet>,
    groups: Vec<usize>,
    /// Of each column its own unit in the balance's: a coefficient of the scaled column times this is
    /// the coefficient of the column.
    pub(super) scale: Vec<f64>,
    /// The background's priors.
    pub(super) terms: Terms,
    /// Those of the drive's parameters alone, and with them what drives: another K.
    pub(super) parameters: Terms,
    pub(super) driven: Terms,
}

/// Columns beside the base of one recording: in the background, in units of the balance with that
/// standard deviation; and judged, in groups.
#[derive(Debug, Clone, Default)]
pub(super) struct Columns {
    pub(super) background: Vec<(Vec<f64>, f64)>,
    pub(super) judged: Vec<Vec<f64>>,
}

impl Table {
    /// Of the scene's drive alone.
    pub(super) fn of_drive(scene: &Scene, windows: &[Windows], torque: f64) -> Self {
        Self::of(scene, windows, torque, &[], |_| Columns::default())
    }

    /// Of the scene's drive; `torque` is the size of the balance, N m (N), `further` gives the columns
    /// beside the base of each recording, the judged ones in `groups`.
    pub(super) fn of(
        scene: &Scene,
        windows: &[Windows],
        torque: f64,
        groups: &[usize],
        further: impl Fn(usize) -> Columns,
    ) -> Self {
        let most = |windows: &Windows| {
            windows.motion.iter().fold(0.0_f64, |most, at| most.max(at[SPEED].abs()))
        };
        let fastest = windows.iter().map(most).fold(f64::MIN_POSITIVE, f64::max);
        let mut variances = vec![FLAT * FLAT; scene.names.len()];
        let flat: usize = scene.recordings.iter().map(|it| it.own.len()).sum::<usize>() + 1;
        variances.extend(vec![OFFSET * OFFSET; scene.recordings.len()]);
        variances.extend([ZERO_SPEED * ZERO_SPEED; NEAR_ZERO.len()]);
        variances.extend(vec![FLAT * FLAT; flat - 1]);
        variances.extend([NOTHING * NOTHING, FLAT * FLAT]);
        let standing = scene.names.len()..variances.len() - flat - 1;
        let driving = variances.len() - 2;
        let mut sheets = Vec::new();
        for (number, (it, windows)) in scene.recordings.iter().zip(windows).enumerate() {
            let own: Vec<String> = scene.names.iter().chain(&it.own).cloned().collect();
            let Torques { missing, columns } = Torques::of(it, &it.drive, windows, &own);
            let (machine, own) = columns.split_at(scene.names.len());
            let mut background = machine.to_vec();
            for other in 0..scene.recordings.len() {
                background.push(vec![f64::from(u8::from(other == number)); windows.len()]);
            }
            for share in NEAR_ZERO {
                let differs = |omega: f64| {
                    if omega == 0.0 {
                        0.0
                    } else {
                        omega.signum() - (omega / (share * fastest)).tanh()
                    }
                };
                let values: Vec<f64> = windows.motion.iter().map(|at| differs(at[SPEED])).collect();
                background.push(windows.over(&values));
            }
            for (other, of) in scene.recordings.iter().enumerate() {
                let none = || vec![0.0; windows.len()];
                let column = |place: usize| {
                    if other == number { own[place].clone() } else { none() }
                };
                background.extend((0..of.own.len()).map(column));
            }
            // What drives, of a prior that lets it explain nothing: what equals it beside the parameters
            // is another K with other values of these.
            background.push(windows.over(&it.measured.u));
            // The driving signal a little sooner or later: clocks of channels differ.
            background.push(windows.over(&slopes(&it.measured.u, it.measured.period_s)));
            let further = further(number);
            if number == 0 {
                variances.extend(further.background.iter().map(|(_, sd)| sd * sd));
            }
            background.extend(further.background.into_iter().map(|(column, _)| column));
            sheets.push(Sheet {
                background: matrix(&background, windows.len()),
                judged: matrix(&further.judged, windows.len()),
                missing: matrix(&[missing], windows.len()),
                jitter: it.drive.motor.j * windows.acceleration_by_jitter(),
                course: Course {
                    apart_s: windows.apart_s(),
                    begins: windows.begins.clone(),
                    used: windows.moves.clone(),
                    speed: windows.over(&windows.speed),
                },
                held_out: it.held_out,
                feedback: feedback(it, windows),
            });
        }
        let known = variances.len();
        let sizes = |column: usize| {
            let of = |sheet: &'_ Sheet| {
                let own = if column < known {
                    sheet.background.column(column)
                } else {
                    sheet.judged.column(column - known)
                };
                let used = sheet.course.used.iter().zip(own.iter()).filter(|(used, _)| **used);
                used.map(|(_, value)| *value).collect::<Vec<f64>>()
            };
            let size = rms(sheets.iter().flat_map(of));
            if size > 1e-200 && size.is_finite() { torque / size } else { 0.0 }
        };
        let count = known + groups.iter().sum::<usize>();
        let mut scale: Vec<f64> = (0..count).map(sizes).collect();
        standing.for_each(|column| scale[column] = torque);
        scale.push(1.0);
        let flat =
            |columns: Vec<usize>| Terms { variances: vec![FLAT * FLAT; columns.len()], columns };
        let is_flat = |column: &usize| variances[*column] == FLAT * FLAT;
        let parameters: Vec<usize> = (0..known).filter(is_flat).collect();
        Self {
            sheets,
            groups: groups.to_vec(),
            scale,
            driven: flat(parameters.iter().copied().chain([driving]).collect()),
            parameters: flat(parameters),
            terms: Terms { columns: (0..known).collect(), variances },
        }
    }

    /// Time between windows, the longest of all recordings, s.
    pub(super) fn apart_s(&self) -> f64 {
        self.sheets.iter().map(|sheet| sheet.course.apart_s).fold(0.0, f64::max)
    }

    /// Root of the mean square of what is missing, N m (N).
    pub(super) fn missing(&self) -> f64 {
        let of = |sheet: &Sheet| {
            let used =
                sheet.course.used.iter().zip(sheet.missing.iter()).filter(|(used, _)| **used);
            used.map(|(_, value)| *value).collect::<Vec<f64>>()
        };
        rms(self.sheets.iter().flat_map(of))
    }

    /// What the windows allow the noise to be.
    pub(super) fn bounds(&self) -> Bounds {
        let by_speed = MORE * self.sheets.iter().map(|sheet| sheet.jitter).fold(0.0, f64::max);
        Bounds { apart_s: self.apart_s(), by_speed }
    }

    /// The noise where nothing is known of it: half of what the drive leaves, either way, and little by the
    /// speed.
    pub(super) fn noise(&self) -> TorqueNoise {
        let half = 0.5 * self.missing();
        let speed = rms(self.sheets.iter().flat_map(|sheet| sheet.course.speed.iter().copied()));
        let by_speed = 0.1 * half / speed.max(f64::MIN_POSITIVE);
        TorqueNoise { white: half, load: half, load_s: 5.0 * self.apart_s(), by_speed }
    }

    /// Products of the scaled columns of the recordings that are `wanted` by whether they were held
    /// out, whitened, and ln of their likelihood.
    pub(super) fn products(
        &self,
        noise: &TorqueNoise,
        wanted: impl Fn(bool) -> bool,
    ) -> (Products, f64) {
        let mut ln_likelihood = 0.0;
        let mut sum: Option<Products> = None;
        for sheet in self.sheets.iter().filter(|sheet| wanted(sheet.held_out)) {
            let white = |columns: &DMatrix<f64>| {
                let mut columns = columns.clone();
                (noise.whiten(&sheet.course, &mut columns), columns)
            };
            let (ln, data) = white(&sheet.missing);
            ln_likelihood += sheet.feedback + ln - 0.5 * data.norm_squared();
            let [(_, background), (_, judged)] = [white(&sheet.background), white(&sheet.judged)];
            let own = Products::of_rows(&background, &judged, &self.groups, &data);
            sum = Some(sum.map_or_else(|| own.clone(), |sum| sum.and(&own)));
        }
        let none = || {
            let empty = |of: &DMatrix<f64>| DMatrix::zeros(0, of.ncols());
            let first = &self.sheets[0];
            let parts = [&first.background, &first.judged, &first.missing].map(empty);
            Products::of_rows(&parts[0], &parts[1], &self.groups, &parts[2])
        };
        (sum.unwrap_or_else(none).scaled(&self.scale), ln_likelihood)
    }

    /// ln of the probability of the recordings of the fit; the parameters are integrated out too where
    /// they are `flat`.
    pub(super) fn probability(&self, noise: &TorqueNoise, flat: bool) -> f64 {
        let (products, ln_likelihood) = self.products(noise, |held_out| !held_out);
        let terms = if flat { self.terms.clone() } else { self.nuisance() };
        ln_likelihood + log_evidence(&products, &terms)
    }

    fn nuisance(&self) -> Terms {
        let each = self.terms.columns.iter().zip(&self.terms.variances);
        let kept = each.filter(|(_, variance)| **variance != FLAT * FLAT);
        let (columns, variances) = kept.unzip();
        Terms { columns, variances }
    }
}

/// ln of the density of the driving signal, given the motion, over that of what is missing: laws over
/// the signal itself would otherwise explain it by itself.
fn feedback(it: &Recorded, windows: &Windows) -> f64 {
    let over_current = |effect: &EffectData| effect.fails_over().contains(&Variable::Current);
    if !it.drive.effects.iter().any(over_current) {
        return 0.0;
    }
    let by = 1e-3 * rms(it.measured.u.iter().copied());
    let used = gains(it, &it.drive, windows, by).into_iter().zip(&windows.moves);
    let gains = used.filter(|(_, used)| **used).map(|(gain, _)| gain.abs());
    gains.map(|gain| gain.max(f64::MIN_POSITIVE).ln()).sum()
}

fn matrix(columns: &[Vec<f64>], rows: usize) -> DMatrix<f64> {
    DMatrix::from_fn(rows, columns.len(), |row, column| columns[column][row])
}

/// Slopes of a series, a second; 0 where it is not finite.
fn slopes(values: &[f64], period_s: f64) -> Vec<f64> {
    let last = values.len().saturating_sub(1);
    let slope = |k: usize| {
        let (from, to) = (k.saturating_sub(1), (k + 1).min(last));
        let slope = (values[to] - values[from]) / ((to - from).max(1) as f64 * period_s);
        if slope.is_finite() { slope } else { 0.0 }
    };
    (0..values.len()).map(slope).collect()
}
