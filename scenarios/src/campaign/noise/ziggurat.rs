//! Standard normal numbers over lanes, by the ziggurat.
//!
//! 1024 layers of equal area under exp(-x^2 / 2): G. Marsaglia, W. W. Tsang, J. Stat. Softw. 5 (2000),
//! in the form of J. A. Doornik (2005). One number in 230 leaves the vector code; it is made from
//! its own lane's stream alone, so that a lane does not depend on its neighbours. The generator of a
//! lane is xoshiro256++ (D. Blackman, S. Vigna, 2019). No function of the platform's library is
//! called: the same bytes on every processor.

use std::sync::LazyLock;

use drivescope_numerics::elementary::exp;

const LAYERS: usize = 1024;
/// The bits of a word that choose the layer.
const LAYER: u64 = LAYERS as u64 - 1;
/// Where the tail begins, and the area of a layer.
const TAIL: f64 = 4.038_849_846_109_504;
const AREA: f64 = 0.001_226_324_646_353_088;

/// The half of a number's bits that a right end is kept with.
const HALF: u64 = 0xFFFF_FFFF_0000_0000;

/// Right ends of the layers, from the bottom, and exp(-x^2 / 2) there.
#[derive(Debug)]
struct Layers {
    x: [f64; LAYERS + 1],
    f: [f64; LAYERS + 1],
    /// Of each layer its own right end and that of the next, half a number each: one word to fetch,
    /// which in vector code costs more than all that is done with it.
    ends: [u64; LAYERS],
}

impl Layers {
    /// The right ends of a layer and of the next.
    #[inline(always)]
    fn ends(&self, layer: usize) -> [f64; 2] {
        let ends = self.ends[layer];
        [ends & HALF, ends << 32].map(f64::from_bits)
    }
}

static TABLES: LazyLock<Layers> = LazyLock::new(|| {
    let mut x = [0.0; LAYERS + 1];
    let height = |x: f64| exp(-0.5 * x * x);
    (x[0], x[1]) = (AREA / height(TAIL), TAIL);
    for k in 2..LAYERS {
        x[k] = (-2.0 * ln(AREA / x[k - 1] + height(x[k - 1]))).sqrt();
    }
    // To the nearest that half of the bits can say. What one layer gains so the next one loses: the
    // density is wrong by some millionths of itself at most.
    let x = x.map(|x| f64::from_bits((x.to_bits() + (1 << 31)) & HALF));
    let ends = std::array::from_fn(|k| x[k].to_bits() | x[k + 1].to_bits() >> 32);
    Layers { x, f: x.map(height), ends }
});

/// The natural logarithm of a positive, normal number, to some units in the last place.
fn ln(x: f64) -> f64 {
    let bits = x.to_bits();
    let mut exponent = (bits >> 52) as i64 - 1023;
    let mut mantissa = f64::from_bits(bits & 0x000F_FFFF_FFFF_FFFF | 1023 << 52);
    if mantissa > std::f64::consts::SQRT_2 {
        mantissa *= 0.5;
        exponent += 1;
    }
    // 2 artanh(s), |s| < 0.172: s^27 is below 1e-20.
    let s = (mantissa - 1.0) / (mantissa + 1.0);
    let series = (0..13).rev().fold(0.0, |sum, k| sum * s * s + 1.0 / f64::from(2 * k + 1));
    exponent as f64 * std::f64::consts::LN_2 + 2.0 * s * series
}

/// Streams of normal numbers, one a lane.
#[derive(Debug, Clone)]
pub(super) struct Normals<const N: usize> {
    state: [[u64; N]; 4],
    layers: &'static Layers,
}

