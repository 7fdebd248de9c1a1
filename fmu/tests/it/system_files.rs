//! Systems read from `.toml`, `.ssd` and `.ssp` files.

use std::fs;
use std::path::{Path, PathBuf};

use drivescope_fmu::cosim::{Algorithm, open};
use drivescope_recording::{Recording, Signal};

use crate::support::{archive, probe_file};

type ReadError = Box<dyn std::error::Error + Send + Sync>;

/// The recording that all files may name.
fn read(path: &Path) -> Result<Recording, ReadError> {
    if !path.ends_with("input.csv") {
        return Err("no such recording".into());
    }
    let signals = vec![Signal { name: "w".into(), unit: "rpm".into(), values: vec![30.0; 3] }];
    Ok(Recording::new("input", 0.0, 0.1, signals))
}

fn outcome(path: &Path) -> Result<Recording, String> {
    let document = open(path).map_err(|error| error.to_string())?;
    let mut system = document.build(&read).map_err(|error| error.to_string())?;
    system.run().map(|outcome| outcome.recording).map_err(|error| error.to_string())
}

const TOML: &str = r#"
[experiment]
stop = 1.0
step = 0.01
algorithm = "jacobi"
[[component]]
name = "a"
fmu = "probe.fmu"
parameters = { T = 0.25, on = false, mode = "fast", label = "first" }
[[component]]
name = "b"
fmu = "probe.fmu"
kind = "model-exchange"
[[connect]]
from = "a.x"
to = "b.u"
factor = 2.0
[[input]]
recording = "input.csv"
signal = "w"
to = "a.u"
[[record]]
port = "b.x"
[[record]]
port = "a.u"
"#;

const SSD: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<ssd:SystemStructureDescription xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription" xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues" xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon" version="1.0" name="two">
  <ssd:System name="root">
    <ssd:Connectors><ssd:Connector name="x" kind="output"><ssc:Real unit="rad/s"/></ssd:Connector></ssd:Connectors>
    <ssd:Elements>
      <ssd:Component name="a" source="resources/probe.fmu" type="application/x-fmu-sharedlibrary">
        <ssd:ParameterBindings>
          <ssd:ParameterBinding><ssd:ParameterValues><ssv:ParameterSet version="1.0" name="p"><ssv:Parameters>
            <ssv:Parameter name="T"><ssv:Real value="0.25"/></ssv:Parameter>
            <ssv:Parameter name="on"><ssv:Boolean value="false"/></ssv:Parameter>
          </ssv:Parameters></ssv:ParameterSet></ssd:ParameterValues></ssd:ParameterBinding>
        </ssd:ParameterBindings>
      </ssd:Component>
      <ssd:Component name="b" source="resources/probe.fmu" implementation="CoSimulation"/>
    </ssd:Elements>
    <ssd:ParameterBindings><ssd:ParameterBinding source="resources/b.ssv" prefix="b."/></ssd:ParameterBindings>
    <ssd:Connections>
      <ssd:Connection startElement="a" startConnector="x" endElement="b" endConnector="u"><ssc:LinearTransformation factor="2.0"/></ssd:Connection>
      <ssd:Connection startElement="b" startConnector="x" endConnector="x"/>
    </ssd:Connections>
  </ssd:System>
  <ssd:DefaultExperiment startTime="0" stopTime="0.5"/>
</ssd:SystemStructureDescription>"#;

const SSV: &str = r#"<ssv:ParameterSet xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues" version="1.0" name="b">
  <ssv:Parameters><ssv:Parameter name="T"><ssv:Real value="0.125"/></ssv:Parameter></ssv:Parameters>
</ssv:ParameterSet>"#;

/// A folder with the probe where the files expect it.
fn folder() -> Option<tempfile::TempDir> {
    let probe = probe_file("3", |text| text)?;
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("resources")).unwrap();
    fs::copy(&probe, folder.path().join("probe.fmu")).unwrap();
    fs::copy(&probe, folder.path().join("resources/probe.fmu")).unwrap();
    fs::write(folder.path().join("resources/b.ssv"), SSV).unwrap();
    Some(folder)
}

fn put(folder: &Path, name: &str, text: &str) -> PathBuf {
    let path = folder.join(name);
    fs::write(&path, text).unwrap();
    path
}

/// `b.x` for a chain of two lags with a gain of 2 between, each stepped exactly, Jacobi.
fn chain(u: f64, first: f64, second: f64, steps: usize) -> f64 {
    let (p, q) = ((-0.01 / first).exp(), (-0.01 / second).exp());
    let (mut x, mut y) = (0.0, 0.0);
    for _ in 0..steps {
        (x, y) = (u + (x - u) * p, 2.0 * x + (y - 2.0 * x) * q);
    }
    y
}

