//! What a unit measures.

use serde::Serialize;

use crate::powers::{A, K, KG, M, Powers, RAD, S, powers};

/// What a unit measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Duration; SI unit s.
    Time,
    /// Electric tension; SI unit V.
    Voltage,
    /// Electric current; SI unit A.
    Current,
    /// Speed of rotation; SI unit rad/s.
    AngularSpeed,
    /// Speed of translation; SI unit m/s.
    Speed,
    /// Angle; SI unit rad.
    Angle,
    /// Position; SI unit m.
    Length,
    /// Torque; SI unit N m.
    Torque,
    /// Force; SI unit N.
    Force,
    /// Absolute temperature; SI unit K.
    Temperature,
    /// A number without a unit, written `1`.
    Dimensionless,
}

impl Quantity {
    /// The SI unit as it is written in a column header.
    pub fn si(self) -> &'static str {
        match self {
            Quantity::Time => "s",
            Quantity::Voltage => "V",
            Quantity::Current => "A",
            Quantity::AngularSpeed => "rad/s",
            Quantity::Speed => "m/s",
            Quantity::Angle => "rad",
            Quantity::Length => "m",
            Quantity::Torque => "N m",
            Quantity::Force => "N",
            Quantity::Temperature => "K",
            Quantity::Dimensionless => "1",
        }
    }

    /// Powers of the SI base units, as of [`BaseUnit::powers`](crate::BaseUnit::powers).
    pub(crate) fn powers(self) -> Powers {
        match self {
            Quantity::Time => powers(&[(S, 1)]),
            Quantity::Voltage => powers(&[(KG, 1), (M, 2), (S, -3), (A, -1)]),
            Quantity::Current => powers(&[(A, 1)]),
            Quantity::AngularSpeed => powers(&[(RAD, 1), (S, -1)]),
            Quantity::Speed => powers(&[(M, 1), (S, -1)]),
            Quantity::Angle => powers(&[(RAD, 1)]),
            Quantity::Length => powers(&[(M, 1)]),
            Quantity::Torque => powers(&[(KG, 1), (M, 2), (S, -2)]),
            Quantity::Force => powers(&[(KG, 1), (M, 1), (S, -2)]),
            Quantity::Temperature => powers(&[(K, 1)]),
            Quantity::Dimensionless => powers(&[]),
        }
    }
}
