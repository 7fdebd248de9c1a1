//! Fault mechanisms: each is one input of the drive, 0 when healthy.
//!
//! A mechanism says where a size enters; when it does and how it grows is a scenario's matter
//! (a drift is a ramp of a bias).

use crate::lanes::lanes;
use crate::model::Motor;

macro_rules! mechanisms {
    ($($field:ident, $unit:literal, $description:literal;)+) => {
        lanes! {
            /// Sizes of all faults that act, 0 when healthy.
            Faults / FaultLanes { $(#[doc = $description] $field),+ }
        }

        /// Every mechanism, in the order of the fields of [`Faults`].
        pub const MECHANISMS: &[Mechanism] =
            &[$(Mechanism { id: stringify!($field), unit: $unit, description: $description }),+];

        impl Faults<f64> {
            /// No fault.
            pub const NONE: Self = Self { $($field: 0.0),+ };

            /// The size of the mechanism of that number in [`MECHANISMS`].
            pub fn size_mut(&mut self, mechanism: usize) -> Option<&mut f64> {
                [$(&mut self.$field),+].into_iter().nth(mechanism)
            }
        }
    };
}

/// What a sensor shows of a value with a fault of its gain and a bias.
#[inline(always)]
pub fn sensed(value: f64, gain: f64, bias: f64) -> f64 {
    value * (1.0 + gain) + bias
}

/// A way in which a drive can fail.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Mechanism {
    /// Identifier; the FMU's input is `fault_<id>`.
    pub id: &'static str,
    /// Unit of the size for a rotary drive; `1` for a fraction.
    pub unit: &'static str,
    /// What the size does.
    pub description: &'static str,
}

impl Mechanism {
    /// The number of the mechanism of that identifier.
    pub fn find(id: &str) -> Option<usize> {
        MECHANISMS.iter().position(|mechanism| mechanism.id == id)
    }
}

mechanisms! {
    tacho, "1", "tachometer gain: T (1 + size)";
    flux, "1", "excitation flux: K_m and K_e (1 + size)";
    torque_constant, "1", "motor torque: K_m (1 + size)";
    actuator, "1", "amplifier gain: u (1 + size) before its limit";
    load, "1", "additional load torque: size x rated torque";
    resistance, "1", "armature resistance: R (1 + size)";
    friction, "1", "viscous and dry friction (1 + size)";
    inertia, "1", "moment of inertia: J (1 + size)";
    supply, "1", "supply voltage: amplifier gain and limit (1 + size)";
    current_sensor, "1", "current sensor gain: I_m (1 + size)";
    tacho_bias, "rad/s", "tachometer bias, added to the speed";
    current_bias, "A", "current sensor bias";
    tacho_noise, "1", "tachometer noise (1 + size)";
    current_noise, "1", "current sensor noise (1 + size)";
    tacho_freeze, "1", "tachometer holds its last value while size > 0.5";
    current_freeze, "1", "current sensor holds its last value while size > 0.5";
}

impl Faults<f64> {
    /// The motor with the faults that sit in it.
    pub fn in_motor(&self, healthy: &Motor<f64>) -> Motor<f64> {
        Motor {
            r: healthy.r * (1.0 + self.resistance),
            l: healthy.l,
            k_e: healthy.k_e * (1.0 + self.flux),
            k_m: healthy.k_m * (1.0 + self.flux) * (1.0 + self.torque_constant),
            j: healthy.j * (1.0 + self.inertia),
            b_m: healthy.b_m,
            friction: healthy.friction * (1.0 + self.friction),
        }
    }

    /// The sizes that change the motor.
    pub(crate) fn of_motor(&self) -> [f64; 5] {
        [self.flux, self.torque_constant, self.resistance, self.friction, self.inertia]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_identifiers_and_fields_agree() {
        let number = Mechanism::find("load").expect("it is listed");
        let mut faults = Faults::NONE;
        *faults.size_mut(number).expect("it exists") = 0.25;
        assert_eq!(faults, Faults { load: 0.25, ..Faults::NONE });
        assert!(faults.size_mut(MECHANISMS.len()).is_none());
        assert!(Mechanism::find("nothing").is_none());
    }

    #[test]
    fn a_flux_fault_acts_in_both_balances() {
        let healthy = Motor { r: 1.0, l: 1.0, k_e: 2.0, k_m: 3.0, j: 1.0, b_m: 1.0, friction: 1.0 };
        let motor = Faults { flux: 0.1, ..Faults::NONE }.in_motor(&healthy);
        assert!((motor.k_e - 2.2).abs() < 1e-15 && (motor.k_m - 3.3).abs() < 1e-15);
        let motor = Faults { torque_constant: 0.1, ..Faults::NONE }.in_motor(&healthy);
        assert!(motor.k_e == 2.0 && (motor.k_m - 3.3).abs() < 1e-15);
    }
}