impl<const N: usize> Normals<N> {
    /// The streams of those seeds.
    pub(super) fn new(seeds: [u64; N]) -> Self {
        let mut state = [[0; N]; 4];
        for (l, seed) in seeds.into_iter().enumerate() {
            // splitmix64, as the authors of the generator advise.
            let mut z = seed;
            for word in &mut state {
                z = z.wrapping_add(0x9E37_79B9_7F4A_7C15);
                let a = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
                let b = (a ^ (a >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
                word[l] = b ^ (b >> 31);
            }
        }
        Self { state, layers: &TABLES }
    }

    /// The next number of every lane.
    #[inline(always)]
    pub(super) fn next(&mut self) -> [f64; N] {
        let mut drawn = [0; N];
        for l in 0..N {
            drawn[l] = self.word(l);
        }
        let (mut value, mut outside) = ([0.0; N], [0u64; N]);
        for l in 0..N {
            let layer = (drawn[l] & LAYER) as usize;
            let [own, next] = self.layers.ends(layer);
            value[l] = signed(drawn[l]) * own;
            outside[l] = u64::from(value[l].abs() >= next);
        }
        let mut any = 0;
        for l in 0..N {
            any |= outside[l];
        }
        if any != 0 {
            for l in 0..N {
                if outside[l] != 0 {
                    value[l] = self.at_the_edge(l, (drawn[l] & LAYER) as usize, value[l]);
                }
            }
        }
        value
    }

    /// The next 64 bits of a lane.
    #[inline(always)]
    fn word(&mut self, l: usize) -> u64 {
        let [a, b, c, d] = &mut self.state;
        let word = a[l].wrapping_add(d[l]).rotate_left(23).wrapping_add(a[l]);
        let shifted = b[l] << 17;
        c[l] ^= a[l];
        d[l] ^= b[l];
        b[l] ^= c[l];
        a[l] ^= d[l];
        c[l] ^= shifted;
        d[l] = d[l].rotate_left(45);
        word
    }

    /// A number beside the rectangle of its layer: taken, or another in its place.
    #[cold]
    #[inline(never)]
    fn at_the_edge(&mut self, l: usize, mut layer: usize, mut value: f64) -> f64 {
        loop {
            if value.abs() < self.layers.x[layer + 1] {
                return value;
            }
            if layer == 0 {
                return self.tail(l, value < 0.0);
            }
            let (low, high) = (self.layers.f[layer], self.layers.f[layer + 1]);
            let height = low + (high - low) * unit(self.word(l));
            if height < exp(-0.5 * value * value) {
                return value;
            }
            let drawn = self.word(l);
            layer = (drawn & LAYER) as usize;
            value = signed(drawn) * self.layers.x[layer];
        }
    }

    /// A number beyond the last layer (Marsaglia's method).
    fn tail(&mut self, l: usize, negative: bool) -> f64 {
        loop {
            let x = ln(unit(self.word(l))) / TAIL;
            let y = ln(unit(self.word(l)));
            if -2.0 * y >= x * x {
                return if negative { x - TAIL } else { TAIL - x };
            }
        }
    }
}

/// A number from -1 to 1, from the bits that do not choose the layer.
#[inline(always)]
fn signed(word: u64) -> f64 {
    f64::from_bits(word >> 12 | 0x4000_0000_0000_0000) - 3.0
}

/// A number between 0 and 1, never 0.
fn unit(word: u64) -> f64 {
    ((word >> 12) as f64 + 0.5) / (1u64 << 52) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_add_up_to_the_density_and_close_at_the_top() {
        let Layers { x, f, .. } = &*TABLES;
        // Each is drawn as often, whatever its area became by rounding: at the right end of the next
        // one the density is what all up to it hold there.
        let mut density = f[1];
        for k in 1..LAYERS {
            let area = x[k] * (f[k + 1] - f[k]);
            assert!((area / AREA - 1.0).abs() < 2e-3, "{k}: {area}");
            density += (f[k + 1] - f[k]) * AREA / area;
            assert!((density / f[k + 1] - 1.0).abs() < 5e-6, "{k}: {density}");
            assert_eq!(TABLES.ends(k), [x[k], x[k + 1]]);
        }
        assert_eq!((x[LAYERS], f[LAYERS]), (0.0, 1.0));
        for x in [1e-300, 0.1, 0.7, 1.0, 1.5, 123.4] {
            assert!((ln(x) - x.ln()).abs() <= 4e-16 * x.ln().abs().max(1.0), "ln({x})");
        }
    }

    #[test]
    fn moments_and_tails_are_those_of_a_normal_distribution() {
        let mut normals = Normals::<8>::new(std::array::from_fn(|l| l as u64));
        let (mut n, mut sums, mut beyond) = (0.0, [0.0; 4], [0u64; 2]);
        for _ in 0..500_000 {
            for x in normals.next() {
                n += 1.0;
                let mut power = 1.0;
                for sum in &mut sums {
                    power *= x;
                    *sum += power;
                }
                beyond[0] += u64::from(x.abs() > 1.959_963_984_540_054);
                beyond[1] += u64::from(x.abs() > TAIL);
            }
        }
        // Five standard errors of each.
        for (k, (moment, deviation)) in
            [(0.0, 1.0), (1.0, 2.0), (0.0, 15.0), (3.0, 96.0)].into_iter().enumerate()
        {
            let found: f64 = sums[k] / n;
            let error = 5.0 * f64::sqrt(deviation / n);
            assert!((found - moment).abs() < error, "moment {}: {found}", k + 1);
        }
        let share = |count: u64| count as f64 / n;
        assert!((share(beyond[0]) - 0.05).abs() < 5.0 * f64::sqrt(0.0475 / n));
        let tail = 5.371_2e-5;
        assert!(
            (share(beyond[1]) - tail).abs() < 5.0 * f64::sqrt(tail / n),
            "{}",
            share(beyond[1])
        );
    }

    #[test]
    fn a_lane_does_not_depend_on_its_neighbours() {
        let mut together = Normals::<8>::new(std::array::from_fn(|l| 7 + l as u64));
        let mut alone = Normals::<1>::new([10]);
        for _ in 0..100_000 {
            assert_eq!(together.next()[3], alone.next()[0]);
        }
    }
}
