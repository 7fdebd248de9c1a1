//! What a bank sees of a run: control signal, speed, current.

use drivescope_diagnoser::bank::Row;
use drivescope_recording::Recording;

/// The row of a sample: control signal, V, tachometer signal in its unit, measured current, A;
/// `per_si` is T of 1 rad/s (1 m/s).
#[inline(always)]
pub(crate) fn row([c_m, t, i_m]: [f64; 3], per_si: f64) -> Row {
    Row { control: c_m, shown: [t / per_si, i_m, f64::NAN] }
}

/// The rows of a run that begins with the signals C_m, T and I_m, as native runs do.
pub(crate) fn rows(run: &Recording, per_si: f64) -> Vec<Row> {
    let signals = [0, 1, 2].map(|signal| &run.signals[signal].values);
    (0..run.len()).map(|k| row(signals.map(|values| values[k]), per_si)).collect()
}
