//! The exact step where the drive is affine: x(t + h) = Phi x + Gamma (u, T_l, 1).
//!
//! The matrices are read off the one right-hand side by unit vectors, at a speed beyond which
//! every placed law is affine; there is no second formula of the physics.

use drivescope_numerics::Real;

use crate::model::{Applied, CURRENT, Model, OWN, POSITION, SPEED, field};

/// Columns of the step: current, input, speed, load, one. Beside each other stand what do not lie so in
/// memory: a state is kept number by number, and read as a vector it would have to be waited for, which
/// takes as long as the step of one drive.
const COLUMNS: usize = 5;
/// The column of the speed.
const SPEED_COLUMN: usize = 2;

/// The exact step of `N` drives in one direction of motion.
#[derive(Debug, Clone)]
#[repr(C, align(64))]
pub(super) struct Affine<R, const N: usize> {
    /// Speed beyond which each lane is affine; without dry friction that is everywhere.
    pub(super) beyond: [f64; N],
    /// `matrix[row][column][lane]`; rows current, speed, position (less its start).
    pub(super) matrix: [[[R; N]; COLUMNS]; OWN],
    /// The speed along the direction of motion had the acceleration of the start lasted the whole step, as
    /// a row over the same columns.
    pub(super) ahead: [[f64; N]; COLUMNS],
    /// For lanes that ring: what that acceleration adds, a quarter of a period on, so that both together
    /// give its amplitude.
    pub(super) quadrature: [[f64; N]; COLUMNS],
    /// Whether any lane does.
    pub(super) rings: bool,
    /// The direction of motion, +1 or -1.
    pub(super) sign: f64,
}

/// A continuous affine drive of one direction: d(i, omega)/dt = a (i, omega) + b (u, T_l, 1).
#[derive(Debug, Clone)]
pub(super) struct Continuous<R> {
    pub(super) a: [[R; 2]; 2],
    pub(super) b: [[R; 3]; 2],
}

impl<R: Real> Continuous<R> {
    /// Reads the matrices of every lane off the field: direction `sign`, speeds beyond `beyond`.
    pub(super) fn read<const N: usize>(
        model: &Model<R, N>,
        sign: f64,
        beyond: &[f64; N],
    ) -> [Self; N] {
        // Two speeds in the affine zone: their difference is the speed column.
        let base = beyond.map(|beyond| sign * (beyond + 1.0));
        let slope = |i: f64, omega: [f64; N], u: f64, load: f64| {
            let mut x = [[R::zero(); N]; OWN];
            x[CURRENT] = [R::constant(i); N];
            x[SPEED] = omega.map(R::constant);
            let (u, load) = ([R::constant(u); N], [R::constant(load); N]);
            let mut dx = [[R::zero(); N]; OWN];
            field(model, &x, &Applied { u, load, time: 0.0 }, &[sign; N], &mut dx, None);
            dx
        };
        let at_base = slope(0.0, base, 0.0, 0.0);
        let (i, u, load) =
            (slope(1.0, base, 0.0, 0.0), slope(0.0, base, 1.0, 0.0), slope(0.0, base, 0.0, 1.0));
        let omega = slope(0.0, base.map(|base| 2.0 * base), 0.0, 0.0);
        std::array::from_fn(|l| {
            let at_base = [at_base[CURRENT][l], at_base[SPEED][l]];
            let column = |other: &[[R; N]; OWN]| {
                [other[CURRENT][l] - at_base[0], other[SPEED][l] - at_base[1]]
            };
            let (i, u, load) = (column(&i), column(&u), column(&load));
            let omega = column(&omega).map(|d| d.scaled(1.0 / base[l]));
            let rest = |row: usize| at_base[row] - omega[row].scaled(base[l]);
            Self {
                a: [[i[0], omega[0]], [i[1], omega[1]]],
                b: [[u[0], load[0], rest(0)], [u[1], load[1], rest(1)]],
            }
        })
    }
}

/// Columns of the augmented matrix: current, speed, position and two unit slopes.
const SIZE: usize = OWN + 2;
/// Its rows before those of the slopes, which are the unit matrix's in every exponential.
type Augmented<R> = [[R; SIZE]; OWN];

/// A matrix times one whose slopes stay as they are.
fn product<R: Real>(a: &Augmented<R>, b: &Augmented<R>) -> Augmented<R> {
    let mut c = [[R::zero(); SIZE]; OWN];
    for (row, left) in c.iter_mut().zip(a) {
        for (factor, values) in left.iter().zip(b) {
            for (sum, value) in row.iter_mut().zip(values) {
                *sum += *factor * *value;
            }
        }
        for (sum, factor) in row.iter_mut().zip(left).skip(OWN) {
            *sum += *factor;
        }
    }
    c
}

