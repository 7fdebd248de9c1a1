//! The parameters of the motor's two balances (20)-(23).

use drivescope_numerics::Real;

use crate::lanes::lanes;

lanes! {
    /// Parameters of a motor; SI units (linear motion: kg, N, m in place of kg m^2, N m, rad).
    Motor / Motors {
        /// Armature resistance R, ohm.
        r,
        /// Armature inductance L, H.
        l,
        /// Voltage constant K_e, V s/rad.
        k_e,
        /// Torque constant K_m, N m/A (force-driven: N m or N a unit of u).
        k_m,
        /// Moment of inertia J, kg m^2.
        j,
        /// Viscous friction B_m, N m s/rad.
        b_m,
        /// Factor on viscous and dry friction: 1 unless a friction fault acts.
        friction,
    }
}

/// Inverses of J and L: a division costs a lane as much as a law.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(64))]
pub(crate) struct Inverses<R, const N: usize> {
    /// 1 / J.
    pub(crate) j: [R; N],
    /// 1 / L.
    pub(crate) l: [R; N],
}

impl<R: Real, const N: usize> Motors<R, N> {
    #[inline(always)]
    pub(crate) fn inverses(&self) -> Inverses<R, N> {
        let mut inverses = Inverses { j: self.j, l: self.l };
        for l in 0..N {
            inverses.j[l] = R::one() / self.j[l];
            inverses.l[l] = R::one() / self.l[l];
        }
        inverses
    }
}

impl<R: Real> Motor<R> {
    /// Fastest rate of the balances besides R / L, 1/s: electromechanical oscillation, drag.
    pub(crate) fn fastest(&self, force: bool) -> f64 {
        let drag = (self.b_m * self.friction / self.j).value().abs();
        if force {
            return drag;
        }
        let coupling = (self.k_m * self.k_e / self.j).value().abs();
        let oscillation = (coupling / self.l.value()).sqrt();
        // Of an over-damped pair the slow one counts: the armature's own decay is exact.
        let half = 0.5 * (self.r / self.l).value();
        let slow =
            oscillation * oscillation / (half + (half * half - oscillation * oscillation).sqrt());
        drag.max(if half > oscillation { slow } else { oscillation })
    }
}
