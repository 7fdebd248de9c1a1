//! Campaigns: one dataset however the work is split, ended and resumed; plans and folders that cannot
//! be used.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};

use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;

use crate::{done, folder, program, put, refused, run};

/// 4200 scenarios of 300 samples: three parts.
const PLAN: &str = "schema = 1\nname = \"small\"\ndrive = \"dr300\"\ndraws = 1050\nduration = 1.5\n\
    seed = 3\nkeep_traces = 0.005\n[parameters]\nR = { normal = [1, 0.01], relative = true }\n\
    [[fault]]\nkind = { grid = [\"tacho\", \"flux\", \"load\", \"none\"] }\n\
    size = { uniform = [0.05, 0.3] }\nonset = { uniform = [1.0, 1.2] }\n\
    [detector]\nrun_up = 0.8\n[design]\nsamples = 20000\n";

/// Rows of the datasets of a folder: the text of each by its number.
fn rows(here: &Path, name: &str) -> BTreeMap<i64, String> {
    let mut rows = BTreeMap::new();
    for entry in here.join(name).read_dir().expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.extension().is_none_or(|it| it != "parquet") {
            continue;
        }
        let file = std::fs::File::open(&path).expect("it opens");
        let reader = SerializedFileReader::new(file).expect("it is whole");
        for row in reader.get_row_iter(None).expect("rows") {
            let row = row.expect("a row");
            let fields: Vec<_> = row.get_column_iter().collect();
            let (name, Field::Long(scenario)) = fields[0] else { panic!("{row:?}") };
            assert_eq!(name, "scenario");
            assert!(rows.insert(*scenario, row.to_string()).is_none(), "{scenario} twice");
        }
    }
    rows
}

fn bytes(here: &Path, name: &str) -> Vec<u8> {
    std::fs::read(here.join(name).join("campaign.parquet")).expect("it was joined")
}

#[test]
fn shards_kills_and_resumes_give_the_bytes_of_one_run() {
    let here = folder();
    put(here.path(), "plan.toml", PLAN);
    let answer = ["campaign", "plan.toml", "-o", "whole", "--json", "-", "--quiet"];
    let said = done(here.path(), &answer).json();
    assert_eq!((&said["scenarios"], &said["made"]), (&4200.into(), &4200.into()));
    assert_eq!(rows(here.path(), "whole").len(), 4200);
    let whole = bytes(here.path(), "whole");
    let traces = here.path().join("whole/traces").read_dir().expect("some are kept").count();
    assert!((5..50).contains(&traces), "{traces}");

    for shard in ["2/2", "1/2"] {
        let message = run(here.path(), &["campaign", "merge", "shards"]);
        assert_eq!(message.code, Some(2), "not all are there: {}", message.err);
        done(here.path(), &["campaign", "plan.toml", "-o", "shards", "--shard", shard]);
        let again = ["campaign", "plan.toml", "-o", "shards", "--shard", shard];
        let message = refused(here.path(), &again);
        assert!(message.contains("are there already") && message.contains("--resume"), "{message}");
    }
    let merged = done(here.path(), &["campaign", "merge", "shards", "--json", "-"]).json();
    assert_eq!(merged["scenarios"], 4200);
    assert!(bytes(here.path(), "shards") == whole, "the split does not show");

    // Ended in the middle, a part cut short, and resumed.
    let killed = ["campaign", "plan.toml", "-o", "killed"];
    let mut child = program(here.path())
        .args(killed)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program starts");
    let first = here.path().join("killed/part-000000000-000002048.parquet");
    let began = Instant::now();
    while !first.exists() && began.elapsed() < Duration::from_secs(120) {
        std::thread::sleep(Duration::from_millis(1));
    }
    child.kill().expect("it lives");
    child.wait().expect("it ends");
    if here.path().join("killed/campaign.parquet").exists() {
        // Faster than the kill: nothing is left to resume.
        return;
    }
    let part = std::fs::read(&first).expect("the first part is there");
    std::fs::write(&first, &part[..part.len() / 2]).expect("it can be cut");
    let message = run(here.path(), &killed);
    assert_eq!(message.code, Some(2), "{}", message.err);
    let resumed = done(here.path(), &["campaign", "plan.toml", "-o", "killed", "--resume"]);
    assert!(resumed.err.contains("its scenarios are run again"), "{}", resumed.err);
    assert!(bytes(here.path(), "killed") == whole);
    // A resumed campaign that is complete makes nothing anew.
    let said =
        done(here.path(), &["campaign", "plan.toml", "-o", "killed", "--resume", "--json", "-"]);
    assert_eq!(said.json()["made"], 0);
}