#[test]
fn a_system_is_read_from_toml() {
    let Some(folder) = folder() else { return };
    let path = put(folder.path(), "system.toml", TOML);
    let recording = outcome(&path).unwrap();
    let names: Vec<_> = recording.signals.iter().map(|signal| signal.name.as_str()).collect();
    assert_eq!((names, recording.len()), (vec!["b.x", "a.u"], 101));
    let exact = chain(std::f64::consts::PI, 0.25, 0.5, 100);
    let found = recording.signals[0].values[100];
    // b is integrated with the tolerance of its default experiment, 1e-9.
    assert!((found - exact).abs() < 1e-6, "{found} {exact}");
}

#[test]
fn mistakes_in_a_system_have_line_and_column() {
    let Some(folder) = folder() else { return };
    for (from, to, expected) in [
        ("to = \"b.u\"", "to = \"b.v\"", "system.toml:14:1: component `b` has no input `v`"),
        ("T = 0.25", "Q = 0.25", "has no variable `Q`"),
        ("on = false", "on = 0.5", "system.toml:9:31: "),
        ("probe.fmu\"\nkind", "other.fmu\"\nkind", "system.toml:10:1: "),
        ("signal = \"w\"", "signal = \"v\"", "has no signal `v`; it has: w"),
        ("input.csv", "other.csv", "no such recording"),
        ("factor", "facto", "system.toml:17:1: unknown field `facto`"),
        ("port = \"a.u\"", "port = \"b.u\"", "system.toml:25:8: `b.u` is a connected input"),
        ("step = 0.01", "step = 0", "step size 0 s"),
    ] {
        assert!(TOML.contains(from), "{from}");
        let path = put(folder.path(), "system.toml", &TOML.replace(from, to));
        let error = outcome(&path).unwrap_err();
        assert!(error.contains(expected), "{expected}: {error}");
    }
    assert!(open("system.txt").unwrap_err().to_string().contains("give a .toml, .ssd or .ssp"));
}

#[test]
fn a_system_is_read_from_ssd_and_ssp() {
    let Some(folder) = folder() else { return };
    let ssd = put(folder.path(), "SystemStructure.ssd", SSD);
    let fmu = fs::read(folder.path().join("probe.fmu")).unwrap();
    let packed = archive(&[
        ("SystemStructure.ssd", SSD.as_bytes()),
        ("resources/probe.fmu", &fmu),
        ("resources/b.ssv", SSV.as_bytes()),
    ]);
    let ssp = folder.path().join("system.ssp");
    fs::copy(packed, &ssp).unwrap();
    let exact = chain(1.0, 0.25, 0.125, 50);
    for path in [ssd, ssp] {
        let mut document = open(&path).unwrap();
        document.algorithm = Algorithm::Jacobi;
        let recording = document.build(&read).unwrap().run().unwrap().recording;
        assert_eq!((recording.signals[0].name.as_str(), recording.len()), ("b.x", 51));
        let found = recording.signals[0].values[50];
        assert!((found - exact).abs() < 1e-12, "{found} {exact}");
    }
}

/// What `b.x` ends at when the SSD's `from` reads `to`.
fn changed(folder: &Path, ssd: &[(&str, &str)], ssv: &[(&str, &str)]) -> Result<f64, String> {
    let change = |text: &str, changes: &[(&str, &str)]| {
        changes.iter().fold(text.to_owned(), |text, (from, to)| {
            assert!(text.contains(from), "{from}");
            text.replace(from, to)
        })
    };
    fs::write(folder.join("resources/b.ssv"), change(SSV, ssv)).unwrap();
    let path = put(folder, "SystemStructure.ssd", &change(SSD, ssd));
    Ok(*outcome(&path)?.signals[0].values.last().unwrap())
}

#[test]
fn units_of_parameters_are_converted_or_refused() {
    let Some(folder) = folder() else { return };
    let plain = changed(folder.path(), &[], &[]).unwrap();
    // 0.125 s in ms: known by its name, or as the file defines it.
    let value = "<ssv:Real value=\"0.125\"/>";
    let millis = changed(folder.path(), &[], &[(value, "<ssv:Real value=\"125\" unit=\"ms\"/>")]);
    assert_eq!(millis.unwrap(), plain);
    let own = "<ssv:Real value=\"250\" unit=\"half\"/>";
    let units = "</ssv:Parameters><ssv:Units><ssc:Unit xmlns:ssc=\"http://ssp-standard.org/SSP1/SystemStructureCommon\" name=\"half\"><ssc:BaseUnit s=\"1\" factor=\"0.0005\"/></ssc:Unit></ssv:Units>";
    let defined = changed(folder.path(), &[], &[(value, own), ("</ssv:Parameters>", units)]);
    assert_eq!(defined.unwrap(), plain);
    let error = changed(folder.path(), &[], &[(value, own)]).unwrap_err();
    assert!(error.contains("`half`") && error.contains("`s`"), "{error}");
    let wrong = "<ssv:Real value=\"125\" unit=\"rpm\"/>";
    let error = changed(folder.path(), &[], &[(value, wrong)]).unwrap_err();
    assert!(error.contains("b.ssv") || error.contains(":2:19"), "{error}");
    assert!(error.contains("`rpm`") && error.contains("`s`"), "{error}");
}

