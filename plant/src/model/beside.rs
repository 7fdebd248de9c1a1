//! What sensors beside those of the motor show: on the load side, and in the winding.

use drivescope_numerics::Real;

use super::{Model, OWN, POSITION, Part, SPEED};
use crate::effects::info::Beside;
use crate::effects::registry::REGISTRY;

/// The state that each of [`Beside::ALL`] tells of, where an effect has it.
pub(super) fn states<R>(parts: &[Part<R>]) -> [Option<usize>; Beside::ALL.len()] {
    let own = parts.iter().flat_map(|part| {
        let entry = REGISTRY.iter().find(|entry| entry.kind == part.kind);
        entry.map_or(&[][..], |entry| entry.states)
    });
    let own: Vec<Option<Beside>> = own.map(|state| state.beside).collect();
    Beside::ALL.map(|sensor| own.iter().position(|it| *it == Some(sensor)).map(|k| OWN + k))
}

impl<R: Real, const N: usize> Model<R, N> {
    /// Whether an effect of the drive has the state that such a sensor tells of.
    pub fn has(&self, sensor: Beside) -> bool {
        self.told_by(sensor).is_some()
    }

    /// Index of the state that such a sensor tells of, if an effect of the drive has it.
    pub fn told_by(&self, sensor: Beside) -> Option<usize> {
        self.beside[sensor as usize]
    }

    /// What such a sensor shows of lane `l`: rad/s, rad (m/s, m) or K above the surroundings. The
    /// load of a rigid drive moves as its motor does; nothing where no effect tells the
    /// temperature.
    pub fn beside(&self, sensor: Beside, x: &[[R; N]], l: usize) -> Option<R> {
        let state = self.beside[sensor as usize].map(|k| x[k][l]);
        let of_motor = match sensor {
            Beside::LoadSpeed => x[SPEED][l],
            Beside::LoadPosition => x[POSITION][l],
            Beside::Temperature => return state,
        };
        Some(state.map_or(of_motor, |behind| of_motor - behind))
    }
}

#[cfg(test)]
mod tests {
    use crate::effects::info::Beside;
    use crate::model::OWN;
    use crate::testing::{DR300, drive};

    fn shown(effects: &str, x: &[f64]) -> [Option<f64>; 3] {
        let model = drive(&format!("{DR300}\n{effects}")).model();
        assert_eq!(model.states(), x.len());
        let x: Vec<[f64; 1]> = x.iter().map(|value| [*value]).collect();
        Beside::ALL.map(|sensor| model.beside(sensor, &x, 0))
    }

    #[test]
    fn the_load_lags_by_twist_and_slip_and_the_winding_is_warm() {
        assert_eq!(shown("", &[1.0, 7.0, 0.4]), [Some(7.0), Some(0.4), None]);
        assert_eq!(OWN, 3);
        let coupling = "[[effect]]\nkind = \"flexible_coupling\"\nk = 5.0\nd = 1e-3\nratio = 0.5\n";
        let heating =
            "[[effect]]\nkind = \"winding_heating\"\nalpha = 0.004\nR_th = 5.0\nC_th = 9.0\n";
        let coupled = shown(&format!("{heating}{coupling}"), &[1.0, 7.0, 0.5, 30.0, 0.25, 2.0]);
        assert_eq!(coupled, [Some(5.0), Some(0.25), Some(30.0)]);
        let backlash =
            "[[effect]]\nkind = \"backlash\"\nk = 5.0\nd = 1e-3\ngap = 0.02\nratio = 0.5\n";
        let played = shown(backlash, &[1.0, 7.0, 0.5, 0.25, 2.0]);
        assert_eq!(played, [Some(5.0), Some(0.25), None]);
    }
}