/// A scenario that ends its process is found by the next run, and costs no other.
#[test]
fn the_scenario_that_ends_its_process_is_named() {
    let here = folder();
    put(here.path(), "plan.toml", PLAN.replace("draws = 1050", "draws = 20"));
    done(here.path(), &["campaign", "plan.toml", "-o", "whole", "--quiet"]);
    let with = |how: &str, arguments: &[&str]| {
        let mut program = program(here.path());
        let output = program.args(arguments).env(how, "37").output().expect("the program starts");
        (output.status, String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (ended, _) = with("DRIVESCOPE_ABORT_AT", &["campaign", "plan.toml", "-o", "poison"]);
    assert_eq!(ended.code(), None, "ended by a signal");
    let resume = ["campaign", "plan.toml", "-o", "poison", "--resume"];
    let (ended, message) = with("DRIVESCOPE_ABORT_AT", &resume);
    assert_eq!(ended.code(), Some(0), "{message}");
    assert!(message.contains("scenario 37 ends the process that runs it"), "{message}");
    // One that panics needs no second run.
    let (ended, message) = with("DRIVESCOPE_PANIC_AT", &["campaign", "plan.toml", "-o", "panics"]);
    assert_eq!(ended.code(), Some(0), "{message}");
    let (whole, poison) = (rows(here.path(), "whole"), rows(here.path(), "poison"));
    assert_eq!(poison.len(), 80);
    for (scenario, row) in &poison {
        let aborted = row.contains("status: \"aborted\"");
        assert_eq!(aborted, *scenario == 37, "{row}");
        assert!(aborted || whole[scenario] == *row, "{row}");
    }
    assert!(bytes(here.path(), "poison") == bytes(here.path(), "panics"));
    let said = done(here.path(), &["campaign", "report", "poison", "--json", "-"]).json();
    assert_eq!(said["aborted"], serde_json::json!([37]));
}

#[test]
fn a_folder_that_is_at_work_or_of_another_plan_is_refused() {
    let here = folder();
    let small = PLAN.replace("draws = 1050", "draws = 10");
    put(here.path(), "plan.toml", &small);
    put(here.path(), "other.toml", small.replace("seed = 3", "seed = 4"));
    done(here.path(), &["campaign", "plan.toml", "-o", "a", "--shard", "1/2", "--quiet"]);
    let message = refused(here.path(), &["campaign", "other.toml", "-o", "a", "--shard", "2/2"]);
    assert!(message.contains("the campaign there is of another plan"), "{message}");
    let host = std::fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
    let mark = |name: &str| {
        let text = format!("{} {}", std::process::id(), host.trim());
        put(here.path(), &format!("a/{name}"), text);
    };
    mark(".drivescope-running-2-of-2");
    let again = ["campaign", "plan.toml", "-o", "a", "--shard", "2/2"];
    let message = refused(here.path(), &again);
    assert!(message.contains("another run writes there"), "{message}");
    for whole in [&["campaign", "merge", "a"][..], &["campaign", "plan.toml", "-o", "a"]] {
        assert!(refused(here.path(), whole).contains("another run writes there"));
    }
    std::fs::remove_file(here.path().join("a/.drivescope-running-2-of-2")).expect("it is there");
    done(here.path(), &again);
    done(here.path(), &["campaign", "merge", "a"]);
    let message = refused(here.path(), &["campaign", "merge", "nowhere"]);
    assert!(message.contains("nowhere: cannot be read"), "{message}");
}

#[test]
fn impossible_plans_and_calls_are_refused() {
    let here = folder();
    for (from, to, said) in [
        (
            "draws = 1050",
            "draws = 250000000000",
            "plan.toml:4:9: the plan has 1000000000000 scenarios",
        ),
        ("[1.0, 1.2]", "[1.0, 2.0]", "after the run of 1.5 s"),
        (
            "uniform = [0.05, 0.3]",
            "uniform = [0.3, 0.05]",
            "plan.toml:12:8: `fault.size`: the range",
        ),
        ("onset =", "onest =", "plan.toml:13:1: unknown field `onest`"),
    ] {
        put(here.path(), "plan.toml", PLAN.replace(from, to));
        let message = refused(here.path(), &["campaign", "plan.toml", "-o", "a"]);
        assert!(message.contains(said), "{message}");
    }
    put(here.path(), "plan.toml", PLAN);
    for (arguments, said) in [
        (&["-o", "a", "--shard", "3/2"][..], "from 1 to their number"),
        (&["--only", "4200"], "the plan has 4200 scenarios"),
        (&["-o", "a", "--seed", "9"], "the plan says seed = 3"),
        (&[], "--output"),
    ] {
        let message = refused(here.path(), &[&["campaign", "plan.toml"], arguments].concat());
        assert!(message.contains(said), "{arguments:?}: {message}");
    }
    let message = refused(here.path(), &["campaign", "none.toml", "-o", "a"]);
    assert!(message.contains("none.toml: cannot be read"), "{message}");
}

#[test]
fn a_scenario_is_run_again_and_summed_up() {
    let here = folder();
    put(here.path(), "plan.toml", PLAN.replace("draws = 1050", "draws = 25"));
    done(here.path(), &["campaign", "plan.toml", "-o", "a", "--quiet"]);
    let whole = rows(here.path(), "a");
    let only = ["campaign", "plan.toml", "--only", "2", "--json", "-", "-o", "two.csv"];
    let row = done(here.path(), &only).json();
    assert_eq!((&row["scenario"], &row["fault_kind"]), (&2.into(), &"load".into()));
    let size = row["fault_size"].as_f64().expect("a number");
    assert!(whole[&2].contains(&format!("fault_size: {size}")), "{size}: {}", whole[&2]);
    let signals = std::fs::read_to_string(here.path().join("two.csv")).expect("it was written");
    assert_eq!(signals.lines().count(), 301);
    let report = done(here.path(), &["campaign", "report", "a", "--plan", "plan.toml"]);
    for said in ["100 of 100 scenarios, 25 of them healthy", "bands: ", "cusum: ", "fault_size"] {
        assert!(report.out.contains(said), "{said}: {}", report.out);
    }
    let page = std::fs::read_to_string(here.path().join("a/report.html")).expect("a page");
    assert!(page.contains("What it depends on") && page.contains("draws = 25"));
    let schema = done(here.path(), &["schema", "plan"]).json();
    assert!(schema["properties"]["fault"].is_object());
}

/// The bank: the same bytes in shares as in one run, its columns documented, what it named summed up.
#[test]
fn a_bank_gives_one_dataset_in_shares_and_a_table_of_confusion() {
    let here = folder();
    let with_bank = PLAN
        .replace("draws = 1050", "draws = 520")
        .replace("duration = 1.5", "duration = 2")
        .replace("run_up = 0.8", "run_up = 0.8\nmethods = [\"bands\", \"bank\"]\narl_0 = 1e6");
    put(here.path(), "plan.toml", with_bank);
    done(here.path(), &["campaign", "plan.toml", "-o", "whole", "--quiet"]);
    for shard in ["2/2", "1/2"] {
        done(here.path(), &["campaign", "plan.toml", "-o", "shards", "--shard", shard]);
    }
    done(here.path(), &["campaign", "merge", "shards"]);
    assert!(bytes(here.path(), "shards") == bytes(here.path(), "whole"));

    let file = std::fs::File::open(here.path().join("whole/campaign.parquet")).expect("it opens");
    let reader = SerializedFileReader::new(file).expect("it is whole");
    let schema = reader.metadata().file_metadata().schema_descr_ptr();
    let names: Vec<&str> = schema.columns().iter().map(|column| column.name()).collect();
    let docs = include_str!("../../docs/campaign.md");
    let of_bank = names.iter().filter(|name| name.starts_with("bank_"));
    let (counted, own): (Vec<&str>, Vec<&str>) =
        of_bank.partition(|name| docs.contains(&name.replace("bank_", "METHOD_")));
    assert_eq!((counted.len(), own.len()), (6, 7));
    assert!(own.iter().all(|name| docs.contains(&format!("`{name}`"))), "{own:?}");

    let said = done(here.path(), &["campaign", "report", "whole", "--json", "-"]).json();
    assert!(said["methods"][0].get("naming").is_none(), "bands name nothing");
    let bank = &said["methods"][1];
    assert_eq!(bank["method"], "bank");
    let kinds = bank["naming"]["kinds"].as_array().expect("kinds");
    let of = |kind: &str| kinds.iter().find(|it| it["kind"] == kind).expect(kind);
    assert_eq!(of("none")["named"][0]["what"], "none", "most of the healthy raise no alarm");
    let tacho = of("tacho");
    let (hits, judged) = (&tacho["in_set"]["hits"], &tacho["in_set"]["of"]);
    let (hits, judged) = (hits.as_u64().expect("a count"), judged.as_u64().expect("a count"));
    assert!(judged > 400 && 100 * hits >= 95 * judged, "{hits} of {judged} within the set");
    let text = done(here.path(), &["campaign", "report", "whole"]).out;
    assert!(text.contains("named first"), "{text}");
}
