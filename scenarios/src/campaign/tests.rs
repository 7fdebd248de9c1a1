//! What a campaign must be: the same rows however it is split, and the verdicts of the detectors
//! that follow one run.

use std::path::Path;

use drivescope_diagnoser::{Column as Signal, Confidence, Data, DetectorKind};
use drivescope_recording::dataset::Values;

use super::*;

const MIXED: &str = "schema = 1\ndrive = \"dr300\"\ndraws = 12\nduration = 8\nseed = 5\n\
    set_point = { uniform = [80, 200] }\n\
    [parameters]\nR = { normal = [1, 0.02], relative = true }\nJ = { log_uniform = [1e-6, 2e-4] }\n\
    \"controller.K_p\" = { choice = [0.03, 0.03819718634205488] }\n\
    [[fault]]\nkind = { grid = [\"tacho\", \"flux\", \"resistance\", \"tacho_freeze\"] }\n\
    size = { uniform = [0.1, 0.6] }\nonset = { uniform = [5, 6] }\nduration = 1\n\
    profile = { choice = [\"step\", \"ramp=0.5\", \"pulses=0.1/0.3\", \"intermittent=0.1/0.1\"] }\n\
    [[fault]]\nkind = { choice = [\"load\", \"none\"] }\nsize = 0.2\nonset = 5.5\n\
    [detector]\nbeta = { choice = [0.05, 0.01] }\nwindow = { choice = [20, 50] }\n\
    [design]\nsamples = 20000\n";

fn campaign(text: &str) -> Campaign {
    let plan = Plan::parse(text, "plan.toml", Path::new("")).expect("a right plan");
    let design = Design::new(&plan).expect("it suits");
    Campaign::new(plan, design)
}

fn rows(campaign: &Campaign, range: std::ops::Range<u64>) -> Rows {
    campaign.run(range, &|_| false).expect("nobody stops it")
}

/// Bits, for missing values are not equal to themselves.
fn same(a: &Rows, b: &Rows) -> bool {
    a.columns.iter().zip(&b.columns).all(|(a, b)| match (&a.values, &b.values) {
        (Values::Numbers(a), Values::Numbers(b)) => {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits())
        }
        (a, b) => a == b,
    })
}

#[test]
fn rows_do_not_depend_on_how_the_work_is_split() {
    let campaign = campaign(MIXED);
    let whole = rows(&campaign, 0..48);
    assert_eq!(whole.len(), 48);
    let mut joined = Rows::none(campaign.plan());
    for range in [0..1, 1..18, 18..48] {
        assert!(joined.append(rows(&campaign, range)));
    }
    assert!(same(&whole, &joined));
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    assert!(same(&whole, &one.install(|| rows(&campaign, 0..48))));
    assert!(campaign.run(0..48, &|_| true).is_none());
}

#[test]
fn a_row_says_what_the_detectors_say_of_its_signals() {
    let campaign = campaign(MIXED);
    let whole = rows(&campaign, 0..48);
    let plan = campaign.plan();
    let number = |name: &str, k: usize| {
        let column = whole.columns.iter().find(|column| column.name == name).expect("a column");
        match &column.values {
            Values::Numbers(values) => values[k],
            other => panic!("{name}: {other:?}"),
        }
    };
    let mut detected = 0;
    for k in 0..48 {
        let scenario = plan.scenario(k as u64);
        let signals = campaign.trace(k as u64).expect("a native drive");
        let column = |name| Signal { name, values: &signals.signal(name).expect("kept").values };
        let data = Data::new(vec![column("C_m")], column("T")).expect("finite");
        let mut diagnoser = campaign.design().diagnoser.clone();
        diagnoser.window = scenario.settings.window as usize;
        diagnoser.confidence = Confidence::new(scenario.settings.beta).expect("a level");
        diagnoser.run_up = plan.run_up;
        let (from, _) = scenario.faulty().expect("there is always one");
        let methods = [("constant", DetectorKind::Constant), ("bands", DetectorKind::Mem)];
        for (name, kind) in methods {
            let trace = diagnoser.detector(kind).expect("it has one").run(&data).expect("it runs");
            let found = trace.detection(from);
            let t_dt = number(&format!("{name}_detection_time"), k);
            let expected = found.t_dt.map_or(f64::NAN, |it| it as f64 * 0.005);
            assert_eq!(t_dt.to_bits(), expected.to_bits(), "{name} of {k}");
            let alarms = number(&format!("{name}_false_alarms"), k);
            assert_eq!(alarms, found.false_alarms as f64, "{name} of {k}");
            let outside = trace.exceedance_rate(plan.run_up..from).expect("a span");
            let found = number(&format!("{name}_outside_healthy"), k);
            assert!((outside - found).abs() < 1e-12);
            detected += usize::from(t_dt.is_finite());
        }
    }
    assert!(detected > 20, "{detected}");
}

#[test]
fn parts_are_joined_to_the_bytes_of_one_run() {
    let campaign = campaign(MIXED);
    let folders = [(); 2].map(|()| tempfile::tempdir().expect("a folder"));
    let splits: [&[u64]; 2] = [&[0, 48], &[0, 5, 21, 48]];
    let bytes = [0, 1].map(|k| {
        let folder = folders[k].path();
        for pair in splits[k].windows(2) {
            let range = pair[0]..pair[1];
            write_part(folder, &campaign, &range, &rows(&campaign, range.clone()))
                .expect("it fits");
        }
        let (path, scenarios) = merge(folder).expect("they are all there");
        assert_eq!(scenarios, 48);
        assert_eq!(folder.read_dir().expect("a folder").count(), 1, "the parts are gone");
        assert_eq!(merge(folder).expect("again").1, 48);
        std::fs::read(path).expect("it is there")
    });
    assert!(bytes[0] == bytes[1]);
}

#[test]
fn what_cannot_be_joined_is_said() {
    let campaign = campaign(MIXED);
    let folder = tempfile::tempdir().expect("a folder");
    let message = |folder: &Path| merge(folder).expect_err("it cannot").to_string();
    assert!(message(folder.path()).contains("no scenarios there"));
    let part = |range: std::ops::Range<u64>| {
        write_part(folder.path(), &campaign, &range, &rows(&campaign, range.clone()))
            .expect("it fits")
    };
    let first = part(0..5);
    part(9..48);
    assert!(message(folder.path()).contains("scenarios 5..9 are not there, 4 of 48"));
    let twice = part(4..9);
    assert!(message(folder.path()).contains("scenario 4 is in two parts"));
    std::fs::remove_file(twice).expect("it is there");
    let bytes = std::fs::read(&first).expect("it is there");
    std::fs::write(&first, &bytes[..bytes.len() / 2]).expect("it can be written");
    assert!(message(folder.path()).contains("damaged or cut short"));
    let whole = parts_of(folder.path(), Some(&campaign)).expect("it can be read");
    assert_eq!((whole.parts.len(), whole.damaged.len()), (1, 1));
    let other = self::campaign(&MIXED.replace("seed = 5", "seed = 6"));
    let error = parts_of(folder.path(), Some(&other)).expect_err("another plan").to_string();
    assert!(error.contains("of another plan"), "{error}");
}
