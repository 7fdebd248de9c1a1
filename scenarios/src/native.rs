//! A run of the drive without any FMU: the reference for what the FMU must give, bit for bit.

use drivescope_plant::drive::Drive;
use drivescope_plant::effects::law::Outputs;
use drivescope_plant::fault::{FaultLanes, Faults, Mechanism};
use drivescope_plant::integrate::Integrator;
use drivescope_plant::sampled::{InputLanes, Inputs, Sampled, Signals, speed_bound};
use drivescope_recording::{Recording, Signal};

/// Signals of a sample that a run records, with the FMU's names.
pub const RECORDED: [&str; 6] = ["C_m", "T", "I_m", "i", "omega", "theta"];

/// Runs the closed loop over the inputs, one sample a row. Row k of the result holds C_m, T and
/// I_m of sample k and the ideal i, omega and theta at its end.
pub fn closed_loop(drive: &Drive, inputs: &Recording) -> Recording {
    let integrator = Integrator::new(drive.model(), speed_bound(drive));
    let mut sampled = Sampled::new(drive, integrator, true);
    let column = |name: &str| inputs.signal(name).map(|signal| signal.values.as_slice());
    let names = ["reference", "noise_T_l", "noise_reference", "noise_T", "noise_I_m"];
    let columns = names.map(column);
    let faults: Vec<(usize, &[f64])> = inputs
        .signals
        .iter()
        .filter_map(|signal| {
            let id = signal.name.strip_prefix("fault_")?;
            Some((Mechanism::find(id)?, signal.values.as_slice()))
        })
        .collect();
    let mut rows = RECORDED.map(|_| Vec::with_capacity(inputs.len()));
    let h = inputs.period_s;
    for k in 0..inputs.len() {
        let [reference, load, noise_reference, noise_t, noise_i_m] =
            columns.map(|column| column.map_or(0.0, |values| values[k]));
        let now = Inputs { reference, load, noise_reference, noise_t, noise_i_m, ..Inputs::NONE };
        let mut acting = Faults::NONE;
        for (mechanism, values) in &faults {
            if let Some(size) = acting.size_mut(*mechanism) {
                *size = values[k];
            }
        }
        let time = inputs.time(k);
        sampled.sample(time, &InputLanes::splat(now), &FaultLanes::splat(acting));
        sampled.advance(time, h);
        let Signals { c_m, t, i_m, .. } = sampled.signals().lane(0);
        let Outputs { i, omega, theta } = sampled.outputs(time + h).lane(0);
        for (row, value) in rows.iter_mut().zip([c_m, t, i_m, i, omega, theta]) {
            row.push(value);
        }
    }
    let signal = |(name, values): (&str, Vec<f64>)| Signal {
        name: name.to_owned(),
        unit: String::new(),
        values,
    };
    let signals = RECORDED.into_iter().zip(rows).map(signal).collect();
    Recording { signals, ..inputs.clone() }
}
