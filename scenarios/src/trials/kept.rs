//! Recordings of the curves, so that detectors of other people see what ours see.

use std::io::{self, Write};
use std::path::Path;

use drivescope_diagnoser::bank::Row;
use serde::Serialize;

use super::bench::{Bench, fault};
use super::course::WATCHED;
use super::delays::{AFTER, FAULTS};
use super::machine::{Group, Plan};
use crate::profile::Profile;

/// Healthy machines to learn from, and those that limits and false alarms are taken from.
const LEARNED: usize = 4;
const HEALTHY: usize = 20;
/// The faults that are kept: those of 5 %.
const SIZE: f64 = 0.05;

/// What the files hold.
#[derive(Debug, Serialize)]
struct Manifest {
    period_s: f64,
    /// Samples of each run that are a healthy baseline.
    baseline: usize,
    files: Vec<KeptFile>,
}

/// One file: runs one after the other, column `run`.
#[derive(Debug, Serialize)]
struct KeptFile {
    file: String,
    /// `design`, `healthy` or `fault`.
    kind: &'static str,
    mechanism: Option<String>,
    size: Option<f64>,
    /// Of each run, the sample at which the fault begins; none in healthy ones.
    onsets: Vec<usize>,
}

/// Writes design, healthy and faulty recordings of machines drawn anew as CSV, and `manifest.json`.
pub(super) fn keep(bench: &Bench, folder: &Path) -> io::Result<()> {
    let baseline = bench.designed.how.baseline;
    let per_si = bench.experiment.drive.sensors.tacho_unit.per_si();
    let unit = bench.experiment.tacho_unit();
    let header = format!("run,C_m [V],T [{unit}],I_m [A]\n");
    let write = |file: &str, runs: &[Vec<Row>]| -> io::Result<()> {
        let mut out = io::BufWriter::new(std::fs::File::create(folder.join(file))?);
        out.write_all(header.as_bytes())?;
        for (run, rows) in runs.iter().enumerate() {
            for Row { control, shown } in rows {
                writeln!(out, "{run},{control:.6},{:.4},{:.6}", per_si * shown[0], shown[1])?;
            }
        }
        out.flush()
    };
    let healthy = |group: Group, machines: usize| -> Vec<Vec<Row>> {
        let runs = bench.each(group, machines, |machine, _| {
            let reference = vec![machine.experiment.set_point; baseline + WATCHED];
            machine.rows(&[Plan { reference, faults: Vec::new() }])
        });
        runs.into_iter().flatten().collect()
    };
    let mut files = Vec::new();
    for (kind, group, machines) in
        [("design", Group::Known, LEARNED), ("healthy", Group::Curves, HEALTHY)]
    {
        let file = format!("{kind}.csv");
        write(&file, &healthy(group, machines))?;
        files.push(KeptFile { file, kind, mechanism: None, size: None, onsets: Vec::new() });
    }
    for (number, (mechanism, size)) in FAULTS.into_iter().enumerate() {
        if size != SIZE {
            continue;
        }
        // The same machines, noise and onsets as those of the curves.
        let runs = bench.each(Group::Delays, bench.machines, |machine, _| {
            machine.renew_noise(number);
            let onset = machine.onset(bench);
            let reference = vec![machine.experiment.set_point; onset + AFTER];
            let faults = vec![fault(mechanism, machine.sign() * size, onset, Profile::Step)];
            (onset, machine.rows(&[Plan { reference, faults }]).swap_remove(0))
        });
        let (onsets, rows): (Vec<usize>, Vec<Vec<Row>>) = runs.into_iter().unzip();
        let file = format!("{mechanism}.csv");
        write(&file, &rows)?;
        let (mechanism, size) = (Some(mechanism.to_owned()), Some(size));
        files.push(KeptFile { file, kind: "fault", mechanism, size, onsets });
    }
    let manifest = Manifest { period_s: bench.experiment.period_s, baseline, files };
    let text = serde_json::to_string_pretty(&manifest)?;
    std::fs::write(folder.join("manifest.json"), text + "\n")
}
