//! Campaigns whose machine is an FMU: one of this program gives what its drive gives; one of another
//! tool runs under its own names, and what it ends is its own process.

use std::path::Path;
use std::process::Command;

use crate::{done, folder, program, put, refused};

/// 24 scenarios of 400 samples.
const PLAN: &str = "schema = 1\ndrive = \"dr300\"\ndraws = 8\nduration = 2\nseed = 3\nkeep_traces = 0.2\n\
    [parameters]\nR = { normal = [1, 0.01], relative = true }\n\
    [[fault]]\nkind = { grid = [\"tacho\", \"load\", \"none\"] }\n\
    size = { uniform = [0.1, 0.3] }\nonset = { uniform = [1.0, 1.2] }\n\
    [detector]\nrun_up = 0.8\n[design]\nsamples = 20000\n";

/// The columns of each scenario of a folder, from `--only`-like rows of the dataset.
fn rows(here: &Path, name: &str) -> Vec<String> {
    let file = std::fs::File::open(here.join(name).join("campaign.parquet")).expect("it opens");
    let reader = parquet::file::reader::SerializedFileReader::new(file).expect("it is whole");
    reader.into_iter().map(|row| row.expect("a row").to_string()).collect()
}

/// Value of a column in a row's text.
fn value<'a>(row: &'a str, name: &str) -> &'a str {
    let begin = row.find(&format!("{name}: ")).unwrap_or_else(|| panic!("no {name}: {row}"));
    let rest = &row[begin + name.len() + 2..];
    rest.split([',', '}']).next().unwrap_or(rest)
}

#[test]
fn the_fmu_of_a_drive_gives_what_the_drive_gives() {
    let here = folder();
    done(here.path(), &["export", "dr300", "-o", "machine.fmu"]);
    put(here.path(), "native.toml", PLAN);
    put(here.path(), "fmu.toml", PLAN.replace("seed", "fmu = \"machine.fmu\"\nseed"));
    done(here.path(), &["campaign", "native.toml", "-o", "native", "--quiet"]);
    done(here.path(), &["campaign", "fmu.toml", "-o", "fmu", "--quiet"]);
    let (native, fmu) = (rows(here.path(), "native"), rows(here.path(), "fmu"));
    assert_eq!((native.len(), fmu.len()), (24, 24));
    for (native, fmu) in native.iter().zip(&fmu) {
        assert_eq!(
            (value(fmu, "status"), value(fmu, "failure")),
            ("\"done\"", "\"none\""),
            "{fmu}"
        );
        for same in ["fault_kind", "fault_size", "R", "cusum_detected", "bands_false_alarms"] {
            assert_eq!(value(native, same), value(fmu, same), "{same}");
        }
        let residual = |row: &str| value(row, "residual").parse::<f64>().expect("a number");
        // Sub-steps differ; what a fault does to T is some ten rpm.
        assert!((residual(native) - residual(fmu)).abs() < 1e-3, "{native}\n{fmu}");
    }
    let traces =
        |name: &str| here.path().join(name).join("traces").read_dir().map_or(0, Iterator::count);
    assert!(traces("fmu") > 0 && traces("fmu") == traces("native"));
    // Shares of it are one dataset, and nothing that was unpacked stays.
    done(here.path(), &["campaign", "fmu.toml", "-o", "again", "--shard", "1/1", "--quiet"]);
    let bytes =
        |name: &str| std::fs::read(here.path().join(name).join("campaign.parquet")).expect("it");
    assert!(bytes("fmu") == bytes("again"));
    let left = here.path().join("fmu").read_dir().expect("a folder").count();
    assert_eq!(left, 3, "dataset, design, traces");
}

#[test]
fn a_process_that_an_fmu_ends_costs_one_scenario() {
    let here = folder();
    done(here.path(), &["export", "dr300", "--fmi", "2", "-o", "machine.fmu"]);
    let plan =
        PLAN.replace("seed", "fmu = \"machine.fmu\"\nseed").replace("draws = 8", "draws = 30");
    put(here.path(), "plan.toml", plan);
    done(here.path(), &["campaign", "plan.toml", "-o", "whole", "--quiet"]);
    let mut drill = program(here.path());
    drill.args(["campaign", "plan.toml", "-o", "drill"]).env("DRIVESCOPE_ABORT_AT", "67");
    let ran = drill.output().expect("the program starts");
    let said = String::from_utf8_lossy(&ran.stderr);
    assert_eq!(ran.status.code(), Some(0), "{said}");
    assert!(said.contains("scenario 67 has no result"), "{said}");
    for (k, (whole, drill)) in
        rows(here.path(), "whole").iter().zip(&rows(here.path(), "drill")).enumerate()
    {
        assert_eq!(value(drill, "status") == "\"aborted\"", k == 67, "{drill}");
        assert!(k == 67 || whole == drill, "{k}");
        assert!(
            k != 67 || drill.contains("failure: \"it ended the process that ran it\""),
            "{drill}"
        );
    }
    let said = done(here.path(), &["campaign", "report", "drill", "--json", "-"]).json();
    assert_eq!(said["aborted"], serde_json::json!([67]));
}

/// A speed control of another tool, under its own names and units; it refuses a step at one
/// resistance, ends its process at another, and at a third one never comes back.
const MACHINE: &str = r#"
import os
import time as clock

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real


