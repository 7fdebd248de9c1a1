//! What a formula is made of: a factor of the speed, one of the current and a wave over the
//! position, as a torque or a voltage.
//!
//! A factor is an odd or an even function of its variable, so that dry friction (the sign), powers,
//! what decays or saturates, and a bump are the same few magnitudes twice. Where a power has no
//! slope at zero a constant rounds it there, a thousandth of the greatest value or less.

use drivescope_plant::effects::custom::Target;

use crate::sign::sign;

/// Names of the constants of shapes, and of the coefficients.
const SHAPES: [&str; 4] = ["a", "b", "f", "g"];
pub(super) const COEFFICIENTS: [&str; 2] = ["c", "d"];
/// The wave number of an axis, rad/m.
const WAVE_NUMBER: &str = "n";

/// A function of the magnitude z of a variable; widths `a` and places `b` in its unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Magnitude {
    /// 1.
    One,
    /// z^(1/2).
    Root,
    /// z.
    Linear,
    /// z^(3/2).
    ThreeHalves,
    /// z^2.
    Square,
    /// z^3.
    Cube,
    /// exp(-z / a).
    Decay { a: f64 },
    /// z exp(-z / a).
    LinearDecay { a: f64 },
    /// exp(-(z / a)^2).
    Bell { a: f64 },
    /// z exp(-(z / a)^2).
    LinearBell { a: f64 },
    /// tanh(z / a).
    Saturating { a: f64 },
    /// tanh(z / a) exp(-(z / b)^2).
    SteepBell { a: f64, b: f64 },
    /// exp(-((z - b) / a)^2).
    Bump { a: f64, b: f64 },
    /// sin(z / a).
    Sine { a: f64 },
    /// cos(z / a).
    Cosine { a: f64 },
}

/// So many times the greatest value of its variable a width cannot be told from an infinite one.
const WIDE: f64 = 30.0;

impl Magnitude {
    /// Its constants.
    fn constants(&mut self) -> Vec<&mut f64> {
        use Magnitude::*;
        match self {
            One | Root | Linear | ThreeHalves | Square | Cube => vec![],
            Decay { a } | LinearDecay { a } | Bell { a } | LinearBell { a } => vec![a],
            Saturating { a } | Sine { a } | Cosine { a } => vec![a],
            SteepBell { a, b } | Bump { a, b } => vec![a, b],
        }
    }

    /// Values of its constants.
    fn shape(mut self) -> Vec<f64> {
        self.constants().into_iter().map(|it| *it).collect()
    }

    /// The function with fewer constants that it is up to the greatest value of its variable, in
    /// proportion, where a width of it lies far beyond.
    fn simpler(self, greatest: f64) -> Option<Self> {
        use Magnitude::*;
        let wide = |a: f64| a.abs() > WIDE * greatest;
        match self {
            Decay { a } | Bell { a } | Cosine { a } if wide(a) => Some(One),
            LinearDecay { a } | LinearBell { a } | Saturating { a } | Sine { a } if wide(a) => {
                Some(Linear)
            }
            SteepBell { a, b } if wide(b) => Some(Saturating { a }),
            SteepBell { a, b } if wide(a) => Some(LinearBell { a: b }),
            _ => None,
        }
    }

    /// Turns widths of either sign, which a fit finds alike, into positive ones; whether an odd
    /// factor of it changes its sign by that.
    fn straighten(&mut self) -> bool {
        use Magnitude::*;
        let turned = |a: &mut f64| {
            let negative = *a < 0.0;
            *a = a.abs();
            negative
        };
        match self {
            Saturating { a } | Sine { a } => turned(a),
            SteepBell { a, b } => {
                turned(b);
                turned(a)
            }
            Bell { a } | LinearBell { a } | Bump { a, .. } | Cosine { a } => {
                turned(a);
                false
            }
            One | Root | Linear | ThreeHalves | Square | Cube => false,
            Decay { .. } | LinearDecay { .. } => false,
        }
    }

