//! The variables of the oscillator and its model structure.

use drivescope_fmu::description::{
    Capabilities, Causality, DefaultExperiment, Initial, ModelDescription, Structure, Type,
    UnitError, Unknown, Variability, Variable,
};

// Value references.
pub(super) const X: u32 = 1;
pub(super) const V: u32 = 2;
pub(super) const DER_X: u32 = 3;
pub(super) const DER_V: u32 = 4;
pub(super) const U: u32 = 5;
pub(super) const STUCK: u32 = 6;
pub(super) const EVENTS: u32 = 7;
pub(super) const Z_STOP: u32 = 8;
pub(super) const Z_BREAK: u32 = 9;
pub(super) const M: u32 = 10;
pub(super) const K: u32 = 11;
pub(super) const D: u32 = 12;
pub(super) const F_C: u32 = 13;
pub(super) const A: u32 = 14;
pub(super) const PANICS: u32 = 15;
pub(super) const FORCE: u32 = 16;
pub(super) const PUSH: u32 = 17;

pub(super) fn description() -> Result<ModelDescription, UnitError> {
    let unknown = |reference, dependencies: &[u32]| Unknown {
        reference,
        dependencies: dependencies.to_vec(),
    };
    Ok(ModelDescription {
        name: "Oscillator".into(),
        identifier: "oscillator".into(),
        description: "A mass on a spring with dry friction".into(),
        version: env!("CARGO_PKG_VERSION").into(),
        generation_tool: concat!("drivescope ", env!("CARGO_PKG_VERSION")).into(),
        capabilities: Capabilities {
            co_simulation: true,
            model_exchange: true,
            directional_derivatives: true,
            variable_step: true,
        },
        variables: variables()?,
        structure: Structure {
            outputs: vec![
                unknown(X, &[X]),
                unknown(V, &[V]),
                unknown(STUCK, &[]),
                unknown(EVENTS, &[]),
                unknown(FORCE, &[X, V, U, PUSH]),
            ],
            derivatives: vec![unknown(DER_X, &[V]), unknown(DER_V, &[X, V, U, PUSH])],
            event_indicators: vec![unknown(Z_STOP, &[V]), unknown(Z_BREAK, &[X, V, U, PUSH])],
            initial_unknowns: vec![
                unknown(DER_X, &[V]),
                unknown(DER_V, &[X, V, U, PUSH, M, K, D, F_C, A]),
                unknown(STUCK, &[X, V, U, PUSH, K, D, F_C, A]),
                unknown(EVENTS, &[]),
                unknown(FORCE, &[X, V, U, PUSH, K, D, A]),
            ],
        },
        default_experiment: DefaultExperiment {
            start: Some(0.0),
            stop: Some(2.0),
            tolerance: Some(1e-9),
            step: Some(0.01),
        },
    })
}

fn variables() -> Result<Vec<Variable>, UnitError> {
    use Causality::{Input, Local, Output, Parameter};
    use Variability::{Continuous, Discrete, Fixed, Tunable};
    let positive = |variable: Variable| Variable { min: Some(1e-6), ..variable };
    let state = |variable: Variable| Variable {
        initial: Some(Initial::Exact),
        nominal: Some(0.1),
        reinit: variable.reference == V,
        ..variable
    };
    let of = |state, variable: Variable| Variable { derivative_of: Some(state), ..variable };
    Ok(vec![
        state(Variable::new(X, "x", Output, Continuous).described("Position"))
            .in_unit("m")?
            .starting_at(0.05),
        state(Variable::new(V, "v", Output, Continuous).described("Velocity"))
            .in_unit("m/s")?
            .starting_at(0.0),
        of(X, Variable::new(DER_X, "der(x)", Local, Continuous)).in_unit("m/s")?,
        of(V, Variable::new(DER_V, "der(v)", Local, Continuous)).in_unit("m/s^2")?,
        Variable::new(U, "u", Input, Continuous)
            .described("Force on the mass")
            .in_unit("N")?
            .starting_at(0.0),
        Variable::new(PUSH, "push", Input, Discrete)
            .described("Force on the mass that changes at events only")
            .in_unit("N")?
            .starting_at(0.0),
        Variable {
            kind: Type::Boolean,
            ..Variable::new(STUCK, "stuck", Output, Discrete).described("The mass is stuck")
        },
        Variable {
            kind: Type::Int32,
            ..Variable::new(EVENTS, "events", Output, Discrete).described("Time events so far")
        },
        Variable::new(Z_STOP, "z.stop", Local, Continuous),
        Variable::new(Z_BREAK, "z.break_away", Local, Continuous),
        positive(Variable::new(M, "m", Parameter, Fixed).described("Mass"))
            .in_unit("kg")?
            .starting_at(1.0),
        positive(Variable::new(K, "k", Parameter, Tunable).described("Stiffness"))
            .in_unit("N/m")?
            .starting_at(40.0),
        Variable::new(D, "d", Parameter, Tunable)
            .described("Damping")
            .in_unit("N s/m")?
            .starting_at(0.2),
        positive(Variable::new(F_C, "coulomb.F_c", Parameter, Tunable).described("Friction"))
            .in_unit("N")?
            .starting_at(0.5),
        Variable::new(A, "A", Parameter, Tunable)
            .described("Amplitude of the square wave")
            .in_unit("N")?
            .starting_at(1.0),
        Variable {
            kind: Type::Boolean,
            ..Variable::new(PANICS, "panics", Parameter, Tunable)
                .described("The next step panics: the instance is lost, the importer is not")
                .starting_at(0.0)
        },
        Variable::new(FORCE, "force", Output, Continuous)
            .described("Force without dry friction")
            .in_unit("N")?,
    ])
}
