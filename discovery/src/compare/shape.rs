//! What a law that the model lacks may look like: a few columns each, over one variable.
//!
//! Each shape is a small basis of a torque, a voltage, a flux or a sensor's error over its
//! variable; what the base can express itself drops out when the columns are made orthogonal to
//! the base's. Where laws of different variables would explain the same, the shapes are kept
//! apart: over the speed a torque is odd (friction of any form), over its sign even (a direction
//! that differs). A torque that merely varies in time is no shape: a random load is one.

use drivescope_plant::effects::info::{ActsOn, Variable};

/// Share of the usual top speed at which a torque over the speed has its knots: dense near zero.
pub(super) const SPEED_KNOTS: [f64; 7] = [0.0, 0.015, 0.045, 0.12, 0.3, 0.6, 1.0];
/// The same of a flux over the speed; its value at rest belongs to the base.
pub(super) const FLUX_SPEED_KNOTS: [f64; 4] = [0.0, 0.2, 0.5, 1.0];
/// Share of the usual top current.
pub(super) const CURRENT_KNOTS: [f64; 6] = [0.0, 0.04, 0.12, 0.3, 0.6, 1.0];
/// Knots over the time of a recording: something that touches the shaft for an eighth of it shows.
pub(super) const TIME_KNOTS: usize = 9;
/// Shares of the usual top speed over which friction near rest falls.
pub(super) const REST_SHARES: [f64; 2] = [0.02, 0.06];
/// Frequencies of a bank of oscillators that the acceleration excites, Hz: elastic and loose
/// couplings below them and between them are combinations.
pub(super) const RESONANCES_HZ: [f64; 5] = [6.0, 11.0, 18.0, 28.0, 45.0];
/// Ways after which bristles have bent, in seconds at the usual top speed.
pub(super) const BENT_S: [f64; 3] = [2e-4, 1e-3, 4e-3];
/// Time constants of a winding, s.
pub(super) const HEAT_S: [f64; 2] = [4.0, 30.0];

/// A possible form of what is missing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Shape {
    /// Friction of any form over the speed.
    TorqueOverSpeed,
    /// Drag that grows with the square and the cube of the speed: what few columns tell shows
    /// under a random load where a free form does not.
    DragOverSpeed,
    /// Friction that is higher near rest.
    FrictionNearRest,
    /// A torque that dies away with the way since the motion began or turned.
    TorqueAfterReversal,
    /// A flux that depends on the speed.
    FluxOverSpeed,
    /// A torque that does not turn with the direction, constant or growing with the speed.
    TorqueByDirection,
    /// A voltage lost over the current.
    VoltageOverCurrent,
    /// A flux that depends on the current.
    FluxOverCurrent,
    /// Friction that grows with the current.
    FrictionOverCurrent,
    /// A current sensor that is off.
    CurrentOffset,
    /// A torque with that many periods a radian (per m) times 2 pi.
    TorqueOverAngle(f64),
    /// A flux with that wave number.
    FluxOverAngle(f64),
    /// Friction with that wave number.
    FrictionOverAngle(f64),
    /// A speed sensor whose gain has that wave number.
    SpeedShownOverAngle(f64),
    /// Friction that changes in time, in that recording.
    FrictionOverTime(usize),
    /// Friction that drifts slowly, in that recording.
    FrictionDrift(usize),
    /// A resistance that follows the losses.
    ResistanceOverHeat,
    /// Something on the shaft that swings, or is loose.
    Resonances,
    /// An input that comes late.
    LateInput,
    SpeedShownLate,
    /// A voltage that is not reached at the limit.
    AtLimit,
}

impl Shape {
    /// The variable over which it is one.
    pub(super) fn variable(self) -> Variable {
        match self {
            Self::TorqueOverSpeed
            | Self::DragOverSpeed
            | Self::FrictionNearRest
            | Self::TorqueAfterReversal
            | Self::FluxOverSpeed => Variable::Omega,
            Self::TorqueByDirection => Variable::OmegaSign,
            Self::VoltageOverCurrent
            | Self::FluxOverCurrent
            | Self::FrictionOverCurrent
            | Self::CurrentOffset => Variable::Current,
            Self::TorqueOverAngle(_)
            | Self::FluxOverAngle(_)
            | Self::FrictionOverAngle(_)
            | Self::SpeedShownOverAngle(_) => Variable::Theta,
            Self::FrictionOverTime(_) | Self::FrictionDrift(_) => Variable::Time,
            Self::ResistanceOverHeat => Variable::Temperature,
            Self::Resonances | Self::LateInput | Self::SpeedShownLate => Variable::Acceleration,
            Self::AtLimit => Variable::Limits,
        }
    }