    /// At a magnitude; `rounded` is where a root begins.
    fn at(self, z: f64, rounded: f64) -> f64 {
        use Magnitude::*;
        let bell = |z: f64| (-z * z).exp();
        match self {
            One => 1.0,
            Root => z / (z + rounded).sqrt(),
            Linear => z,
            ThreeHalves => z * (z + rounded).sqrt(),
            Square => z * z,
            Cube => z * z * z,
            Decay { a } => (-z / a).exp(),
            LinearDecay { a } => z * (-z / a).exp(),
            Bell { a } => bell(z / a),
            LinearBell { a } => z * bell(z / a),
            Saturating { a } => (z / a).tanh(),
            SteepBell { a, b } => (z / a).tanh() * bell(z / b),
            Bump { a, b } => bell((z - b) / a),
            Sine { a } => (z / a).sin(),
            Cosine { a } => (z / a).cos(),
        }
    }
}

/// A function of one variable.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Factor {
    /// Whether it has the sign of the variable.
    pub(super) odd: bool,
    pub(super) magnitude: Magnitude,
}

impl Factor {
    pub(super) fn at(self, value: f64, rounded: f64) -> f64 {
        let magnitude = self.magnitude.at(value.abs(), rounded);
        if self.odd { sign(value) * magnitude } else { magnitude }
    }

    /// What it is up to the greatest value of its variable with fewer constants; `Some(None)` is 1.
    fn simpler(self, greatest: f64) -> Option<Option<Self>> {
        let magnitude = self.magnitude.simpler(greatest)?;
        let is_one = magnitude == Magnitude::One && !self.odd;
        Some((!is_one).then_some(Self { magnitude, ..self }))
    }

    /// As a custom law has it, `names` being those of its constants.
    fn text(self, z: &str, rounded: f64, names: &[&str]) -> String {
        use Magnitude::*;
        let (a, b) = (names.first().unwrap_or(&""), names.get(1).unwrap_or(&""));
        let size = format!("abs({z})");
        // The variable with its sign or without, where the rest is even.
        let linear = if self.odd { z } else { &size };
        let signed = |even: String| if self.odd { format!("sign({z}) * {even}") } else { even };
        let odd = |odd: String| if self.odd { odd } else { format!("abs({odd})") };
        match self.magnitude {
            One => format!("sign({z})"),
            Root => format!("{linear} / sqrt({size} + {rounded})"),
            Linear => linear.to_owned(),
            ThreeHalves => format!("{linear} * sqrt({size} + {rounded})"),
            Square if self.odd => format!("{z} * {size}"),
            Square => format!("{z}^2"),
            Cube => format!("{linear}^3"),
            Decay { .. } => signed(format!("exp(-{size} / {a})")),
            LinearDecay { .. } => format!("{linear} * exp(-{size} / {a})"),
            Bell { .. } => signed(format!("exp(-({z} / {a})^2)")),
            LinearBell { .. } => format!("{linear} * exp(-({z} / {a})^2)"),
            Saturating { .. } => odd(format!("tanh({z} / {a})")),
            SteepBell { .. } => {
                format!("{} * exp(-({z} / {b})^2)", odd(format!("tanh({z} / {a})")))
            }
            Bump { .. } => signed(format!("exp(-(({size} - {b}) / {a})^2)")),
            Sine { .. } => odd(format!("sin({z} / {a})")),
            Cosine { .. } => signed(format!("cos({z} / {a})")),
        }
    }
}

/// What the variables are called in the drive file, and where their roots begin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Names {
    pub(super) speed: &'static str,
    pub(super) current: &'static str,
    pub(super) position: &'static str,
    /// Of the speed and of the current, in their units.
    pub(super) rounded: [f64; 2],
}

/// A wave over the position, in any phase.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Wave {
    /// So many periods a revolution.
    Periods(usize),
    /// A wave number of an axis, rad/m.
    Number(f64),
}

impl Wave {
    pub(super) fn number(self) -> f64 {
        match self {
            Self::Periods(periods) => periods as f64,
            Self::Number(number) => number,
        }
    }
}

/// A formula: one coefficient times its factors, or two where it has a wave.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Form {
    pub(super) target: Target,
    pub(super) speed: Option<Factor>,
    pub(super) current: Option<Factor>,
    pub(super) wave: Option<Wave>,
}

/// A formula as a custom law.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Written {
    pub(super) text: String,
    /// Names of its constants of shape, with their values.
    pub(super) shape: Vec<(&'static str, f64)>,
}