/// Taylor terms of the exponential after scaling to norm 1/4: 0.25^13 / 13! is below 1e-17.
const TERMS: usize = 12;

/// The matrix exponential by scaling, Taylor series and squaring; the slopes do not change.
fn exponential<R: Real>(a: &Augmented<R>) -> Augmented<R> {
    let norm =
        a.iter().map(|row| row.iter().map(|x| x.value().abs()).sum::<f64>()).fold(0.0, f64::max);
    let squarings = (norm * 4.0).log2().ceil().max(0.0) as i32;
    let scale = 0.5f64.powi(squarings);
    let scaled = a.map(|row| row.map(|x| x.scaled(scale)));
    let mut identity = [[R::zero(); SIZE]; OWN];
    for (k, row) in identity.iter_mut().enumerate() {
        row[k] = R::one();
    }
    // Horner: I + A/1 (I + A/2 (I + ...)).
    let mut sum = identity;
    for k in (1..=TERMS).rev() {
        sum = product(&scaled, &sum);
        for (row, unit) in sum.iter_mut().zip(&identity) {
            for (x, one) in row.iter_mut().zip(unit) {
                *x = x.scaled(1.0 / k as f64) + *one;
            }
        }
    }
    (0..squarings).fold(sum, |power, _| product(&power, &power))
}

/// Exponentials over one time: lanes that differ in no parameter of their motion share one, and so do the
/// two directions.
pub(super) struct Exponentials<R> {
    h: R,
    made: Vec<([[R; 2]; 2], Augmented<R>)>,
}

impl<R: Real> Exponentials<R> {
    /// Over `h`.
    pub(super) fn over(h: R) -> Self {
        Self { h, made: Vec::new() }
    }

    /// That time, s.
    fn seconds(&self) -> f64 {
        self.h.value()
    }

    /// The exponential of current, speed and position with two unit slopes beside them.
    fn of(&mut self, a: &[[R; 2]; 2]) -> Augmented<R> {
        // Most lanes are like one of the last.
        if let Some((_, phi)) = self.made.iter().rev().find(|(same, _)| same == a) {
            return *phi;
        }
        let h = self.h;
        let mut augmented = [[R::zero(); SIZE]; OWN];
        for row in 0..2 {
            augmented[row][0] = a[row][0] * h;
            augmented[row][1] = a[row][1] * h;
            augmented[row][3 + row] = h;
        }
        augmented[2][1] = h;
        let phi = exponential(&augmented);
        self.made.push((*a, phi));
        phi
    }
}

impl<R: Real, const N: usize> Affine<R, N> {
    /// The step of every lane in the direction `sign`; nothing if a lane is affine nowhere.
    pub(super) fn new(
        model: &Model<R, N>,
        sign: f64,
        exponentials: &mut Exponentials<R>,
    ) -> Option<Self> {
        let beyond: [f64; N] = std::array::from_fn(|l| model.affine_beyond(l));
        if beyond.iter().any(|speed| !speed.is_finite()) {
            return None;
        }
        let mut matrix = [[[R::zero(); N]; COLUMNS]; OWN];
        let seconds = exponentials.seconds();
        let mut ahead = [[0.0; N]; COLUMNS];
        let mut quadrature = [[0.0; N]; COLUMNS];
        let mut rings = false;
        for (l, Continuous { a, b }) in
            Continuous::read(model, sign, &beyond).into_iter().enumerate()
        {
            let acceleration = [a[1][0], b[1][0], a[1][1], b[1][1], b[1][2]].map(R::value);
            for (column, value) in acceleration.into_iter().enumerate() {
                let now = if column == SPEED_COLUMN { 1.0 } else { 0.0 };
                ahead[column][l] = sign * (now + seconds * value);
            }
            // Eigenvalues of a: -decay +- sqrt(root); the acceleration then follows
            // e^(-decay t) cos(w t + phase), w = sqrt(-root), and its derivative is a row too.
            let a_value = a.map(|row| row.map(R::value));
            let decay = -0.5 * (a_value[0][0] + a_value[1][1]);
            let determinant = a_value[0][0] * a_value[1][1] - a_value[0][1] * a_value[1][0];
            let root = decay * decay - determinant;
            if root < 0.0 {
                rings = true;
                let b_value = b.map(|row| row.map(R::value));
                let current =
                    [a_value[0][0], b_value[0][0], a_value[0][1], b_value[0][1], b_value[0][2]];
                for (column, slope) in current.into_iter().enumerate() {
                    let own = acceleration[column];
                    let jerk = a_value[1][0] * slope + a_value[1][1] * own;
                    quadrature[column][l] = seconds * (jerk + decay * own) / (-root).sqrt();
                }
            }
            let phi = exponentials.of(&a);
            for row in 0..OWN {
                let held = |column: usize| phi[row][3] * b[0][column] + phi[row][4] * b[1][column];
                let made = [phi[row][0], held(0), phi[row][1], held(1), held(2)];
                for (column, value) in made.into_iter().enumerate() {
                    matrix[row][column][l] = value;
                }
            }
        }
        let beyond = if model.dry() { beyond } else { [f64::NEG_INFINITY; N] };
        Some(Self { matrix, ahead, quadrature, rings, sign, beyond })
    }

