//! Watches a recording with a diagnoser and prints every declaration.
//!
//! ```text
//! cargo run --release -p drivescope-monitor --example watch -- DIAGNOSER RECORDING [BASELINE]
//! ```
//!
//! `DIAGNOSER` is a file of `drivescope train`; `BASELINE` a short healthy recording of the same
//! machine.

use std::error::Error;
use std::path::Path;

use drivescope_diagnoser::Diagnoser;
use drivescope_monitor::{Happened, Method, Monitor, Options};
use drivescope_recording::{ReadOptions, Recording, read};

fn main() -> Result<(), Box<dyn Error>> {
    let files: Vec<String> = std::env::args().skip(1).collect();
    let [diagnoser, recording, baseline @ ..] = &*files else {
        return Err("usage: watch DIAGNOSER RECORDING [BASELINE]".into());
    };
    let diagnoser = Diagnoser::load(Path::new(diagnoser))?;
    let period_s = diagnoser.interface.period_s;
    let options = ReadOptions { resample: Some(period_s), ..ReadOptions::default() };
    let open = |file: &String| read(Path::new(file), &options).map(|(recording, _)| recording);
    let recording: Recording = open(recording)?;
    let baseline = baseline.first().map(open).transpose()?;

    let signals = recording.signals.iter();
    let columns: Vec<(&str, &str)> = signals.map(|it| (&*it.name, &*it.unit)).collect();
    let asked = Method::best(&diagnoser, baseline.is_some());
    let how = Options { asked, beta: None };
    let mut monitor = Monitor::new(&diagnoser, &columns, how, baseline.as_ref())?;
    // As it happens: what the bank decides, sample by sample.
    monitor.run(&diagnoser, &recording, |_, sample, happened| {
        for decision in happened.iter().filter(|it| matches!(it, Happened::Decision(_))) {
            println!("{:.3} s: {decision:?}", recording.time(sample));
        }
    })?;
    // At the end: what stands, of the best method and of the others.
    for found in monitor.finish().methods {
        println!(
            "{}: {}, declared {} times",
            found.method.label(),
            found.verdict,
            found.declarations.len()
        );
        for it in &found.declarations {
            let to = it.to.map_or("the end".to_owned(), |to| format!("{to:.3} s"));
            println!(
                "    {} from {:.3} s to {to}: {:?} {:?}",
                it.mechanism, it.from, it.set, it.size
            );
        }
    }
    Ok(())
}