class Machine(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.wanted = 0.0
        self.slip = 0.0
        self.resistance = 3.0
        self.control = 0.0
        self.shown = 0.0
        self.current = 0.0
        self.speed = 0.0
        self.sum = 0.0
        name = Fmi2Causality.input
        self.register_variable(Real("wanted", causality=name))
        self.register_variable(Real("slip", causality=name))
        parameter = {"causality": Fmi2Causality.parameter, "variability": Fmi2Variability.tunable}
        self.register_variable(Real("resistance", **parameter))
        for shown in ("control", "shown", "current"):
            self.register_variable(Real(shown, causality=Fmi2Causality.output))

    def do_step(self, time, step):
        if self.resistance > 7.0:
            clock.sleep(3600.0)
        if self.resistance > 5.0:
            os.abort()
        if self.resistance > 4.0 and time > 0.5:
            return False
        self.shown = self.speed * (1.0 + self.slip)
        error = self.wanted - self.shown
        self.sum += 0.477 * step * error
        self.control = max(-10.0, min(10.0, 0.0382 * error + self.sum))
        self.current = (2.4 * self.control - 0.06 * self.speed) / self.resistance
        self.speed += step * (0.06 * self.current - 6e-5 * self.speed - 0.016) / 1e-3
        return True
"#;

fn machine(here: &Path) -> bool {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/.venv/bin/python");
    let python = std::env::var_os("DRIVESCOPE_PYTHON").unwrap_or_else(|| beside.into());
    put(here, "machine.py", MACHINE);
    let built = Command::new(python)
        .args(["-m", "pythonfmu", "build", "-f", "machine.py", "-d", "."])
        .current_dir(here)
        .output();
    let built = built.is_ok_and(|output| output.status.success());
    if !built {
        println!("NOT RUN: no Python with pythonfmu; set DRIVESCOPE_PYTHON to one");
    }
    built
}

const FOREIGN: &str = "schema = 1\ndrive = \"dr300\"\nfmu = \"Machine.fmu\"\nfmu_time_limit = 15\ndraws = 1\nduration = 1.5\n\
    [fmu_variables]\nreference = \"wanted\"\nfault_tacho = \"slip\"\nR = \"resistance\"\n\
    C_m = \"control\"\nT = \"shown\"\nI_m = \"current\"\n\
    [parameters]\nR = { grid = [3.0, 3.2, 4.5, 3.4, 6.0, 8.0, 3.6] }\n\
    \"noise.reference\" = 0\n\"noise.omega\" = 0\n\"noise.i\" = 0\n\"noise.torque\" = 0\n\
    [[fault]]\nkind = \"tacho\"\nsize = 0.2\nonset = 1.0\n[detector]\nrun_up = 0.6\n\
    [design]\nsamples = 20000\n";

#[test]
fn an_fmu_of_another_tool_is_the_machine_under_its_own_names() {
    let here = folder();
    if !machine(here.path()) {
        return;
    }
    put(here.path(), "plan.toml", FOREIGN);
    done(here.path(), &["campaign", "plan.toml", "-o", "a", "--quiet"]);
    let rows = rows(here.path(), "a");
    let status: Vec<&str> = rows.iter().map(|row| value(row, "status")).collect();
    let [done_, aborted] = ["\"done\"", "\"aborted\""];
    assert_eq!(status, [done_, done_, aborted, done_, aborted, aborted, done_]);
    assert!(rows[4].contains("failure: \"it ended the process that ran it\""), "{}", rows[4]);
    assert!(value(&rows[2], "failure").contains("asked for the end at 0.51"), "{}", rows[2]);
    let given_up = "failure: \"it took longer than 15 s (fmu_time_limit)\"";
    assert!(rows[5].contains(given_up), "{}", rows[5]);
    for row in [&rows[0], &rows[1], &rows[3], &rows[6]] {
        // A reading that is a fifth too high is a fifth of the speed off.
        let residual: f64 = value(row, "residual").parse().expect("a number");
        assert!(residual.is_finite() && residual != 0.0, "{row}");
    }
    for (from, to, said) in [
        (
            "C_m = \"control\"",
            "C_m = \"contro\"",
            "plan.toml:11:7: `fmu`: Machine.fmu has no output `contro`",
        ),
        (
            "fault_tacho = \"slip\"\n",
            "",
            "plan.toml:3:7: `fmu`: Machine.fmu has no input `fault_tacho`",
        ),
        ("\"noise.i\" = 0\n", "", "or set that noise to 0 under [parameters]"),
        ("R = \"resistance\"", "Q = \"resistance\"", "`Q` is no variable"),
        ("fmu = \"Machine.fmu\"\n", "", "there is no `fmu` that has variables"),
        (
            "_limit = 15",
            "_limit = 0",
            "plan.toml:4:18: `fmu_time_limit` may be 0: it takes a time up to",
        ),
        ("\"Machine.fmu\"", "\"None.fmu\"", "plan.toml:3:7: `fmu`: there is no file `None.fmu`"),
        (
            "\"Machine.fmu\"",
            "\"machine.py\"",
            "plan.toml:3:7: machine.py: not a readable zip archive",
        ),
    ] {
        put(here.path(), "plan.toml", FOREIGN.replace(from, to));
        let message = refused(here.path(), &["campaign", "plan.toml", "-o", "b"]);
        assert!(message.contains(said), "{said}: {message}");
    }
}
