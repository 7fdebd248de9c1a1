//! The state machine on a model with one variable of each sort, without C.

use std::path::Path;

use super::lifecycle::Experiment;
use super::values::Boolean2;
use super::*;
use crate::description::{LogCategory, Version, tests::description};

/// x' = k u, y = x + u; fails at u = 9, panics at u = 10.
#[derive(Clone, Debug, PartialEq)]
struct Tiny {
    t: f64,
    values: [f64; 10],
}

#[derive(Debug, thiserror::Error)]
#[error("outer")]
struct Outer(#[source] Inner);

#[derive(Debug, thiserror::Error)]
#[error("inner {0}")]
struct Inner(f64);

impl Model for Tiny {
    type Error = Outer;

    fn instantiate(_: Option<&Path>) -> Result<Self, Outer> {
        let mut values = [0.0; 10];
        for variable in description().variables {
            values[variable.reference as usize] = variable.start.unwrap_or(0.0);
        }
        Ok(Self { t: 0.0, values })
    }

    fn description(&self) -> ModelDescription {
        description()
    }

    fn get(&self, reference: u32) -> Option<f64> {
        match reference {
            4 => Some(self.values[1] * self.values[2]),
            5 => Some(self.values[3] + self.values[2]),
            6 => None,
            other => self.values.get(other as usize).copied(),
        }
    }

    fn set(&mut self, reference: u32, value: f64) -> Result<(), Outer> {
        self.values[reference as usize] = value;
        Ok(())
    }

    fn initialize(&mut self, start: f64) -> Result<(), Outer> {
        self.t = start;
        Ok(())
    }

    fn step(&mut self, t: f64, h: f64) -> Result<(), Outer> {
        assert!(self.values[2] < 10.0, "u is {}", self.values[2]);
        if self.values[2] == 9.0 {
            return Err(Outer(Inner(9.0)));
        }
        self.values[3] += h * self.values[1] * self.values[2];
        self.t = t + h;
        Ok(())
    }

    fn serialize(&self) -> Vec<u8> {
        [&[self.t], &self.values[..]].concat().iter().flat_map(|v| v.to_le_bytes()).collect()
    }

    fn deserialize(&mut self, bytes: &[u8]) -> Result<(), Outer> {
        let (numbers, _) = bytes.as_chunks::<8>();
        let numbers: Vec<f64> = numbers.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
        let length = Inner(numbers.len() as f64);
        let (t, values) = numbers.split_first().ok_or(Outer(Inner(0.0)))?;
        self.values = values.try_into().map_err(|_| Outer(length))?;
        self.t = *t;
        Ok(())
    }

    fn continuous(&mut self) -> Option<&mut dyn Continuous<Error = Outer>> {
        Some(self)
    }
}

impl Continuous for Tiny {
    type Error = Outer;

    fn set_time(&mut self, t: f64) {
        self.t = t;
    }

    fn states(&self) -> &[f64] {
        &self.values[3..4]
    }

    fn set_states(&mut self, states: &[f64]) {
        self.values[3] = states[0];
    }

    fn derivatives(&mut self) -> Result<&[f64], Outer> {
        // Beyond its range the right-hand side is not a number.
        self.values[4] = if self.values[3] > 100.0 { f64::NAN } else { self.values[1] };
        Ok(&self.values[4..5])
    }

    fn event_indicators(&mut self) -> Result<&[f64], Outer> {
        Ok(&self.values[6..7])
    }

    fn update_discrete(&mut self) -> Result<DiscreteUpdate, Outer> {
        Ok(DiscreteUpdate { next_event: Some(self.t + 1.0), ..DiscreteUpdate::default() })
    }
}

fn instance(interface: Interface) -> Instance<Tiny> {
    Instance::new(Version::Two, interface, "tiny", &description().token(), None, true).unwrap()
}

fn running(interface: Interface) -> Instance<Tiny> {
    let mut instance = instance(interface);
    instance.setup_experiment(Experiment::new(None, 1.0, Some(2.0))).unwrap();
    instance.enter_initialization().unwrap();
    instance.exit_initialization().unwrap();
    instance
}

/// Status and text of the one message.
fn answered(
    instance: &mut Instance<Tiny>,
    work: impl FnOnce(&mut Instance<Tiny>) -> Result<(), Refusal>,
) -> (Status, String) {
    instance.take_messages();
    let status = instance.answer(Version::Two, "f", work);
    let text = instance.take_messages().pop().map(|message| message.text);
    (status, text.unwrap_or_default())
}

#[test]
fn instantiation_wants_a_name_the_token_and_an_offered_interface() {
    let new = |name: &str, token: &str| {
        let interface = Interface::CoSimulation;
        Instance::<Tiny>::new(Version::Three, interface, name, token, None, false).map(|_| ())
    };
    assert!(matches!(new(" ", &description().token()), Err(Refusal::EmptyName)));
    assert!(matches!(new("a", "{wrong}"), Err(Refusal::Token { .. })));
    assert!(new("a", &description().token()).is_ok());
}

#[test]
fn modes_follow_one_another_as_the_standard_says() {
    let mut one = instance(Interface::ModelExchange);
    assert!(matches!(one.enter_initialization(), Err(Refusal::NoExperiment)));
    assert!(matches!(one.enter_event_mode(), Err(Refusal::WrongPhase { .. })));
    let mut one = running(Interface::ModelExchange);
    assert_eq!(one.run.phase, Phase::Event);
    assert!(matches!(one.set_states(&[0.0]), Err(Refusal::WrongPhase { .. })));
    assert_eq!(one.update_discrete().unwrap().next_event, Some(2.0));
    one.enter_continuous_time_mode().unwrap();
    assert!(matches!(one.update_discrete(), Err(Refusal::WrongPhase { .. })));
    one.set_states(&[4.0]).unwrap();
    one.set_time(1.5).unwrap();
    let mut states = [0.0];
    one.states(&mut states).unwrap();
    assert_eq!((states, one.model.t, one.time()), ([4.0], 1.5, 1.5));
    assert!(matches!(one.do_step(1.5, 0.1), Err(Refusal::OtherInterface(_))));
    one.completed_integrator_step().unwrap();
    one.enter_event_mode().unwrap();
    one.terminate().unwrap();
    assert!(matches!(one.terminate(), Err(Refusal::WrongPhase { .. })));
    one.reset().unwrap();
    assert_eq!(one.model, Tiny::instantiate(None).unwrap());
    assert_eq!(one.run.phase, Phase::Instantiated);
}

#[test]
fn values_are_set_when_the_standard_allows_it() {
    let set = |one: &mut Instance<Tiny>, reference| {
        one.answer(Version::Two, "set", |one| one.set(&[reference], &[0.25]))
    };
    use Status::{Error, Ok, Warning};
    // k tunable, u discrete input, x exact state, y output, g constant.
    let references = [1, 2, 3, 5, 9];
    let mut before = instance(Interface::ModelExchange);
    assert_eq!(references.map(|r| set(&mut before, r)), [Ok, Ok, Ok, Error, Error]);
    let mut events = running(Interface::ModelExchange);
    assert_eq!(references.map(|r| set(&mut events, r)), [Ok, Ok, Error, Error, Error]);
    let mut between = running(Interface::ModelExchange);
    between.enter_continuous_time_mode().unwrap();
    assert_eq!(references.map(|r| set(&mut between, r)), [Warning, Warning, Error, Error, Error]);
    assert_eq!(between.model.get(2), Some(0.0), "held");
    assert!(between.set(&[2], &[0.0]).is_ok(), "the same value is no change");
    let mut steps = running(Interface::CoSimulation);
    assert_eq!(references.map(|r| set(&mut steps, r)), [Ok, Ok, Error, Error, Error]);
    steps.terminate().unwrap();
    assert_eq!(references.map(|r| set(&mut steps, r)), [Error; 5]);
}

#[test]
fn a_refused_set_changes_nothing() {
    let mut one = running(Interface::CoSimulation);
    for (values, name) in [([1.0, f64::NAN], "NaN"), ([1.0, 1e-9], "below min")] {
        assert!(one.set(&[2, 1], &values).is_err(), "{name}");
        assert_eq!((one.model.get(2), one.model.get(1)), (Some(0.0), Some(2.0)), "{name}");
    }
    assert!(matches!(one.set(&[2], &[10.5]), Err(Refusal::Range { .. })));
    let said = |min, max| {
        let (name, value) = ("x".to_owned(), -3.0);
        Refusal::Range { name, value, min, max }.to_string()
    };
    let above = said(Some(f64::MIN_POSITIVE), None);
    assert_eq!(above, "variable x: -3 is not allowed, it must be above 0");
    assert!(said(Some(-1.0), Some(2.5)).ends_with("be -1 or more and at most 2.5"));
    assert!(matches!(one.set(&[8], &[1.0]), Err(Refusal::WrongKind { .. })));
    assert!(matches!(one.set(&[0], &[1.0]), Err(Refusal::NotSettable { .. })));
    assert!(matches!(one.set(&[2], &[1.0, 2.0]), Err(Refusal::Length { .. })));
}

#[test]
fn values_are_read_by_type_and_time_is_one() {
    let mut one = running(Interface::CoSimulation);
    let mut values = [0.0; 2];
    one.get(&[0, 3], &mut values).unwrap();
    assert_eq!(values, [1.0, 1.0]);
    let (mut n, mut held) = ([0_i32], [Boolean2::FALSE]);
    one.get(&[7], &mut n).unwrap();
    one.get(&[8], &mut held).unwrap();
    assert_eq!((n, held[0] != Boolean2::FALSE), ([3], true));
    assert!(matches!(one.get(&[7], &mut values[..1]), Err(Refusal::WrongKind { .. })));
    assert!(matches!(one.get(&[6], &mut values[..1]), Err(Refusal::NoValue(_))));
    let early = instance(Interface::CoSimulation);
    assert!(matches!(early.get(&[3], &mut values[..1]), Err(Refusal::WrongPhase { .. })));
    assert_eq!(answered(&mut one, |i| i.no_such_type("String", &[1])).0, Status::Error);
}

#[test]
fn steps_join_and_end_at_the_stop_time() {
    let mut one = running(Interface::CoSimulation);
    one.set(&[2], &[0.5]).unwrap();
    one.do_step(1.0, 0.75).unwrap();
    assert_eq!((one.model.get(3), one.time()), (Some(1.75), 1.75));
    assert!(matches!(one.do_step(1.0, 0.25), Err(Refusal::CommunicationPoint { .. })));
    assert!(matches!(one.do_step(1.75, 0.5), Err(Refusal::BeyondStop { .. })));
    for h in [0.0, -0.25] {
        assert!(matches!(one.do_step(1.75, h), Err(Refusal::StepSize(_))));
    }
    assert_eq!(one.last_successful_time(2).unwrap(), 1.75);
    one.do_step(1.75 + 1e-12, 0.25).unwrap();
}

#[test]
fn an_error_of_the_model_ends_the_run_but_not_the_instance() {
    let mut one = running(Interface::CoSimulation);
    let good = one.save_state(0).unwrap();
    one.set(&[2], &[9.0]).unwrap();
    let (status, text) = answered(&mut one, |i| i.do_step(1.0, 0.1));
    assert_eq!((status, text.as_str()), (Status::Error, "f: step: outer: inner 9"));
    assert!(matches!(one.do_step(1.0, 0.1), Err(Refusal::WrongPhase { now: Phase::Failed, .. })));
    one.restore_state(good).unwrap();
    one.do_step(1.0, 0.1).unwrap();
}

#[test]
fn a_panic_ends_the_instance() {
    let mut one = running(Interface::CoSimulation);
    one.set(&[2], &[10.0]).unwrap();
    let (status, text) = answered(&mut one, |i| i.do_step(1.0, 0.1));
    assert_eq!(status, Status::Fatal);
    assert!(text.contains("u is 10"), "{text}");
    assert_eq!(answered(&mut one, |i| i.reset()).0, Status::Fatal);
}

#[test]
fn a_derivative_that_is_no_number_is_discarded() {
    let mut one = running(Interface::ModelExchange);
    one.enter_continuous_time_mode().unwrap();
    one.set_states(&[101.0]).unwrap();
    assert_eq!(answered(&mut one, |i| i.derivatives(&mut [0.0])).0, Status::Discard);
    assert!(matches!(one.set_states(&[f64::NAN]), Err(Refusal::Value { .. })));
    one.set_states(&[1.0]).unwrap();
    one.derivatives(&mut [0.0]).unwrap();
}

#[test]
fn states_are_deep_and_belong_to_one_interface() {
    let mut one = running(Interface::CoSimulation);
    let key = one.save_state(0).unwrap();
    one.set(&[2], &[0.5]).unwrap();
    one.do_step(1.0, 0.5).unwrap();
    let bytes = one.serialize_state(key).unwrap();
    one.restore_state(key).unwrap();
    assert_eq!((one.time(), one.model.get(2), one.model.get(3)), (1.0, Some(0.0), Some(1.0)));
    one.free_state(key).unwrap();
    assert!(matches!(one.free_state(key), Err(Refusal::UnknownState(_))));
    assert!(matches!(one.restore_state(key), Err(Refusal::UnknownState(_))));
    one.free_state(0).unwrap();

    let mut two = instance(Interface::CoSimulation);
    let copy = two.deserialize_state(&bytes, 0).unwrap();
    two.restore_state(copy).unwrap();
    assert_eq!((two.run, &two.model), (one.run, &one.model));
    let mut other = instance(Interface::ModelExchange);
    let refused = other.deserialize_state(&bytes, 0);
    assert!(matches!(refused, Err(Refusal::Serialized(SerializedError::OtherInterface))));
    for cut in [0, 7, 20, 40, bytes.len() - 1] {
        assert!(two.deserialize_state(&bytes[..cut], 0).is_err(), "{cut} bytes");
    }
}

#[test]
fn only_the_chosen_categories_are_logged() {
    let mut one = running(Interface::CoSimulation);
    let refused = |one: &mut Instance<Tiny>| !answered(one, |i| i.do_step(1.0, 0.0)).1.is_empty();
    assert!(refused(&mut one));
    one.set_debug_logging(true, &[LogCategory::Events.name()]).unwrap();
    assert!(!refused(&mut one), "only events");
    one.set_debug_logging(true, &[]).unwrap();
    assert!(refused(&mut one));
    one.set_debug_logging(false, &["logStatusError"]).unwrap();
    assert!(!refused(&mut one));
    one.set_debug_logging(true, &["logAll"]).unwrap();
    assert!(refused(&mut one));
    assert!(one.set_debug_logging(true, &["logNothing"]).is_err());
    one.set_debug_logging(false, &[]).unwrap();
    assert_eq!(answered(&mut one, |i| i.terminate()), (Status::Ok, String::new()));
}

#[test]
fn what_went_wrong_is_said_without_debug_logging() {
    let token = instance(Interface::CoSimulation).table.token;
    let mut one =
        Instance::<Tiny>::new(Version::Two, Interface::CoSimulation, "one", &token, None, false)
            .expect("it is instantiated");
    let (status, text) = answered(&mut one, |i| i.do_step(1.0, 0.1));
    assert_eq!(status, Status::Error);
    assert!(!text.is_empty());
    assert_eq!(answered(&mut one, |i| i.reset()), (Status::Ok, String::new()), "no debugging");
}

#[test]
fn the_functions_of_the_other_version_are_refused() {
    let mut one = running(Interface::CoSimulation);
    assert_eq!(one.answer(Version::Three, "fmi3Reset", |i| i.reset()), Status::Error);
    assert_eq!(one.run.phase, Phase::Step);
}
