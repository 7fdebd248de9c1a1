//! A parsed law as operations on a stack; the loop over the lanes is inside each operation.

use drivescope_numerics::Real;

use crate::effects::law::{Variable as Shows, Views};

/// Deepest stack that a law may need.
pub(super) const DEEPEST: usize = 16;
/// Most operations that a law may have.
pub(super) const LONGEST: usize = 256;

/// A variable of the drive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Variable {
    Current,
    Speed,
    Position,
    Input,
    Time,
}

/// A function of one number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Function {
    Abs,
    Sign,
    Exp,
    Ln,
    Sqrt,
    Sin,
    Cos,
    Tan,
    Tanh,
}

impl Function {
    /// Every function with the name that the user types.
    pub(super) const ALL: [(&'static str, Self); 9] = [
        ("abs", Self::Abs),
        ("sign", Self::Sign),
        ("exp", Self::Exp),
        ("ln", Self::Ln),
        ("sqrt", Self::Sqrt),
        ("sin", Self::Sin),
        ("cos", Self::Cos),
        ("tan", Self::Tan),
        ("tanh", Self::Tanh),
    ];

    /// The function of every lane; the choice stands outside the loop.
    #[inline(always)]
    fn apply<R: Real, const N: usize>(self, x: &mut [R; N]) {
        match self {
            Self::Abs => map(x, R::abs),
            Self::Sign => map(x, sign),
            Self::Exp => map(x, R::exp),
            Self::Ln => map(x, R::ln),
            Self::Sqrt => map(x, |x| flat_at_zero(x, 0.0, R::sqrt)),
            Self::Sin => map(x, R::sin),
            Self::Cos => map(x, R::cos),
            Self::Tan => map(x, tan),
            Self::Tanh => map(x, R::tanh),
        }
    }
}

#[inline(always)]
fn sign<R: Real>(x: R) -> R {
    let below = R::select(x.value() < 0.0, R::constant(-1.0), R::zero());
    R::select(x.value() > 0.0, R::one(), below)
}

/// A root or a power of 0 is taken as flat, as |x| is: its slope there, where it has none or an
/// infinite one, would make everything that is differentiated through a standing shaft no number.
#[inline(always)]
fn flat_at_zero<R: Real>(x: R, at_zero: f64, f: impl Fn(R) -> R) -> R {
    R::select(x.value() == 0.0, R::constant(at_zero), f(x))
}

#[inline(always)]
fn tan<R: Real>(x: R) -> R {
    let (sin, cos) = x.sin_cos();
    sin / cos
}

/// An operation: it takes its arguments off the stack and leaves its result there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Operation {
    Constant(f64),
    Variable(Variable),
    Parameter(usize),
    Negate,
    Apply(Function),
    /// A power with a whole exponent, by multiplication: right for negative bases too.
    WholePower(u32),
    Add,
    Subtract,
    Multiply,
    Divide,
    /// a^b = e^(b ln a), for a positive base.
    Power,
    Least,
    Greatest,
}

/// The operations of a law in the order of execution.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tape(pub(super) Vec<Operation>);

impl Tape {
    /// The variables that the law reads, as those over which its absence shows; an input shows over
    /// the current and the speed that it drives.
    pub(super) fn read(&self) -> Vec<Shows> {
        let shows = |operation: &Operation| match operation {
            Operation::Variable(Variable::Current) => &[Shows::Current][..],
            Operation::Variable(Variable::Speed) => &[Shows::Omega, Shows::OmegaSign],
            Operation::Variable(Variable::Position) => &[Shows::Theta],
            Operation::Variable(Variable::Input) => &[Shows::Omega, Shows::Current],
            Operation::Variable(Variable::Time) => &[Shows::Time],
            _ => &[],
        };
        let mut read: Vec<Shows> = Vec::new();
        for one in self.0.iter().flat_map(shows) {
            if !read.contains(one) {
                read.push(*one);
            }
        }
        read
    }
}

#[inline(always)]
fn map<R: Real, const N: usize>(x: &mut [R; N], f: impl Fn(R) -> R) {
    for value in x {
        *value = f(*value);
    }
}

#[inline(always)]
fn merge<R: Real, const N: usize>(a: &mut [R; N], b: &[R; N], f: impl Fn(R, R) -> R) {
    for l in 0..N {
        a[l] = f(a[l], b[l]);
    }
}

fn whole_power<R: Real>(x: R, exponent: u32) -> R {
    (0..exponent).fold(R::one(), |product, _| product * x)
}

impl Tape {
    /// Runs the tape. The parser has checked that the stack neither overflows nor runs dry.
    #[inline(always)]
    pub(super) fn run<R: Real, const N: usize>(
        &self,
        p: &[[R; N]],
        at: &Views<'_, R, N>,
    ) -> [R; N] {
        let mut stack = [[R::zero(); N]; DEEPEST];
        let mut top = 0;
        for operation in &self.0 {
            match *operation {
                Operation::Constant(value) => {
                    stack[top] = [R::constant(value); N];
                    top += 1;
                }
                Operation::Variable(variable) => {
                    stack[top] = match variable {
                        Variable::Current => *at.i,
                        Variable::Speed => *at.omega,
                        Variable::Position => *at.theta,
                        Variable::Input => *at.u,
                        Variable::Time => [R::constant(at.time); N],
                    };
                    top += 1;
                }
                Operation::Parameter(k) => {
                    stack[top] = p[k];
                    top += 1;
                }
                Operation::Negate => map(&mut stack[top - 1], |x| -x),
                Operation::Apply(function) => function.apply(&mut stack[top - 1]),
                Operation::WholePower(n) => map(&mut stack[top - 1], |x| whole_power(x, n)),
                two_arguments => {
                    top -= 1;
                    let (left, right) = stack.split_at_mut(top);
                    let (a, b) = (&mut left[top - 1], &right[0]);
                    match two_arguments {
                        Operation::Add => merge(a, b, |x, y| x + y),
                        Operation::Subtract => merge(a, b, |x, y| x - y),
                        Operation::Multiply => merge(a, b, |x, y| x * y),
                        Operation::Divide => merge(a, b, |x, y| x / y),
                        Operation::Power => merge(a, b, |x, y| {
                            let at_zero = 0.0_f64.powf(y.value());
                            flat_at_zero(x, at_zero, |x| (y * x.ln()).exp())
                        }),
                        Operation::Least => {
                            merge(a, b, |x, y| R::select(y.value() < x.value(), y, x));
                        }
                        _ => merge(a, b, |x, y| R::select(y.value() > x.value(), y, x)),
                    }
                }
            }
        }
        stack[0]
    }
}