    /// Where it acts; a flux acts in both balances, and counts as the torque's.
    pub(super) fn acts_on(self) -> ActsOn {
        match self {
            Self::VoltageOverCurrent
            | Self::ResistanceOverHeat
            | Self::LateInput
            | Self::AtLimit => ActsOn::Voltage,
            Self::CurrentOffset | Self::SpeedShownOverAngle(_) | Self::SpeedShownLate => {
                ActsOn::Sensor
            }
            _ => ActsOn::Torque,
        }
    }

    /// Columns of its basis.
    pub(super) fn columns(self) -> usize {
        match self {
            Self::TorqueOverSpeed => SPEED_KNOTS.len(),
            Self::TorqueAfterReversal => BENT_S.len(),
            Self::FluxOverSpeed => FLUX_SPEED_KNOTS.len() - 1,
            Self::VoltageOverCurrent | Self::FluxOverCurrent => CURRENT_KNOTS.len(),
            Self::FrictionOverTime(_) => TIME_KNOTS,
            Self::ResistanceOverHeat => HEAT_S.len(),
            Self::Resonances => 2 * RESONANCES_HZ.len(),
            Self::CurrentOffset | Self::LateInput | Self::AtLimit => 1,
            _ => 2,
        }
    }

    /// Wave number, rad/rad (rad/m), of a shape over the angle.
    pub(super) fn wave_number(self) -> Option<f64> {
        match self {
            Self::TorqueOverAngle(wave)
            | Self::FluxOverAngle(wave)
            | Self::FrictionOverAngle(wave)
            | Self::SpeedShownOverAngle(wave) => Some(wave),
            _ => None,
        }
    }

    /// What it says, in words.
    pub(super) fn words(self) -> &'static str {
        match self {
            Self::TorqueOverSpeed => "friction depends on the speed in another way",
            Self::DragOverSpeed => "the drag grows with the speed in another way",
            Self::FrictionNearRest => "friction near rest is another than at speed",
            Self::TorqueAfterReversal => "friction builds up only after the motion begins or turns",
            Self::FluxOverSpeed => "the torque constant depends on the speed",
            Self::TorqueByDirection => "the torque differs by direction",
            Self::VoltageOverCurrent => "voltage is lost over the current in another way",
            Self::FluxOverCurrent => "the torque constant depends on the current",
            Self::FrictionOverCurrent => "friction grows with the current",
            Self::CurrentOffset => "the current shown is off by a constant",
            Self::TorqueOverAngle(_) => "a torque repeats with the angle",
            Self::FluxOverAngle(_) => "the torque constant ripples with the angle",
            Self::FrictionOverAngle(_) => "friction repeats with the angle",
            Self::SpeedShownOverAngle(_) => "the speed shown ripples with the angle",
            Self::FrictionOverTime(_) => "friction changes in time",
            Self::FrictionDrift(_) => "friction drifts in time",
            Self::ResistanceOverHeat => "the resistance follows the losses",
            Self::Resonances => "something behind the shaft swings or is loose",
            Self::LateInput => "the input acts late",
            Self::SpeedShownLate => "the speed is shown late",
            Self::AtLimit => "the voltage is not reached at its limit",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_variable_of_the_contract_has_a_shape() {
        let shapes = [
            Shape::TorqueOverSpeed,
            Shape::TorqueByDirection,
            Shape::VoltageOverCurrent,
            Shape::TorqueOverAngle(1.0),
            Shape::FrictionOverTime(0),
            Shape::ResistanceOverHeat,
            Shape::Resonances,
            Shape::AtLimit,
        ];
        for variable in Variable::ALL {
            assert!(shapes.iter().any(|it| it.variable() == variable), "{variable:?}");
        }
    }
}
