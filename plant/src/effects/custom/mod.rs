//! A law that the user types in the drive file, for example `torque = "-c * omega * abs(omega)"`.
//!
//! The text is parsed once (`parse.rs`) into a tape of operations for a stack (`tape.rs`): no
//! code is executed, size and depth are limited, and the same tape runs over `f64`, duals and
//! lanes, natively and inside an exported FMU. Signs: a torque is added to the motor torque, a
//! voltage to the applied voltage, a flux to the nominal one, which is 1, heat to the winding; `omega` and `i` are what the sensor
//! shows. A learned curve ([`super::learned`]) is another such law, given by knots.

mod parse;
mod tape;

use drivescope_numerics::Real;

pub use parse::LawError;
use tape::Tape;

use super::law::{OutputLanes, Sums, Variable, Views};
use super::learned::Curve;
use crate::model::{Motor, Motors};

/// What a typed law gives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    /// A torque (force) in the positive direction, N m (N).
    Torque,
    /// A voltage in the armature circuit in the direction of u, V.
    Voltage,
    /// A share of the nominal flux in its direction: it acts in both balances.
    Flux,
    /// Heat into the winding, W.
    Heat,
    /// The speed that the tachometer shows, rad/s (m/s).
    Omega,
    /// The current that its sensor shows, A.
    Current,
}

impl Target {
    /// Every target with its key in the drive file.
    pub const ALL: [(&'static str, Self); 6] = [
        ("torque", Self::Torque),
        ("voltage", Self::Voltage),
        ("flux", Self::Flux),
        ("heat", Self::Heat),
        ("omega", Self::Omega),
        ("i", Self::Current),
    ];
}

/// Places at which a law is asked whether it changes anything: `[i, omega, theta, u, t]`, SI, from
/// small to great and in both directions.
const PLACES: [[f64; 5]; 8] = [
    [0.013, 0.17, 0.011, 0.19, 0.023],
    [-0.019, -0.11, -0.43, -0.29, 0.31],
    [0.7, -3.1, 2.3, 1.7, 1.1],
    [-1.3, 5.3, -7.9, -4.1, 2.9],
    [3.7, 37.0, 61.0, 11.0, 7.3],
    [-7.1, -83.0, -127.0, -23.0, 19.0],
    [29.0, 310.0, 710.0, 47.0, 53.0],
    [-113.0, -1300.0, -2100.0, -190.0, 370.0],
];

/// A law of the drive file, ready to run.
#[derive(Debug, Clone, PartialEq)]
pub struct Law {
    target: Target,
    form: Form,
}

/// How the law is given.
#[derive(Debug, Clone, PartialEq)]
enum Form {
    Typed(Tape),
    Learned(Curve),
}

impl Form {
    #[inline(always)]
    fn run<R: Real, const N: usize>(&self, p: &[[R; N]], at: &Views<'_, R, N>) -> [R; N] {
        match self {
            Self::Typed(tape) => tape.run(p, at),
            Self::Learned(curve) => curve.value(p, at),
        }
    }
}

/// An expression in the time `t` alone, as a reference or input signal is typed.
#[derive(Debug, Clone, PartialEq)]
pub struct Expression(Tape);

impl Expression {
    /// Parses the text.
    ///
    /// # Errors
    /// [`LawError`] with the byte position in the text; also where it uses anything but `t`.
    pub fn parse(text: &str) -> Result<Self, LawError> {
        Ok(Self(parse::parse(text, &[], &parse::TIME)?))
    }

    /// The value at time `t`, s.
    pub fn at(&self, t: f64) -> f64 {
        // An expression reads no variable of the drive.
        let motor = Motor { r: 0.0, l: 0.0, k_e: 0.0, k_m: 0.0, j: 0.0, b_m: 0.0, friction: 0.0 };
        let none = [0.0];
        let at = Views {
            motors: &Motors::splat(motor),
            i: &none,
            omega: &none,
            theta: &none,
            direction: &none,
            u: &none,
            load: &none,
            time: t,
        };
        self.0.run::<f64, 1>(&[], &at)[0]
    }
}

impl Law {
    /// Parses the text; `parameters` are the names of the coefficients, in the order in which
    /// their values are given later.
    ///
    /// # Errors
    /// [`LawError`] with the byte position in the text.
    pub fn parse(target: Target, text: &str, parameters: &[String]) -> Result<Self, LawError> {
        let form = Form::Typed(parse::parse(text, parameters, &parse::DRIVE)?);
        Ok(Self { target, form })
    }

