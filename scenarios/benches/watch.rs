//! The bank of hypotheses over a stream of C_m, T, I_m on one core: bar 2 us a sample for all
//! detectors, of which those of the paper take some tenths (benches of the diagnoser).

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
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
        let mut run = closed_loop(&experiment.drive, &inputs);
        // A native run names no units; this drive shows rpm.
        let shown = [("T", "rpm"), ("I_m", "A"), ("i", "A")];
        for signal in &mut run.signals {
            let unit = shown.iter().find(|(name, _)| *name == signal.name);
            signal.unit = unit.map_or_else(String::new, |(_, unit)| (*unit).to_owned());
        }
        Columns::of(&run).expect("it has the signals").1
    };
    let designed = design(&experiment.drive, experiment.period_s, &[rows(DESIGN, 0)], 1);
    let designed = designed.expect("the recordings are its own");
    let stream = rows(SAMPLES, 1);
    let limits = designed.tails.limits(ARL_0);
    // A watch goes on where its baseline ends.
    let (baseline, stream) = stream.split_at(designed.how.baseline);
    let mut group = criterion.benchmark_group("bank");
    group.throughput(Throughput::Elements(stream.len() as u64));
    let mechanisms = designed.process.mechanisms().len();
    let learn = || {
        let learned = designed.process.learn(baseline, limits, designed.how.horizon);
        learned.expect("it is healthy")
    };
    group.bench_function(format!("{mechanisms} mechanisms"), |b| {
        b.iter_batched_ref(
            learn,
            |watch| stream.iter().filter(|row| watch.step(row).is_some()).count(),
            BatchSize::LargeInput,
        );
    });
    group.finish();
    criterion.bench_function("baseline of a machine", |b| b.iter(learn));
}

criterion_group!(benches, watch);
criterion_main!(benches);
