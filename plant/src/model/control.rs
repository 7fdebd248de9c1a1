//! Continuous PI speed control, a part of the continuous drive with a state of its own.
//!
//! C_m = sat(K_p e + xi),  dxi/dt = K_i e + (C_m - K_p e - xi) K_i / K_p,  e = command - T,
//! u = sat(gain C_m). The last term of the integrator is back-calculation (Astrom and Rundqwist,
//! 1989): it is continuous where the signal saturates, and zero elsewhere. Without K_p the
//! integrator stops at the limit instead.

use drivescope_numerics::Real;

use crate::lanes::lanes;

lanes! {
    /// Continuous PI control and its amplifier; SI units, infinite limits for none.
    Control / Controls {
        /// Proportional gain K_p, V s/rad.
        k_p,
        /// Integral gain K_i, V/rad.
        k_i,
        /// Greatest magnitude of C_m, V.
        limit,
        /// Gain of the amplifier, faults included, V/V.
        gain,
        /// Greatest magnitude of u, V.
        u_limit,
        /// Gain of the tachometer, faults included.
        tacho,
    }
}

/// The signals of a continuous controller at an instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Controlled<R> {
    /// Control signal C_m, V.
    pub c_m: R,
    /// Amplifier output, V.
    pub u: R,
    /// Rate of the integrator, V/s.
    pub integral_rate: R,
}

#[inline(always)]
fn saturated<R: Real>(x: R, limit: R) -> R {
    let capped = R::select(x.value() > limit.value(), limit, x);
    R::select(capped.value() < -limit.value(), -limit, capped)
}

impl<R: Real> Control<R> {
    /// The signals for a command (reference less what disturbs the tachometer), the speed that
    /// an ideal sensor shows, and the integrator's state.
    #[inline(always)]
    pub(super) fn signals(&self, command: R, speed: R, integral: R) -> Controlled<R> {
        let error = command - self.tacho * speed;
        let wanted = self.k_p * error + integral;
        let c_m = saturated(wanted, self.limit);
        let excess = c_m - wanted;
        let proportional = self.k_p.value() > 0.0;
        let k_p = R::select(proportional, self.k_p, R::one());
        let tracking = (self.k_i / k_p) * excess;
        let winds_up = excess.value() * error.value() < 0.0;
        let stopped = R::select(winds_up, -(self.k_i * error), R::zero());
        let correction = R::select(proportional, tracking, stopped);
        Controlled {
            c_m,
            u: saturated(self.gain * c_m, self.u_limit),
            integral_rate: self.k_i * error + correction,
        }
    }

    /// Fastest rate that the loop adds, 1/s: its oscillation with the motor, or its reset.
    pub(super) fn fastest(&self, force: bool, k_m_over_j: f64, l: f64, r: f64) -> f64 {
        let [k_p, k_i] = [self.k_p, self.k_i].map(|k| (self.gain * k).value().abs() * k_m_over_j);
        let reset = if self.k_p.value() > 0.0 { (self.k_i / self.k_p).value() } else { 0.0 };
        let loop_rate = if force {
            k_p.max(k_i.sqrt())
        } else {
            (k_p / l).sqrt().min(k_p / r).max((k_i / r).sqrt())
        };
        loop_rate.max(reset)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PI: Control<f64> =
        Control { k_p: 0.5, k_i: 3.0, limit: 1.0, gain: 2.0, u_limit: 1.5, tacho: 1.0 };

    #[test]
    fn within_its_limits_it_is_a_plain_pi() {
        let now = PI.signals(1.2, 1.0, 0.3);
        assert!((now.c_m - 0.4).abs() < 1e-15 && (now.u - 0.8).abs() < 1e-15);
        assert!((now.integral_rate - 0.6).abs() < 1e-15);
    }

    #[test]
    fn at_the_limit_the_integrator_turns_back() {
        let now = PI.signals(10.0, 0.0, 0.0);
        assert_eq!((now.c_m, now.u), (1.0, 1.5));
        assert!((now.integral_rate - (30.0 - 4.0 * 6.0)).abs() < 1e-12);
        // In equilibrium the integrator holds sat - K_p e + e K_p = no wind-up.
        assert!(PI.signals(10.0, 0.0, 2.0).integral_rate < 0.0);
        let integral_only = Control { k_p: 0.0, ..PI };
        assert_eq!(integral_only.signals(1.0, 0.0, 2.0).integral_rate, 0.0);
        assert_eq!(integral_only.signals(-1.0, 0.0, 2.0).integral_rate, -3.0);
    }
}