    /// The step of one lane.
    pub(super) fn lane(&self, l: usize) -> Affine<R, 1> {
        Affine {
            matrix: self.matrix.map(|row| row.map(|column| [column[l]])),
            ahead: self.ahead.map(|column| [column[l]]),
            quadrature: self.quadrature.map(|column| [column[l]]),
            rings: self.rings,
            sign: self.sign,
            beyond: [self.beyond[l]],
        }
    }

    /// Which lanes go this way and stay in their affine zone from `x` to `next`, also in between:
    /// the speed can dip below both ends only if it starts out falling, and no further than at
    /// that rate; one that rings never falls faster than at the amplitude of its acceleration.
    /// A number a lane, 1 or 0: loops over truth values do not become vector code.
    #[inline(always)]
    pub(super) fn holds(
        &self,
        (x, sign): (&[[R; N]], &[f64; N]),
        next: &[[R; N]; OWN],
        applied: &Applied<R, N>,
    ) -> [u64; N] {
        let ahead = along(&self.ahead, x, applied);
        let mut least = [0.0; N];
        for l in 0..N {
            least[l] = lesser(self.sign * x[SPEED][l].value(), ahead[l]);
        }
        if self.rings {
            let quadrature = along(&self.quadrature, x, applied);
            for l in 0..N {
                let now = self.sign * x[SPEED][l].value();
                let gain = ahead[l] - now;
                let amplitude = (gain * gain + quadrature[l] * quadrature[l]).sqrt();
                least[l] = if quadrature[l] != 0.0 { now - amplitude } else { least[l] };
            }
        }
        let mut holds = [0; N];
        for l in 0..N {
            let least = lesser(least[l], self.sign * next[SPEED][l].value());
            holds[l] = u64::from((least > self.beyond[l]) & (sign[l] == self.sign));
        }
        holds
    }

    /// The state a step later.
    #[inline(always)]
    pub(super) fn step(&self, x: &[[R; N]], applied: &Applied<R, N>) -> [[R; N]; OWN] {
        let mut next = [[R::zero(); N]; OWN];
        for row in 0..OWN {
            let m = &self.matrix[row];
            for l in 0..N {
                let from_state = m[0][l] * x[CURRENT][l] + m[2][l] * x[SPEED][l];
                let from_input = m[1][l] * applied.u[l] + m[3][l] * applied.load[l] + m[4][l];
                next[row][l] = from_state + from_input;
            }
        }
        for l in 0..N {
            next[POSITION][l] += x[POSITION][l];
        }
        next
    }
}

/// The lesser of two; what is not a number where `b` is.
#[inline(always)]
fn lesser(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// What a row over the columns gives for each lane.
#[inline(always)]
fn along<R: Real, const N: usize>(
    row: &[[f64; N]; COLUMNS],
    x: &[[R; N]],
    applied: &Applied<R, N>,
) -> [f64; N] {
    let mut sum = [0.0; N];
    for l in 0..N {
        sum[l] = row[0][l] * x[CURRENT][l].value()
            + row[1][l] * applied.u[l].value()
            + row[2][l] * x[SPEED][l].value()
            + row[3][l] * applied.load[l].value()
            + row[4][l];
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exponential_of_a_rotation_and_a_decay_is_exact() {
        let mut a = [[0.0; SIZE]; OWN];
        a[0][1] = 2.0;
        a[1][0] = -2.0;
        a[2][2] = -30.0;
        (a[0][3], a[2][4]) = (1.0, 6.0);
        let e = exponential(&a);
        let (sin, cos) = 2.0f64.sin_cos();
        for (found, expected) in [
            (e[0][0], cos),
            (e[0][1], sin),
            (e[1][0], -sin),
            (e[2][2], (-30.0f64).exp()),
            // What a slope adds in the meantime.
            (e[0][3], 0.5 * sin),
            (e[1][3], 0.5 * (cos - 1.0)),
            (e[2][4], 0.2 * (1.0 - (-30.0f64).exp())),
        ] {
            assert!((found - expected).abs() < 1e-14, "{found} against {expected}");
        }
    }
}
