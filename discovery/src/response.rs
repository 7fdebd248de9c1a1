//! Responses of the outputs to known torques and voltages along a run, for hundreds of them at
//! the price of one.
//!
//! Along a run the deviation dx of the state obeys, exactly to first order and through stick-slip,
//!
//! dy_k = C_k dx_k + D_k b_k,   dx_(k+1) = A_k dx_k + B_k b_k,
//!
//! with b the torque and voltage added over sample k. One run over duals, seeded anew at each
//! sample by the state and the two inputs, yields A, B, C, D; every series then costs a small
//! matrix product a sample.

use drivescope_numerics::Dual;

use crate::case::Case;
use crate::run::Runner;
use crate::sensitivity::Direction;

/// Derivatives in the run: by the states and two inputs.
const SEEDS: usize = 8;
/// States that this leaves room for.
const MOST_STATES: usize = SEEDS - 2;
/// Series that advance together.
const TOGETHER: usize = 8;
/// Samples of a recording that is linearised at most: 24 MB of maps for three states and outputs, 77 MB at
/// most.
const MOST_SAMPLES: usize = 100_000;

/// A torque against nothing, N m (N), positive forward, and a voltage in the armature circuit, V,
/// one value a sample, held; nothing where empty.
#[derive(Debug, Clone, Default)]
pub(crate) struct Forcing {
    pub(crate) torque: Vec<f64>,
    pub(crate) voltage: Vec<f64>,
}

impl Forcing {
    /// A torque alone.
    pub(crate) fn torque(torque: Vec<f64>) -> Self {
        Self { torque, voltage: Vec::new() }
    }

    /// A voltage alone.
    pub(crate) fn voltage(voltage: Vec<f64>) -> Self {
        Self { torque: Vec::new(), voltage }
    }
}

/// A drive linearised along a recording.
#[derive(Debug, Clone)]
pub(crate) struct Linearised {
    states: usize,
    /// A map for each sample of the pieces, in order: a row for each state after the sample, then one for
    /// each measured output; in a row the derivatives by the states, torque and voltage.
    maps: Vec<f64>,
}

impl Linearised {
    /// Of that case; nothing where the drive has too many states or holds its input back, or the
    /// recording is so long that the maps would fill the memory.
    pub(crate) fn of(case: &Case<'_>) -> Option<Self> {
        if case.measured.len() > MOST_SAMPLES {
            return None;
        }
        let fixed = |value| Dual { v: value, d: [0.0; SEEDS] };
        let starts = case.starts.iter().map(|it| it.values().map(fixed));
        let mut runner: Runner<'_, Dual<SEEDS>> =
            Runner::new(case, starts.collect(), |_, value| fixed(value));
        let states = runner.state().x.len();
        if states > MOST_STATES || runner.holds_back() {
            return None;
        }
        let added = [states, states + 1].map(|seed| Dual::parameter(0.0, seed));
        let used = states + added.len();
        let outputs = &case.measured.outputs;
        let mut maps = Vec::with_capacity(case.measured.len() * (states + outputs.len()) * used);
        for k in case.measured.pieces.iter().cloned().flatten() {
            runner.seed();
            let shown = runner.sample(k, added);
            let next = runner.state().x.iter().map(|[value]| value);
            let shown = outputs.iter().map(|it| &shown[it.output as usize]);
            next.chain(shown).for_each(|row| maps.extend_from_slice(&row.d[..used]));
        }
        Some(Self { states, maps })
    }

    /// The responses to series, [`TOGETHER`] of them at a time.
    fn respond(&self, case: &Case<'_>, series: &[Forcing], visit: &mut impl FnMut(Response<'_>)) {
        for (chunk, some) in series.chunks(TOGETHER).enumerate() {
            self.few(case, some, chunk * TOGETHER, visit);
        }
    }

    /// The responses to a few series, the first of which has that number.
    fn few(
        &self,
        case: &Case<'_>,
        series: &[Forcing],
        first: usize,
        visit: &mut impl FnMut(Response<'_>),
    ) {
        let n = self.states;
        let outputs = &case.measured.outputs;
        let mut maps = self.maps.chunks_exact((n + outputs.len()) * (n + 2));
        for piece in &case.measured.pieces {
            // States, then torque and voltage.
            let mut x = [[0.0; TOGETHER]; SEEDS];
            for (sample, map) in piece.clone().zip(&mut maps) {
                let (next, shown) = map.split_at(n * (n + 2));
                for (slot, forcing) in series.iter().enumerate() {
                    x[n][slot] = forcing.torque.get(sample).copied().unwrap_or(0.0);
                    x[n + 1][slot] = forcing.voltage.get(sample).copied().unwrap_or(0.0);
                }
                for (output, row) in shown.chunks_exact(n + 2).enumerate() {
                    if outputs[output].values[sample].is_finite() {
                        let mut shown = along(row, &x);
                        shown.iter_mut().for_each(|shown| *shown /= case.noise[output]);
                        let of = &shown[..series.len()];
                        visit(Response { sample, output, first, of });
                    }
                }
                let before = x;
                for (after, row) in x.iter_mut().zip(next.chunks_exact(n + 2)) {
                    *after = along(row, &before);
                }
            }
        }
    }
}

