//! What is known of an effect besides its law: for people, files and the discovery.

use super::grid::{Shape, Spans, nominal};

/// A parameter of an effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// Name in the drive file.
    pub name: &'static str,
    /// Unit for a rotary drive; [`crate::units::for_motion`] gives the linear one.
    pub unit: &'static str,
    /// A typical value: where a fit starts, and the scale of the parameter.
    pub nominal: f64,
    /// Least and greatest value that is physically possible.
    pub range: (f64, f64),
    /// One line for a person.
    pub description: &'static str,
}

/// A state of its own that an effect brings in; it starts at zero unless a fit estimates its start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OwnState {
    /// Name, after the effect's name and a dot.
    pub name: &'static str,
    /// Unit for a rotary drive.
    pub unit: &'static str,
    /// Typical size: the scale for error control.
    pub nominal: f64,
    /// One line for a person.
    pub description: &'static str,
    /// What a sensor beside those of the motor tells of it.
    pub beside: Option<Beside>,
}

/// A sensor beside those of the motor, which shows an own state of an effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Beside {
    /// Speed of the load: the motor's less the state.
    LoadSpeed,
    /// Position of the load: the motor's less the state.
    LoadPosition,
    /// Temperature: the state above the surroundings, K.
    Temperature,
}

impl Beside {
    /// Every one, in the order of its number.
    pub const ALL: [Self; 3] = [Self::LoadSpeed, Self::LoadPosition, Self::Temperature];
}

/// A variable over which a model may fail: those of the `where` list of a comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Variable {
    /// Speed.
    Omega,
    /// Direction of the motion.
    OmegaSign,
    /// Armature current (the commanded signal of a force-driven drive).
    Current,
    /// Position; a comparison shows it over the period that it finds, on a rotary drive the revolution
    /// or a part of it.
    Theta,
    /// Time since the start.
    Time,
    /// Acceleration of the shaft.
    Acceleration,
    /// Temperature: what slowly follows the losses.
    Temperature,
    /// Whether a signal is at its limit.
    Limits,
}

impl Variable {
    /// Every variable.
    pub const ALL: [Self; 8] = [
        Self::Omega,
        Self::OmegaSign,
        Self::Current,
        Self::Theta,
        Self::Time,
        Self::Acceleration,
        Self::Temperature,
        Self::Limits,
    ];

    /// Whether it stays as it is while the shaft rests.
    pub const fn rests(self) -> bool {
        matches!(self, Self::Omega | Self::OmegaSign | Self::Theta)
    }

    /// Its name in results.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Omega => "omega",
            Self::OmegaSign => "omega_sign",
            Self::Current => "i",
            Self::Theta => "theta",
            Self::Time => "time",
            Self::Acceleration => "acceleration",
            Self::Temperature => "temperature",
            Self::Limits => "limits",
        }
    }
}

/// Where a law stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ActsOn {
    /// In the balance of torques (forces) on the shaft.
    Torque,
    /// In the balance of voltages of the armature circuit.
    Voltage,
    /// Between the drive and what a sensor shows.
    Sensor,
}

impl ActsOn {
    /// Its name in results.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Torque => "torque",
            Self::Voltage => "voltage",
            Self::Sensor => "sensor",
        }
    }
}

/// What a person and the discovery need to know of an effect.
#[derive(Debug, Clone, Copy)]
pub struct Info {
    /// Identifier in files and commands.
    pub id: &'static str,
    /// The law in the symbols of the equations; where it can be typed, as a custom law is
    /// ([`super::custom`]), with its signs: `target = formula`, statements parted by semicolons.
    pub law: &'static str,
    /// The same for a person: what a model without the effect looks like.
    pub fingerprint: &'static str,
    /// The variables over which a model without the effect fails, most telling first.
    pub fails_over: &'static [Variable],
    /// Where the law stands.
    pub acts_on: &'static [ActsOn],
    /// What is equal to it by algebra, at least on some recordings: effects of the library and
    /// parameters of the motor.
    pub aliases: &'static [&'static str],
    /// Effects that cannot stand beside it in one drive; its own identifier if it is one of a
    /// kind.
    pub excludes: &'static [&'static str],
    /// Parameters and the values at which the effect vanishes; infinity for a stiffness.
    pub nulls: &'static [(&'static str, f64)],
    /// Parameters that count periods, which must close after a revolution or a whole number of them:
    /// on a rotary drive they are chosen from the grid and not estimated. Any position is meant, not
    /// that within one revolution: a grid of halves closes after two.
    pub counts: &'static [&'static str],
    /// The shapes at which a discovery weighs it, of parameters that have no finite null; at least
    /// one. Parameters without a value there are at their nominal ones.
    pub grid: fn(&Spans) -> Vec<Shape>,
    /// Why recordings that go so far cannot show it, for a person; nothing where they can.
    pub unseen: fn(&Spans) -> Option<String>,
    /// Whether a machine may have those values, in the order of the parameters, as far as recordings
    /// go.
    pub possible: fn(&[f64], &Spans) -> bool,
    /// Why no discovery weighs it, for a person.
    pub unweighed: Option<&'static str>,
    /// What the sensor shows that it distorts, where it stands at one: without that signal it is not
    /// seen.
    pub distorts: Option<Variable>,
    /// Whether it holds back what drives, and stands in no balance.
    pub delays: bool,
    /// Whether every machine has it: of a drive without it, it is the first that is asked for.
    pub basic: bool,
    /// Whether it raises the level of dry friction.
    pub dry: bool,
    /// Whether it replaces the jump of dry friction at rest by its own state.
    pub replaces_dry: bool,
    /// Whether it takes power from the moving shaft at every speed: friction and drag.
    pub dissipates: bool,
    /// Whether its own states are stiff and give a decay rate to the exponential stages.
    pub stiff: bool,
    /// Whether its law has a kink that steps cross without locating it, such as |i| at zero
    /// current: accurate to 1e-5 of a variable's range there, not to 1e-8.
    pub kinked: bool,
    /// Whether parts of it meet and part: when they do depends on all that moves the shaft, so that
    /// what its model leaves shows over every variable.
    pub knocks: bool,
    /// Whether it needs the armature circuit, which a force-driven drive does not have.
    pub electrical: bool,
    /// Whether it goes by the revolution, which a linear drive does not have.
    pub rotary: bool,
}

impl Info {
    /// The plain effect: no dry friction, no own stiff state, any drive.
    pub const fn new(id: &'static str, law: &'static str, fingerprint: &'static str) -> Self {
        Self {
            id,
            law,
            fingerprint,
            fails_over: &[],
            acts_on: &[ActsOn::Torque],
            aliases: &[],
            excludes: &[],
            nulls: &[],
            counts: &[],
            grid: nominal,
            unseen: |_| None,
            possible: |_, _| true,
            unweighed: None,
            distorts: None,
            delays: false,
            basic: false,
            dry: false,
            replaces_dry: false,
            dissipates: false,
            stiff: false,
            kinked: false,
            knocks: false,
            electrical: false,
            rotary: false,
        }
    }

    /// Whether the law gives the same as long as the shaft rests: it follows speed and position alone.
    pub fn is_steady_at_rest(&self) -> bool {
        self.fails_over.iter().all(|over| over.rests())
    }

    /// Whether it distorts what a sensor shows.
    pub const fn senses(&self) -> bool {
        let mut k = 0;
        while k < self.acts_on.len() {
            if matches!(self.acts_on[k], ActsOn::Sensor) {
                return true;
            }
            k += 1;
        }
        false
    }
}
