//! Speed-sensor lag: a filter of the first order in the tachometer or its amplifier,
//! tau domega_f/dt = omega - omega_f.
//!
//! Written in the filtered acceleration a_f, so that it starts in steady state at any speed and
//! vanishes with tau: omega_f = omega - tau a_f, tau da_f/dt = domega/dt - a_f.

use drivescope_numerics::Real;

use super::law::{ActsOn, Effect, Info, Outputs, OwnState, Parameter, Sum, Variable, View};

/// The filter is never faster than this, s: a thousandth of a usual sample; it keeps the
/// quotient finite where tau vanishes, whose derivative is that of a lag all the same.
const LEAST_LAG: f64 = 1e-6;

/// No sensor of a controlled drive is slower, s: what lags more is something else.
const MOST_LAG: f64 = 0.5;

/// Shown speed that lags by tau, one stiff own state.
pub struct SpeedSensorLag;

impl SpeedSensorLag {
    #[inline(always)]
    fn rate_of<R: Real>(tau: R) -> R {
        let least = R::constant(LEAST_LAG);
        R::one() / R::select(tau.value() > LEAST_LAG, tau, least)
    }
}

impl Effect<1, 1> for SpeedSensorLag {
    const INFO: Info = Info {
        stiff: true,
        fails_over: &[Variable::Acceleration],
        acts_on: &[ActsOn::Sensor],
        distorts: Some(Variable::Omega),
        aliases: &["delay"],
        excludes: &["speed_sensor_lag"],
        nulls: &[("tau", 0.0)],
        possible: |values, _| values[0] <= MOST_LAG,
        ..Info::new(
            "speed_sensor_lag",
            "tau domega_f/dt = omega - omega_f; shown: omega_f",
            "acceleration, in proportion; not in i",
        )
    };
    const PARAMETERS: [Parameter; 1] = [Parameter {
        name: "tau",
        unit: "s",
        nominal: 0.005,
        range: (0.0, f64::INFINITY),
        description: "time constant of the speed sensor",
    }];
    const STATES: [OwnState; 1] = [OwnState {
        name: "a_f",
        unit: "rad/s^2",
        nominal: 100.0,
        description: "filtered acceleration: what is shown is tau times that too little",
        beside: None,
    }];

    #[inline(always)]
    fn rate<R: Real>([tau]: [R; 1], [a_f]: [R; 1], _: &View<R>, sum: &Sum<R>) -> [R; 1] {
        [(sum.acceleration - a_f) * Self::rate_of(tau)]
    }

    #[inline(always)]
    fn decay<R: Real>([tau]: [R; 1], _: [R; 1], _: &View<R>, _: &Sum<R>) -> [R; 1] {
        [Self::rate_of(tau)]
    }

    #[inline(always)]
    fn sense<R: Real>([tau]: [R; 1], [a_f]: [R; 1], _: &View<R>, y: &mut Outputs<R>) {
        y.omega -= tau * a_f;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::law::by_name::{AT, assert_same, parameters, shared};

    fn shown(p: [f64; 1], a_f: f64) -> f64 {
        let mut y = Outputs { i: 1.3, omega: 7.0, theta: 0.4 };
        SpeedSensorLag::sense(p, [a_f], &AT, &mut y);
        y.omega
    }

    #[test]
    fn what_is_shown_is_the_filtered_speed() {
        let p = parameters::<SpeedSensorLag, 1, 1>([("tau", 0.005)]);
        let sum = Sum { acceleration: 300.0, ..shared::<SpeedSensorLag, 1, 1>(p, [0.0], AT) };
        assert_eq!(shown(p, 0.0), 7.0);
        assert_same(shown(p, 100.0), 6.5);
        // d(omega_f)/dt = domega/dt - tau da_f/dt is (omega - omega_f) / tau.
        let [rate] = SpeedSensorLag::rate(p, [100.0], &AT, &sum);
        assert_same(300.0 - 0.005 * rate, (7.0 - 6.5) / 0.005);
        assert_same(SpeedSensorLag::decay(p, [100.0], &AT, &sum)[0], 200.0);
    }

    #[test]
    fn it_vanishes_with_its_time_constant_and_stays_finite() {
        let sum = shared::<SpeedSensorLag, 1, 1>([0.0], [0.0], AT);
        assert_eq!(shown([0.0], 1e4), 7.0);
        assert!(SpeedSensorLag::rate([0.0], [1e4], &AT, &sum)[0].is_finite());
    }
}