/// A row of a map times several vectors.
#[inline(always)]
fn along(row: &[f64], x: &[[f64; TOGETHER]; SEEDS]) -> [f64; TOGETHER] {
    let mut sum = [0.0; TOGETHER];
    for (factor, x) in row.iter().zip(x) {
        for (sum, x) in sum.iter_mut().zip(x) {
            *sum += factor * x;
        }
    }
    sum
}

/// What some series do to a measured value, in units of the noise.
pub(crate) struct Response<'a> {
    pub(crate) sample: usize,
    /// Its output, by its place in [`crate::Measured::outputs`].
    pub(crate) output: usize,
    /// Number of the first of the series.
    pub(crate) first: usize,
    /// One a series.
    pub(crate) of: &'a [f64],
}

/// Visits the responses of a case to these series; by runs over duals where there is no
/// linearisation.
pub(crate) fn respond(
    linearised: Option<&Linearised>,
    case: &Case<'_>,
    series: &[Forcing],
    mut visit: impl FnMut(Response<'_>),
) {
    if let Some(linearised) = linearised {
        return linearised.respond(case, series, &mut visit);
    }
    let (mut directions, mut belongs) = (Vec::new(), Vec::new());
    for (number, Forcing { torque, voltage }) in series.iter().enumerate() {
        let both = [(torque, Direction::Torque(torque)), (voltage, Direction::Voltage(voltage))];
        for (_, direction) in both.into_iter().filter(|(values, _)| !values.is_empty()) {
            directions.push(direction);
            belongs.push(number);
        }
    }
    let mut of = vec![0.0; series.len()];
    case.blocks(&directions, |rows| {
        for (row, (sample, output)) in rows.sample.iter().zip(&rows.output).enumerate() {
            of.fill(0.0);
            for (column, number) in rows.columns.column(row).iter().zip(&belongs) {
                of[*number] += column;
            }
            visit(Response { sample: *sample, output: *output, first: 0, of: &of });
        }
    });
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;
    use crate::rig::Rig;
    use crate::testing::{bench, dr300, gaussian};

    /// Both are exact derivatives of the same run: what is left are sums in another order.
    const ROUNDING: f64 = 1e-9;

    /// Of the first series to the last, sample by sample.
    fn responses(
        linearised: Option<&Linearised>,
        case: &Case<'_>,
        series: &[Forcing],
    ) -> DMatrix<f64> {
        let outputs = case.measured.outputs.len();
        let mut columns = DMatrix::zeros(series.len(), outputs * case.measured.len());
        respond(linearised, case, series, |Response { sample, output, first, of }| {
            let value = sample * outputs + output;
            columns.view_mut((first, value), (of.len(), 1)).copy_from_slice(of);
        });
        columns
    }

    #[test]
    fn responses_are_those_of_runs_over_duals() {
        let drive = dr300();
        let recording = bench(&drive, 2.0, 0.001);
        for hz in [0.0, 10.0] {
            let rig = Rig::new(drive.clone(), &recording, &[0.01, 0.3], hz);
            let (case, n) = (rig.case(), rig.measured.len());
            let forcing = |seed: u64| Forcing {
                torque: if seed == 3 { Vec::new() } else { gaussian(n, seed) },
                voltage: if seed == 4 { Vec::new() } else { gaussian(n, seed + 100) },
            };
            let series: Vec<Forcing> = (0..11).map(forcing).collect();
            let linearised = Linearised::of(&case).expect("three states");
            let fast = responses(Some(&linearised), &case, &series);
            let slow = responses(None, &case, &series);
            let largest = slow.amax();
            let worst = (fast - slow).amax();
            assert!(largest > 1e-3 && worst < ROUNDING * largest, "{worst} of {largest}");
        }
    }

    #[test]
    fn a_drive_that_holds_its_input_back_is_run_over_duals() {
        let mut drive = dr300();
        let recording = bench(&drive, 0.5, 0.001);
        let parameters = vec![("tau".into(), 4e-4)];
        let (kind, id) = ("delay".into(), "delay".into());
        drive.effects.push(drivescope_plant::drive::EffectData { kind, id, parameters, law: None });
        let rig = Rig::new(drive, &recording, &[0.01, 0.3], 0.0);
        assert!(Linearised::of(&rig.case()).is_none());
    }
}