    /// The law of a curve, whose parameters are its values at the knots.
    pub fn learned(target: Target, curve: Curve) -> Self {
        Self { target, form: Form::Learned(curve) }
    }

    /// What the law gives.
    pub fn target(&self) -> Target {
        self.target
    }

    /// What it gives at one place, for its coefficients in their order: `[i, omega, theta, u, t]`,
    /// SI.
    pub fn at(&self, parameters: &[f64], [i, omega, theta, u, time]: [f64; 5]) -> f64 {
        let motor = Motor { r: 0.0, l: 0.0, k_e: 0.0, k_m: 0.0, j: 0.0, b_m: 0.0, friction: 0.0 };
        let at = Views {
            motors: &Motors::splat(motor),
            i: &[i],
            omega: &[omega],
            theta: &[theta],
            direction: &[omega.signum()],
            u: &[u],
            load: &[0.0],
            time,
        };
        let parameters: Vec<[f64; 1]> = parameters.iter().map(|value| [*value]).collect();
        self.form.run::<f64, 1>(&parameters, &at)[0]
    }

    /// Whether the law changes nothing with these coefficients, wherever the drive is: its share
    /// is zero, or its sensor shows what is there.
    pub fn vanishes(&self, parameters: &[f64]) -> bool {
        let without = |[i, omega, ..]: [f64; 5]| match self.target {
            Target::Torque | Target::Voltage | Target::Flux | Target::Heat => 0.0,
            Target::Omega => omega,
            Target::Current => i,
        };
        // Where it overflows at the greatest of the places, the others tell.
        let values = PLACES.map(|place| (self.at(parameters, place), without(place)));
        let mut finite = values.iter().filter(|(value, _)| value.is_finite()).peekable();
        finite.peek().is_some() && finite.all(|(value, without)| value == without)
    }

    /// The variables over which a model without the law fails: those that it reads, or any.
    pub fn fails_over(&self) -> Vec<Variable> {
        let read = match &self.form {
            Form::Typed(tape) => tape.read(),
            Form::Learned(_) => Vec::new(),
        };
        if read.is_empty() { Variable::ALL.to_vec() } else { read }
    }

    /// Whether the law changes with time while nothing moves.
    pub(crate) fn reads_time(&self) -> bool {
        match &self.form {
            Form::Typed(tape) => tape.read().contains(&Variable::Time),
            Form::Learned(curve) => curve.reads_time(),
        }
    }

    /// Whether the law gives the same as long as the shaft rests: it reads speed and position alone.
    pub(crate) fn is_steady_at_rest(&self) -> bool {
        match &self.form {
            Form::Typed(tape) => tape.read().iter().all(|over| over.rests()),
            Form::Learned(curve) => curve.is_steady_at_rest(),
        }
    }

    /// Whether the law is a dry friction, whose sign is that of the motion.
    pub fn is_dry(&self) -> bool {
        self.target == Target::Torque
            && matches!(&self.form, Form::Learned(curve) if curve.is_dry())
    }

    /// Whether the law distorts what a sensor shows.
    pub fn senses(&self) -> bool {
        matches!(self.target, Target::Omega | Target::Current)
    }

    #[inline(always)]
    pub(super) fn share<R: Real, const N: usize>(
        &self,
        p: &[[R; N]],
        at: &Views<'_, R, N>,
        sum: &mut Sums<R, N>,
    ) {
        if self.senses() {
            return;
        }
        let value = self.form.run(p, at);
        let is_dry = self.is_dry();
        for l in 0..N {
            match self.target {
                // The balance of torques gives a dry friction its sign, and holds the shaft with it.
                Target::Torque if is_dry => {
                    sum.forward[l] -= value[l];
                    sum.backward[l] -= value[l];
                }
                Target::Torque => sum.torque[l] -= value[l],
                Target::Flux => sum.flux[l] += value[l],
                Target::Voltage => sum.voltage[l] -= value[l],
                Target::Heat => sum.heat[l] += value[l],
                Target::Omega | Target::Current => {}
            }
        }
    }