#[test]
fn connectors_that_are_not_what_the_fmu_has_are_refused() {
    let Some(folder) = folder() else { return };
    let with = |connector: &str| {
        let element = format!(
            "type=\"application/x-fmu-sharedlibrary\"><ssd:Connectors>{connector}</ssd:Connectors>"
        );
        changed(folder.path(), &[("type=\"application/x-fmu-sharedlibrary\">", &element)], &[])
    };
    let plain = changed(folder.path(), &[], &[]).unwrap();
    for right in [
        "<ssd:Connector name=\"u\" kind=\"input\"/>",
        "<ssd:Connector name=\"x\" kind=\"output\"><ssc:Real unit=\"rad/s\"/></ssd:Connector>",
        "<ssd:Connector name=\"n\" kind=\"output\"><ssc:Integer/></ssd:Connector>",
        "<ssd:Connector name=\"T\" kind=\"parameter\"><ssc:Real unit=\"s\"/></ssd:Connector>",
    ] {
        assert_eq!(with(right).unwrap(), plain, "{right}");
    }
    for (wrong, said) in [
        ("<ssd:Connector name=\"y\" kind=\"output\"/>", "no such variable"),
        ("<ssd:Connector name=\"x\" kind=\"input\"/>", "declared as input, and is output"),
        (
            "<ssd:Connector name=\"x\" kind=\"output\"><ssc:Integer/></ssd:Connector>",
            "declared as Integer, and is of type Float64",
        ),
        (
            "<ssd:Connector name=\"on\" kind=\"input\"><ssc:Real/></ssd:Connector>",
            "declared as Real, and is of type Boolean",
        ),
        (
            "<ssd:Connector name=\"x\" kind=\"output\"><ssc:Real unit=\"kNm\"/></ssd:Connector>",
            "declared in `kNm`, and the FMU has it in `rad/s`",
        ),
        (
            "<ssd:Connector name=\"x\" kind=\"output\"><ssc:Real unit=\"rpm\"/></ssd:Connector>",
            "declared in `rpm`, and the FMU has it in `rad/s`",
        ),
    ] {
        let error = with(wrong).unwrap_err();
        assert!(error.contains(said) && error.contains(".ssd:"), "{said}: {error}");
    }
    // An output of the system: what it shows must be of its quantity.
    let system = "<ssc:Real unit=\"rad/s\"/>";
    let error = changed(folder.path(), &[(system, "<ssc:Real unit=\"kNm\"/>")], &[]).unwrap_err();
    assert!(error.contains("do not convert"), "{error}");
    assert_eq!(changed(folder.path(), &[(system, "<ssc:Real unit=\"rpm\"/>")], &[]), Ok(plain));
    // Without the conversion of units an output in rpm is taken for rad/s.
    let rpm = ("startConnector=\"x\" endElement", "startConnector=\"x_rpm\" endElement");
    let unconverted =
        ("endConnector=\"u\">", "endConnector=\"u\" suppressUnitConversion=\"true\">");
    let converted = changed(folder.path(), &[rpm], &[]).unwrap();
    let taken = changed(folder.path(), &[rpm, unconverted], &[]).unwrap();
    assert!((converted - plain).abs() < 1e-9 * plain, "{converted} {plain}");
    assert!((taken / plain - 30.0 / std::f64::consts::PI).abs() < 1e-6, "{taken} {plain}");
}

#[test]
fn what_an_ssd_asks_beyond_is_refused_with_its_place() {
    let Some(folder) = folder() else { return };
    for (from, to, expected) in [
        (
            "<ssd:Component name=\"b\"",
            "<ssd:SignalDictionaryReference name=\"b\"",
            ".ssd:14:7: <SignalDictionaryReference> within a system is not supported",
        ),
        (
            "resources/probe.fmu\" implementation",
            "../probe.fmu\" implementation",
            ".ssd:14:7: the source `../probe.fmu`",
        ),
        ("startElement=\"b\" ", "", ".ssd:19:7: an input of the system itself"),
        ("value=\"0.25\"", "value=\"x\"", ".ssd:9:37: "),
        ("name=\"T\"", "name=\"Q\"", ".ssd:9:13: "),
        ("LinearTransformation", "BooleanMappingTransformation", "BooleanMappingTransformation"),
        ("prefix=\"b.\"", "prefix=\"c.\"", "b.ssv:2:19: parameter `c.T` belongs to no component"),
        ("b.ssv", "c.ssv", ".ssd:16:28: "),
        ("</ssd:System>", "", ".ssd:"),
    ] {
        assert!(SSD.contains(from), "{from}");
        let path = put(folder.path(), "SystemStructure.ssd", &SSD.replace(from, to));
        let error = outcome(&path).unwrap_err();
        assert!(error.contains(expected), "{expected}: {error}");
    }
}
