//! The bank of hypotheses over a stream of C_m, T, I_m on one core: bar 2 us a sample for all
//! detectors, of which those of the paper take some tenths (benches of the diagnoser).
#![allow(missing_docs, reason = "criterion's macro makes a public function")]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use drivescope_monitor::bank::{Columns, design};
use drivescope_scenarios::drives::built_in;
use drivescope_scenarios::experiment::{Experiment, Stream};
use drivescope_scenarios::native::closed_loop;

/// Samples of a design, and of the stream.
const DESIGN: usize = 6000;
const SAMPLES: usize = 20_000;
const ARL_0: f64 = 1e6;

fn watch(criterion: &mut Criterion) {
    let drive = built_in("dr300").expect("it is built in").expect("it is right");
    let experiment = Experiment::new(drive, 1).expect("it is controlled");
    let rows = |samples: usize, number: u64| {
        let inputs = experiment.closed_loop(samples, Stream::Healthy(number), None);
        Columns::of(&closed_loop(&experiment.drive, &inputs)).expect("it has the signals").1
    };
    let designed = design(&experiment.drive, experiment.period_s, &[rows(DESIGN, 0)], 1);
    let designed = designed.expect("the recordings are its own");
    let stream = rows(SAMPLES, 1);
    let limits = designed.tails.limits(ARL_0);
    let baseline = &stream[..designed.how.baseline];
    let mut group = criterion.benchmark_group("bank");
    group.throughput(Throughput::Elements(stream.len() as u64));
    let mechanisms = designed.process.mechanisms().len();
    group.bench_function(format!("{mechanisms} mechanisms"), |b| {
        b.iter(|| {
            let learned = designed.process.learn(baseline, limits, designed.how.horizon);
            let mut watch = learned.expect("it is healthy");
            stream.iter().filter(|row| watch.step(row).is_some()).count()
        });
    });
    group.finish();
}

criterion_group!(benches, watch);
criterion_main!(benches);
