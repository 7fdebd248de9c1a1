//! What is known of a number of a drive, and how a section of the drive file declares its numbers.

use crate::drive::{Drive, Motion};
use crate::parameters::Role;
use crate::units::name_for_motion;

/// Any finite number.
pub(crate) const ANY: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);
/// Above zero.
pub(super) const POSITIVE: (f64, f64) = (f64::MIN_POSITIVE, f64::INFINITY);
/// Zero or more.
pub(super) const NOT_NEGATIVE: (f64, f64) = (0.0, f64::INFINITY);

/// A number of the drive: where it stands in the file, what it may be, where it lies in memory.
pub(crate) struct Field {
    /// Table of the drive file.
    pub(crate) section: &'static str,
    /// Key in that table, for a rotary drive.
    pub(crate) key: &'static str,
    /// Unit for a rotary drive.
    pub(crate) unit: &'static str,
    /// Least and greatest value that is possible.
    pub(crate) range: (f64, f64),
    /// Typical magnitude.
    pub(crate) nominal: f64,
    /// What it is for.
    pub(crate) role: Role,
    /// One line for a person.
    pub(crate) description: &'static str,
    /// Its value, if the drive has it.
    pub(crate) get: fn(&Drive) -> Option<f64>,
    /// Its place, if the drive has it.
    pub(crate) slot: fn(&mut Drive) -> Option<&mut f64>,
}

impl Field {
    /// The key for that motion: the noise of the speed is `omega` or `v`.
    pub(crate) fn key(&self, motion: Motion) -> &'static str {
        // Elsewhere the same letters mean other things.
        if self.section == "noise" { name_for_motion(motion, self.key) } else { self.key }
    }

    /// The name outside the file: the motor's symbols stand alone.
    pub(crate) fn name(&self, motion: Motion) -> String {
        let key = self.key(motion);
        if self.section == "motor" { key.to_owned() } else { format!("{}.{key}", self.section) }
    }
}

/// A number that a section has, or may have.
pub(super) trait Number {
    fn get(&self) -> Option<f64>;
    fn slot(&mut self) -> Option<&mut f64>;
}

impl Number for f64 {
    fn get(&self) -> Option<f64> {
        Some(*self)
    }

    fn slot(&mut self) -> Option<&mut f64> {
        Some(self)
    }
}

impl Number for Option<f64> {
    fn get(&self) -> Option<f64> {
        *self
    }

    fn slot(&mut self) -> Option<&mut f64> {
        self.as_mut()
    }
}

/// Declares a section of the drive file: the struct that holds it, which serde reads and writes under
/// the file's keys, and the [`Field`] of each of its numbers. What is no number stands in braces.
macro_rules! section {
    (
        $(#[$about:meta])*
        $name:ident = $section:ident, $of:expr, $of_mut:expr;
        $({ $($plain:tt)* } $(
            $(#[$more:meta])* $field:ident: $kind:ty = $key:literal [$unit:literal] $range:ident,
            $nominal:literal, $role:ident, $description:literal;
        )*)+
    ) => {
        $(#[$about])*
        #[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
        #[serde(deny_unknown_fields, expecting = "a table")]
        pub struct $name {
            $($($plain)* $(
                #[doc = concat!($description, ", ", $unit)]
                #[serde(rename = $key)]
                $(#[$more])*
                pub $field: $kind,
            )*)+
        }

        impl $name {
            /// What is known of its numbers, in the order in which they are shown.
            pub(super) const FIELDS: &[Field] = &[$($(Field {
                section: stringify!($section),
                key: $key,
                unit: $unit,
                range: $range,
                nominal: $nominal,
                role: Role::$role,
                description: $description,
                get: |drive| {
                    let of: fn(&Drive) -> Option<&$name> = $of;
                    of(drive)?.$field.get()
                },
                slot: |drive| {
                    let of: fn(&mut Drive) -> Option<&mut $name> = $of_mut;
                    of(drive)?.$field.slot()
                },
            },)*)+];
        }
    };
}

pub(super) use section;