impl Form {
    /// Names of its coefficients.
    pub(super) fn coefficients(&self) -> &'static [&'static str] {
        &COEFFICIENTS[..if self.wave.is_some() { 2 } else { 1 }]
    }

    /// The balance that it stands in, and whether it knows the speed, the current and the position.
    pub(super) fn family(&self) -> (Target, [bool; 3]) {
        (self.target, [self.speed.is_some(), self.current.is_some(), self.wave.is_some()])
    }

    /// Its columns at a speed, a current and a position, for coefficients of 1.
    pub(super) fn at(&self, [omega, i, theta]: [f64; 3], names: &Names) -> [f64; 2] {
        let [of_speed, of_current] = names.rounded;
        let speed = self.speed.map_or(1.0, |it| it.at(omega, of_speed));
        let current = self.current.map_or(1.0, |it| it.at(i, of_current));
        let product = speed * current;
        match self.wave {
            None => [product, 0.0],
            Some(wave) => {
                let (sin, cos) = (wave.number() * theta).sin_cos();
                [product * sin, product * cos]
            }
        }
    }

    /// With the values that a fit found for its constants, widths positive; the sign that its
    /// coefficients take by that.
    pub(super) fn fitted(mut self, value: impl Fn(&str) -> Option<f64>) -> (Self, f64) {
        let mut sign = 1.0;
        if let Some(Wave::Number(number)) = &mut self.wave {
            *number = value(WAVE_NUMBER).unwrap_or(*number);
        }
        let mut names = SHAPES.iter();
        for factor in [&mut self.speed, &mut self.current].into_iter().flatten() {
            for (constant, name) in factor.magnitude.constants().into_iter().zip(names.by_ref()) {
                *constant = value(name).unwrap_or(*constant);
            }
            if factor.magnitude.straighten() && factor.odd {
                sign = -sign;
            }
        }
        (self, sign)
    }

    /// The formula with fewer constants that it is up to those greatest values of speed and current.
    pub(super) fn simpler(self, [speed, current]: [f64; 2]) -> Option<Self> {
        let of = |factor: Option<Factor>, greatest| factor.and_then(|it| it.simpler(greatest));
        let simpler = match (of(self.speed, speed), of(self.current, current)) {
            (Some(speed), _) => Self { speed, ..self },
            (None, Some(current)) => Self { current, ..self },
            (None, None) => return None,
        };
        // A constant is no formula.
        let varies = simpler.speed.is_some() || simpler.current.is_some() || simpler.wave.is_some();
        varies.then_some(simpler)
    }

    /// As the text of a custom law.
    pub(super) fn written(&self, names: &Names) -> Written {
        let mut shape: Vec<(&'static str, f64)> = Vec::new();
        let mut parts = Vec::new();
        let [c, d] = COEFFICIENTS;
        parts.push(match self.wave {
            None => c.to_owned(),
            Some(wave) => {
                let n = match wave {
                    Wave::Periods(periods) => periods.to_string(),
                    Wave::Number(number) => {
                        shape.push((WAVE_NUMBER, number));
                        WAVE_NUMBER.to_owned()
                    }
                };
                let x = names.position;
                format!("({c} * sin({n} * {x}) + {d} * cos({n} * {x}))")
            }
        });
        let mut free = SHAPES.iter();
        let of_variables = [
            (self.speed, names.speed, names.rounded[0]),
            (self.current, names.current, names.rounded[1]),
        ];
        for (factor, variable, rounded) in of_variables {
            let Some(factor) = factor else { continue };
            let own: Vec<(&'static str, f64)> =
                free.by_ref().copied().zip(factor.magnitude.shape()).collect();
            let own_names: Vec<&str> = own.iter().map(|(name, _)| *name).collect();
            parts.push(factor.text(variable, rounded, &own_names));
            shape.extend(own);
        }
        Written { text: parts.join(" * "), shape }
    }
}

/// Names and numbers in the text of a formula: how complex it is.
pub(super) fn complexity(text: &str) -> usize {
    let apart = |c: char| !(c.is_alphanumeric() || c == '_' || c == '.');
    text.split(apart).filter(|word| !word.is_empty()).count()
}
