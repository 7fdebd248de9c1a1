//! Our own exporter's example through our own importer: both versions, both interface types.

use drivescope_fmu::archive::{Archive, Platform};
use drivescope_fmu::cosim::{Experiment, FmuComponent, System};
use drivescope_fmu::description::Version;
use drivescope_fmu::export::Model;
use drivescope_fmu::import::{Fmu, Instance, InstanceOptions, Interface, validate};

#[path = "../oscillator/mod.rs"]
mod oscillator;

/// Co-Simulation errs by 1e-12 here, Model Exchange by the tolerance below, a little more after each
/// of the events.
const ALLOWED: f64 = 1e-7;
const TOLERANCE: f64 = 1e-10;
const STEP: f64 = 0.01;

/// The example's FMU of both versions, in a folder that lives as long as the result.
fn examples() -> (tempfile::TempDir, Vec<Fmu>) {
    let library = oscillator::library();
    let description = oscillator::model::Oscillator::instantiate(None).expect("it").description();
    let archive = Archive {
        description: &description,
        libraries: vec![(Platform::host().expect("a platform"), &library)],
        resources: vec![("readme.txt".into(), b"nothing")],
        documentation: vec![],
    };
    let folder = tempfile::tempdir().expect("a folder");
    let open = |(version, name)| {
        let path = folder.path().join(name);
        std::fs::write(&path, archive.to_bytes(version).expect("an FMU")).expect("written");
        Fmu::open(&path).expect("an FMU")
    };
    let fmus = [(Version::Two, "two.fmu"), (Version::Three, "three.fmu")].map(open);
    (folder, fmus.into())
}

fn start(fmu: &Fmu, kind: Interface) -> Instance {
    let mut instance = fmu.instantiate(kind, &InstanceOptions::default()).expect("an instance");
    instance.initialize(0.0, Some(2.0), Some(TOLERANCE)).expect("a start");
    instance
}

/// Steps with a changing input; position and velocity after each.
fn drive(p: &mut Instance, first: u32, steps: u32) -> Vec<[f64; 2]> {
    let outputs = p.group(&["x", "v"]).expect("outputs");
    let input = p.group(&["u"]).expect("an input");
    (first..first + steps)
        .map(|k| {
            let time = f64::from(k) * STEP;
            p.write(&input, &[(5.0 * time).sin()]).expect("an input");
            p.step(time, STEP).expect("a step");
            let mut values = [0.0; 2];
            p.read(&outputs, &mut values).expect("outputs");
            values
        })
        .collect()
}

#[test]
fn the_exported_fmu_is_valid_and_its_interfaces_agree() {
    let (_folder, fmus) = examples();
    let mut runs = Vec::new();
    for fmu in &fmus {
        let found: Vec<String> = validate(fmu).iter().map(ToString::to_string).collect();
        assert_eq!(found, Vec::<String>::new());
        let cs = drive(&mut start(fmu, Interface::CoSimulation), 0, 200);
        let me = drive(&mut start(fmu, Interface::ModelExchange), 0, 200);
        for (k, (cs, me)) in cs.iter().zip(&me).enumerate() {
            let error = (cs[0] - me[0]).abs().max((cs[1] - me[1]).abs());
            assert!(error < ALLOWED, "step {k}: {cs:?} {me:?}");
        }
        runs.push(cs);
    }
    assert_eq!(runs[0], runs[1]);
}

#[test]
fn the_exported_fmu_replays_bit_for_bit() {
    let (_folder, fmus) = examples();
    for fmu in &fmus {
        for kind in [Interface::CoSimulation, Interface::ModelExchange] {
            let mut p = start(fmu, kind);
            drive(&mut p, 0, 37);
            let state = p.state().expect("a state");
            let first = drive(&mut p, 37, 60);
            p.restore(&state).expect("the state");
            assert_eq!(drive(&mut p, 37, 60), first);
            let bytes = p.serialize(&state).expect("bytes");
            let copy = p.deserialize(&bytes).expect("a state");
            p.restore(&copy).expect("the state");
            assert_eq!(drive(&mut p, 37, 60), first);
        }
    }
}

#[test]
fn exported_fmus_are_coupled() {
    let (_folder, fmus) = examples();
    let mut system = System::new(Experiment { rollback: true, ..Experiment::new(0.0, 1.0, STEP) });
    for (name, fmu) in ["a", "b"].iter().zip(&fmus) {
        let instance = fmu.co_simulation(&InstanceOptions::named(name)).expect("an instance");
        system.add(name, FmuComponent::new(instance)).expect("a name");
    }
    system.connect("a.force", "b.u").expect("a connection");
    system.record_all();
    let recording = system.run().expect("a run").recording;
    assert_eq!(recording.len(), 101);
    assert_ne!(recording.signal("a.x"), recording.signal("b.x"));
}
