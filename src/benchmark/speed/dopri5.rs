//! The drive as a user of `ode_solvers` would run it: equations (20) to (23) with Coulomb and Stribeck
//! friction, integrated anew over every sample with what acts held.

use drivescope_plant::drive::Drive;
use nalgebra::Vector3;
use ode_solvers::dop_shared::OutputType;
use ode_solvers::{Dop853, Dopri5, System};

use super::Held;

/// Tolerance of the peer.
const USUAL: f64 = 1e-6;
/// Tolerance of the reference that errors are taken from.
const FINE: f64 = 1e-12;

/// Current, speed, position.
type Y = Vector3<f64>;

/// Parameters, SI units.
#[derive(Debug, Clone, Copy)]
struct Rotor {
    r: f64,
    l: f64,
    k_e: f64,
    k_m: f64,
    j: f64,
    b_m: f64,
    t_c: f64,
    t_b: f64,
    omega_s: f64,
    u: f64,
    load: f64,
}

impl System<f64, Y> for Rotor {
    fn system(&self, _: f64, y: &Y, dy: &mut Y) {
        let (i, omega) = (y[0], y[1]);
        let dry = self.t_c + self.t_b * (-(omega / self.omega_s).powi(2)).exp();
        let torque = self.k_m * i - self.b_m * omega - dry * omega.signum() - self.load;
        *dy = Y::new((self.u - self.r * i - self.k_e * omega) / self.l, torque / self.j, omega);
    }
}

/// Runs over held inputs.
#[derive(Debug, Clone)]
pub(super) struct Peer(Rotor);

impl Peer {
    /// That drive, whose friction is Coulomb's and Stribeck's.
    pub(super) fn new(drive: &Drive) -> Self {
        let all = drive.parameters();
        let of = |name: &str| all.iter().find(|it| it.name == name).map_or(0.0, |it| it.value);
        Self(Rotor {
            r: of("R"),
            l: of("L"),
            k_e: of("K_e"),
            k_m: of("K_m"),
            j: of("J"),
            b_m: of("B_m"),
            t_c: of("coulomb.T_c"),
            t_b: of("stribeck.T_b"),
            omega_s: of("stribeck.omega_s"),
            u: 0.0,
            load: 0.0,
        })
    }

    fn samples(&self, held: &Held, mut step: impl FnMut(Rotor, Y) -> Y) -> Vec<[f64; 2]> {
        let mut y = Y::new(held.start[0], held.start[1], 0.0);
        let mut made = Vec::with_capacity(held.inputs.len());
        for [u, load] in &held.inputs {
            y = step(Rotor { u: *u, load: *load, ..self.0 }, y);
            made.push([y[0], y[1]]);
        }
        made
    }

    /// Current and speed after every sample by Dopri5 at 1e-6.
    pub(super) fn run(&self, held: &Held) -> Vec<[f64; 2]> {
        self.samples(held, |rotor, y| {
            let span = held.period_s;
            let mut solver = Dopri5::new(rotor, 0.0, span, span, y, USUAL, USUAL);
            // The dense output of these solvers is wrong where its step is the whole interval.
            solver.set_output(OutputType::Sparse);
            let done = solver.integrate();
            done.ok().and_then(|_| solver.y_out().last().copied()).unwrap_or(y)
        })
    }

    /// The same by Dop853 at 1e-12.
    pub(super) fn reference(&self, held: &Held) -> Vec<[f64; 2]> {
        self.samples(held, |rotor, y| {
            let span = held.period_s;
            let mut solver = Dop853::new(rotor, 0.0, span, span, y, FINE, FINE);
            solver.set_output(OutputType::Sparse);
            let done = solver.integrate();
            done.ok().and_then(|_| solver.y_out().last().copied()).unwrap_or(y)
        })
    }
}
