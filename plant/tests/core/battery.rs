//! The drives of the battery: one for every line of the registry, one with a typed law, one
//! with a learned curve, one with everything. No second list of effects: what is registered is tested.

use std::f64::consts::TAU;
use std::sync::Arc;

use drivescope_numerics::Real;
use drivescope_plant::effects::custom::{Law, Target};
use drivescope_plant::effects::learned::{Curve, Factor, Over};
use drivescope_plant::effects::registry::{Entry, Kind, REGISTRY};
use drivescope_plant::model::{Model, Part};

use crate::support::{dr300_friction, dr300_motor};

/// A drive of the battery: the DR300 with its friction, and one effect or all.
pub(crate) struct Case {
    pub(crate) name: &'static str,
    /// The registered effect under test, if it is a single one.
    pub(crate) entry: Option<&'static Entry>,
    /// Kinds and nominal values of the parameters.
    pub(crate) parts: Vec<(Kind, Vec<f64>)>,
    pub(crate) laws: Arc<[Law]>,
}

impl Case {
    /// The drive over any scalar; `value` turns the flat parameter number k into the scalar.
    pub(crate) fn model<R: Real>(&self, mut value: impl FnMut(usize, f64) -> R) -> Model<R, 1> {
        let mut k = 0;
        let parts: Vec<Part<R>> = self
            .parts
            .iter()
            .map(|(kind, values)| {
                let parameters = values.iter().map(|v| {
                    k += 1;
                    value(k - 1, *v)
                });
                Part { kind: *kind, parameters: parameters.collect() }
            })
            .collect();
        Model::new(dr300_motor(), false, &parts, self.laws.clone())
    }

    /// The drive at its nominal values.
    pub(crate) fn nominal<R: Real>(&self) -> Model<R, 1> {
        self.model(|_, value| R::constant(value))
    }

    /// Whether a law of the drive has a kink that steps cross without locating it.
    pub(crate) fn kinked(&self) -> bool {
        let has = |kind: Kind| REGISTRY.iter().any(|e| e.kind == kind && e.info.kinked);
        self.parts.iter().any(|(kind, _)| has(*kind))
    }

    /// Flat parameters of the effects.
    pub(crate) fn parameters(&self) -> Vec<f64> {
        self.parts.iter().flat_map(|(_, values)| values.clone()).collect()
    }
}

fn friction() -> Vec<(Kind, Vec<f64>)> {
    let parts = dr300_friction::<f64>();
    parts.into_iter().map(|part| (part.kind, part.parameters)).collect()
}

fn nominal(entry: &Entry) -> (Kind, Vec<f64>) {
    (entry.kind, entry.parameters.iter().map(|p| p.nominal).collect())
}

/// The base drive: motor, Coulomb and Stribeck friction.
pub(crate) fn base() -> Case {
    Case { name: "base", entry: None, parts: friction(), laws: Arc::from([]) }
}

/// The base drive with that effect added (its own friction once).
pub(crate) fn with(entry: &'static Entry) -> Case {
    let mut parts = friction();
    parts.retain(|(kind, _)| *kind != entry.kind);
    parts.push(nominal(entry));
    Case { name: entry.info.id, entry: Some(entry), parts, laws: Arc::from([]) }
}

fn typed_law() -> Law {
    let names = ["c".to_owned(), "a".to_owned()];
    let text = "-c * omega * abs(omega) + a * sin(3 * theta) * exp(-i^2) * cos(t)";
    Law::parse(Target::Torque, text, &names).expect("a valid law")
}

/// The effects that can stand in one drive together; of those that cannot, the first.
fn together() -> impl Iterator<Item = &'static Entry> {
    REGISTRY.iter().enumerate().filter_map(|(k, entry)| {
        let before = REGISTRY[..k].iter().map(|other| other.info.id);
        entry.info.excluded_by(before).is_none().then_some(entry)
    })
}

/// A torque over the angle, repeated every revolution.
fn learned_law() -> Law {
    let knots = [0.0, 1.0, 2.5, 4.0, 5.5];
    let curve = Curve::new(Over::Position, &knots, Some(TAU)).expect("right knots");
    Law::learned(Target::Torque, curve)
}

/// A dry friction that falls with the speed, and a flux that the current weakens.
fn learned_factors() -> [(Law, Vec<f64>); 2] {
    let over = |over, knots: &[f64]| Curve::new(over, knots, None).expect("right knots");
    let dry = over(Over::SpeedMagnitude, &[0.0, 5.0, 60.0]).times(Some(Factor::Direction));
    let weak = over(Over::CurrentMagnitude, &[0.0, 1.0, 8.0]);
    [
        (Law::learned(Target::Torque, dry), vec![-0.004, -0.003, -0.002]),
        (Law::learned(Target::Flux, weak), vec![0.0, -0.03, -0.2]),
    ]
}

/// Every drive of the battery.
pub(crate) fn cases() -> Vec<Case> {
    let typed = (Kind::Custom(0), vec![3e-7, 0.002]);
    let learned = (Kind::Custom(1), vec![0.002, -0.001, 0.001, -0.002, 0.0015]);
    let laws: Arc<[Law]> = Arc::from([typed_law(), learned_law()]);
    let mut cases: Vec<Case> = REGISTRY.iter().map(with).collect();
    for (name, law) in [("custom", &typed), ("learned", &learned)] {
        let mut parts = friction();
        parts.push(law.clone());
        cases.push(Case { name, entry: None, parts, laws: laws.clone() });
    }
    for (name, (law, values)) in ["learned dry", "learned flux"].into_iter().zip(learned_factors())
    {
        let mut parts = friction();
        parts.push((Kind::Custom(0), values));
        cases.push(Case { name, entry: None, parts, laws: Arc::from([law]) });
    }
    // Everything that leaves the shaft sticking, and everything.
    for (name, sticks) in [("all that stick", true), ("all", false)] {
        let mut parts: Vec<(Kind, Vec<f64>)> =
            together().filter(|entry| !(sticks && entry.info.replaces_dry)).map(nominal).collect();
        parts.extend([typed.clone(), learned.clone()]);
        cases.push(Case { name, entry: None, parts, laws: laws.clone() });
    }
    cases
}
