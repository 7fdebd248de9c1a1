//! What an FMU of another tool can do wrong, and what the importer says then.

use drivescope_fmu::import::{Error, Fmu, InstanceOptions, Interface, Value};

use crate::support::{archive, platform, probe, probe_file, probe_with};

#[test]
fn archives_that_are_no_fmus_are_refused() {
    let path = archive(&[("readme.txt", b"hello")]);
    let error = Fmu::open(&path).unwrap_err().to_string();
    let name = path.file_name().unwrap().to_string_lossy().into_owned();
    assert!(error.starts_with(&name) && error.contains("modelDescription.xml"), "{error}");
    let path = archive(&[("modelDescription.xml", b"<fmiModelDescription fmiVersion='1.0'/>")]);
    assert!(matches!(Fmu::open(path), Err(Error::Version { .. })));
    let path = archive(&[("modelDescription.xml", b"<a>\n<b>\n</a>")]);
    let error = Fmu::open(path).unwrap_err().to_string();
    assert!(error.contains("modelDescription.xml:3:1"), "{error}");
}

#[test]
fn an_fmu_for_another_platform_is_described_but_not_run() {
    let xml = include_bytes!("data/probe3.xml");
    let path = archive(&[("modelDescription.xml", xml), ("binaries/riscv64-plan9/probe.so", b"")]);
    let fmu = Fmu::open(path).unwrap();
    assert_eq!((fmu.description().variables.len(), fmu.platforms().len()), (20, 1));
    let error = fmu.co_simulation(&InstanceOptions::default()).unwrap_err();
    assert!(matches!(error, Error::Platform { .. }));
    assert!(error.to_string().contains("it has riscv64-plan9"), "{error}");
}

#[test]
fn a_damaged_binary_is_refused() {
    let xml = include_bytes!("data/probe3.xml");
    let name = format!("binaries/{}/probe{}", platform("3"), std::env::consts::DLL_SUFFIX);
    let fmu =
        Fmu::open(archive(&[("modelDescription.xml", xml), (&name, b"not a library")])).unwrap();
    assert!(matches!(fmu.co_simulation(&InstanceOptions::default()), Err(Error::Load { .. })));
}

#[test]
fn missing_functions_are_named() {
    // The FMI 2.0 binary has no function of FMI 3.0 at all.
    let Some(path) = probe_file("2", |text| text) else { return };
    let mut zip = zip::ZipArchive::new(std::fs::File::open(path).unwrap()).unwrap();
    let mut binary = Vec::new();
    std::io::copy(&mut zip.by_index(1).unwrap(), &mut binary).unwrap();
    let name = format!("binaries/{}/probe{}", platform("3"), std::env::consts::DLL_SUFFIX);
    let xml = include_bytes!("data/probe3.xml");
    let fmu = Fmu::open(archive(&[("modelDescription.xml", xml), (&name, &binary)])).unwrap();
    let error = fmu.co_simulation(&InstanceOptions::default()).unwrap_err().to_string();
    assert!(error.contains("fmi3DoStep"), "{error}");
    let missing = fmu.missing_functions(Interface::CoSimulation).unwrap();
    assert!(missing.len() > 70 && missing.iter().any(|name| name == "fmi3GetClock"), "{missing:?}");
    for fmi in ["2", "3"] {
        let whole = probe(fmi).unwrap().missing_functions(Interface::CoSimulation).unwrap();
        assert_eq!(whole, Vec::<String>::new());
    }
}

#[test]
fn what_the_fmu_says_is_in_the_error() {
    for (fmi, right) in [("2", "guid=\"{probe}\""), ("3", "Token=\"{probe}\"")] {
        let wrong = right.replace("{probe}", "{other}");
        let Some(fmu) = probe_with(fmi, |text| text.replace(right, &wrong)) else { return };
        let error = fmu.co_simulation(&InstanceOptions::default()).unwrap_err().to_string();
        assert!(error.contains("{other}"), "{error}");
        let fmu = probe(fmi).unwrap();
        let mut p = fmu.co_simulation(&InstanceOptions::named("p")).unwrap();
        p.set_value("T", &Value::Number(-1.0)).unwrap();
        let error = p.initialize(0.0, None, None).unwrap_err().to_string();
        assert!(error.contains("it says: T must be positive, but is -1"), "{error}");
        assert!(matches!(p.step(0.0, 0.1), Err(Error::Order { .. })));
        p.reset().unwrap();
        p.initialize(0.0, None, None).unwrap();
    }
}

#[test]
fn every_bad_status_of_a_step_is_an_error() {
    for fmi in ["2", "3"] {
        let Some(fmu) = probe(fmi) else { return };
        for status in [2, 3, 4, 5, 42, -7] {
            let mut p = fmu.co_simulation(&InstanceOptions::named("p")).unwrap();
            p.set_value("fail", &Value::Number(f64::from(status))).unwrap();
            p.initialize(0.0, None, None).unwrap();
            p.step(0.0, 0.5).unwrap();
            let error = p.step(0.5, 1.0).unwrap_err();
            let text = error.to_string();
            match (status, error) {
                (2, Error::Discard { time, target, reached, .. }) => {
                    assert_eq!((time, target, reached), (0.5, 1.5, 0.5));
                }
                (_, Error::Call { time, .. }) => assert_eq!(time, 0.5),
                (_, other) => panic!("{other}"),
            }
            assert!(text.contains("step to 1.5 s failed"), "{text}");
        }
    }
}

#[test]
fn an_fmu_that_allows_one_instance_gets_one() {
    let only = "<CoSimulation canBeInstantiatedOnlyOncePerProcess=\"true\"";
    let Some(fmu) = probe_with("3", |text| text.replace("<CoSimulation", only)) else { return };
    let first = fmu.co_simulation(&InstanceOptions::default()).unwrap();
    let second = fmu.clone().co_simulation(&InstanceOptions::default());
    assert!(matches!(second, Err(Error::OnlyOnce { .. })));
    drop(first);
    fmu.co_simulation(&InstanceOptions::default()).unwrap();
}

#[test]
fn an_interface_type_that_is_not_offered_is_named() {
    let cut = |text: String| {
        let (from, to) =
            (text.find("<ModelExchange").unwrap(), text.find("<CoSimulation").unwrap());
        format!("{}{}", &text[..from], &text[to..])
    };
    let Some(fmu) = probe_with("2", cut) else { return };
    let error = fmu.model_exchange(&InstanceOptions::default()).unwrap_err().to_string();
    assert!(error.contains("offers no Model Exchange; it offers Co-Simulation"), "{error}");
    assert!(matches!(
        fmu.co_simulation(&InstanceOptions::default()).map(|i| i.interface()),
        Ok(Interface::CoSimulation)
    ));
}
