//! Random machines.

use drivescope_plant::drive::Drive;
use rand::RngExt as _;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

/// A machine: volts, amps, R, L, K, J, B, T_c.
const MACHINES: [[f64; 8]; 3] = [
    [24.0, 2.0, 3.13, 5e-3, 0.06, 8.2e-5, 6e-5, 0.016],
    [12.0, 1.4, 2.2, 2.5e-3, 0.022, 1.1e-5, 3e-6, 2.8e-3],
    [48.0, 5.0, 0.9, 2.5e-3, 0.115, 4e-4, 2e-4, 0.032],
];
/// Standard deviation of the logarithm of a machine's parameter.
const SPREAD: f64 = 0.2;

/// The parameters of a machine, SI.
pub(super) struct Machine {
    pub(super) volts: f64,
    pub(super) amps: f64,
    pub(super) r: f64,
    l: f64,
    k: f64,
    j: f64,
    b: f64,
    pub(super) t_c: f64,
}

impl Machine {
    pub(super) fn draw(random: &mut Pcg64) -> Self {
        let middle = MACHINES[random.random_range(0..MACHINES.len())];
        let mut spread = || {
            let draw: f64 = StandardNormal.sample(random);
            (SPREAD * draw.clamp(-2.0, 2.0)).exp()
        };
        let [volts, amps, r, l, k, j, b, t_c] = middle;
        let [r, l, k] = [r * spread(), l * spread(), k * spread()];
        Self { volts, amps, r, l, k, j: j * spread(), b: b * spread(), t_c: t_c * spread() }
    }

    /// Torque at the greatest current, N m.
    pub(super) fn torque(&self) -> f64 {
        self.k * self.amps
    }

    /// Speed without load at the supply voltage, rad/s.
    pub(super) fn top(&self) -> f64 {
        self.volts / self.k
    }

    /// Its drive file, every parameter times a factor.
    pub(super) fn drive(&self, mut off: impl FnMut() -> f64) -> Drive {
        let k = self.k * off();
        let text = format!(
            "schema = 1\nname = \"random machine\"\nmotion = \"rotary\"\n[motor]\ninput = \
             \"voltage\"\nR = {:?}\nL = {:?}\nK_e = {k:?}\nK_m = {k:?}\nJ = {:?}\nB_m = \
             {:?}\ntie_K = true\n[[effect]]\nkind = \"coulomb\"\nT_c = {:?}\n",
            self.r * off(),
            self.l * off(),
            self.j * off(),
            self.b * off(),
            self.t_c * off()
        );
        Drive::parse(&text, "random machine").expect("the text is a drive file")
    }
}