    #[inline(always)]
    pub(super) fn sense<R: Real, const N: usize>(
        &self,
        p: &[[R; N]],
        at: &Views<'_, R, N>,
        y: &mut OutputLanes<R, N>,
    ) {
        match self.target {
            Target::Omega => y.omega = self.form.run(p, at),
            Target::Current => y.i = self.form.run(p, at),
            Target::Torque | Target::Voltage | Target::Flux | Target::Heat => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_expression_knows_the_time_alone() {
        let ramp = Expression::parse("min(10 * t, 5)").expect("it is right");
        assert_eq!((ramp.at(0.25), ramp.at(2.0)), (2.5, 5.0));
        let error = Expression::parse("omega + 1").expect_err("there is no drive");
        assert_eq!(error.at(), 0);
    }

    #[test]
    fn a_law_vanishes_where_it_changes_nothing() {
        let law = |target, text: &str| Law::parse(target, text, &["c".to_owned(), "w".to_owned()]);
        let drag = law(Target::Torque, "-c * omega * exp(-abs(omega) / w)").expect("right");
        assert!(drag.vanishes(&[0.0, 5.0]) && !drag.vanishes(&[1e-9, 5.0]));
        let ratio = law(Target::Torque, "c * omega / w").expect("right");
        assert!(!ratio.vanishes(&[0.0, 0.0]), "0 / 0 is no null");
        let steep = law(Target::Torque, "c * exp(omega * 10)").expect("right");
        assert!(steep.vanishes(&[0.0, 0.0]), "it is finite at some places");
        let shown = law(Target::Omega, "omega * (1 + c * sin(w * theta))").expect("right");
        assert!(shown.vanishes(&[0.0, 5.0]) && !shown.vanishes(&[0.1, 5.0]));
        assert!(!law(Target::Omega, "c * omega + w").expect("right").vanishes(&[0.0, 0.0]));
    }

    #[test]
    fn a_law_fails_over_what_it_reads() {
        let of = |text: &str| Law::parse(Target::Torque, text, &[]).expect("right").fails_over();
        assert_eq!(of("i * theta * i"), [Variable::Current, Variable::Theta]);
        assert_eq!(of("omega"), [Variable::Omega, Variable::OmegaSign]);
        assert_eq!(of("2"), Variable::ALL);
    }

    #[test]
    fn a_law_has_a_value_at_a_place() {
        let names = ["c".to_owned(), "d".to_owned()];
        let law = Law::parse(Target::Torque, "-c * omega * abs(omega) + d * i + theta", &names);
        let value = law.expect("it is right").at(&[2.0, 10.0], [0.5, -3.0, 0.25, 0.0, 0.0]);
        assert_eq!(value, 18.0 + 5.0 + 0.25);
    }

    #[test]
    fn roots_and_powers_have_a_finite_slope_at_rest() {
        use drivescope_numerics::Dual;
        let zero = Dual::<1>::constant(0.0);
        let motor =
            Motor { r: zero, l: zero, k_e: zero, k_m: zero, j: zero, b_m: zero, friction: zero };
        let slope = |text: &str, omega: f64| {
            let law = Law::parse(Target::Torque, text, &[]).expect("right");
            let at = Views {
                motors: &Motors::splat(motor),
                i: &[zero],
                omega: &[Dual::parameter(omega, 0)],
                theta: &[zero],
                direction: &[0.0],
                u: &[zero],
                load: &[zero],
                time: 0.0,
            };
            law.form.run(&[], &at)[0]
        };
        for text in ["omega * abs(omega)^0.5", "omega * sqrt(abs(omega))", "abs(omega)^1.5"] {
            let at_rest = slope(text, 0.0);
            assert_eq!((at_rest.v, at_rest.d), (0.0, [0.0]), "{text}");
            let moving = slope(text, 4.0);
            assert!((moving.v - 8.0).abs() < 1e-12 && (moving.d[0] - 3.0).abs() < 1e-12, "{text}");
        }
        assert_eq!(slope("abs(omega)^0", 0.0).v, 1.0);
        assert_eq!(slope("abs(omega)^(-1)", 0.0).v, f64::INFINITY);
    }
}
