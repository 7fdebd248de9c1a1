//! How a motion stands to what should drive it: it follows, with a reversed sign, seconds off, or
//! not at all.
//!
//! The comparison is with the same recording shifted in a circle by more than the response of any
//! drive: what is explained then is chance, whatever the signals look like. Three lengths of
//! windows are looked at, for noise hides in short ones and quick motion in long ones.

use super::averaged::Averaged;
use super::shares::{Columns, Explained};

/// Windows over a recording, at most: the finest first.
pub(super) const SCALES: [usize; 3] = [2000, 400, 100];
/// Delays of sensors, filters and logs stay below this, s: what belongs together is found here.
const RESPONSE_S: f64 = 0.15;
/// Where a sign is judged, s: half a period of a fast sine is a reversed sign too.
const AT_ONCE_S: f64 = 0.01;
/// Shifts beyond this are chance, or wrong, s; and those beyond so many windows.
const SECONDS: f64 = 0.6;
const FAR_WINDOWS: f64 = 4.0;
/// Step between shifts, s: motion hardly changes within it.
const STEP_S: f64 = 0.02;
/// Shifts that tell what chance explains.
const ENOUGH: usize = 20;
/// Share of the shifts that explain more than what is called usual: the best of the few that a
/// response spans is about that good by chance.
const BEST: f64 = 0.02;
/// Explained shares: from here on a relation is plain. Friction and a rigid inertia explain more of
/// every good recording looked at but those of slow turns at one speed.
const PLAIN: f64 = 0.6;
/// Above this no shift is doubted, whatever another explains: slow motion over the angle goes with many.
const FOLLOWS: f64 = 0.7;
/// A reversed sign or another shift must leave at most this share of what is left without it.
const CLEARLY: f64 = 0.3;
/// What the signs of inertia and friction must explain themselves of it: gravity has no sign.
const SIGNED: f64 = 0.1;
/// What friction and back-EMF of the reversed sign must take of what is left beside an inertia of
/// either sign, and how many times what they take with the right one: a load that rings turns the
/// sign of the inertia near its resonance, and nothing turns that of what is lost.
const LOST: f64 = 0.1;
const LOST_TIMES: f64 = 3.0;
/// Below this, and ...
const LITTLE: f64 = 0.4;
/// ... less than this factor above what all but few shifts explain, or ...
const OF_USUAL: f64 = 2.0;
/// ... than this above the best of them, nothing is followed: it is by chance.
const OF_BEST: f64 = 1.3;
/// As little as this is chance whatever other shifts explain; and so many windows' share, which is
/// what three columns reach at the best of a few lags in white noise.
const HARDLY: f64 = 0.05;
const WINDOWS_SHARE: f64 = 15.0;
/// A speed that changes by less than this share of its root mean square asks for no torque that
/// would change with it.
const LIVELY: f64 = 0.6;
/// The same below which it is one speed: what the current does about it is what the controller
/// answers, against every disturbance, and no friction has that sign.
const ONE_SPEED: f64 = 0.1;
/// Standard deviation of a torque or current over its mean below which it mostly holds a load: what
/// it does besides may have any sign, for a load drives as well as it brakes.
const HOLDS: f64 = 0.4;

/// How a motion stands to what drives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Standing {
    Follows,
    /// With a reversed sign, which explains this share.
    Reversed(f64),
    /// It comes so many seconds late (early: below 0), which explains this share.
    Late(f64, f64),
    /// Not at all; this share is explained.
    Not(f64),
    /// Cannot be told: nothing varies, or too short.
    Untold,
}

/// What is explained over windows of one length.
struct Look {
    windows: usize,
    /// The most within the response.
    here: Explained,
    /// The most of what signed columns add within the response.
    signed_here: f64,
    at_once: Explained,
    /// Whether what is lost in friction and back-EMF has the reversed sign.
    gains: bool,
    /// Whether the motion gives more power to what drives than it takes: no sign of a controller's
    /// answer to disturbances does that.
    gives_power: bool,
    far: Option<Far>,
}

/// What is explained at shifts that are too large to be a response.
struct Far {
    /// What all but few explain less than, and the most: in all, and by the signed columns.
    whole: [f64; 2],
    signed: [f64; 2],
    /// The best of them, and by how much the motion is late there, s.
    best: Explained,
    late_s: f64,
}

impl Explained {
    fn right_whole(&self) -> f64 {
        self.free + self.right
    }

    fn reversed_whole(&self) -> f64 {
        self.free + self.reversed
    }
}

/// How the motion stands to that driver, which may be a torque (or the current that makes one);
/// `each` holds the recording at every scale, the finest first.
pub(super) fn standing<'a>(
    each: &'a [Averaged],
    is_torque: bool,
    driver: impl Fn(&'a Averaged) -> Option<&'a [f64]>,
) -> Standing {
    if is_torque && each.first().and_then(&driver).is_some_and(holds) {
        return Standing::Untold;
    }
    let looks: Vec<Look> = each.iter().filter_map(|it| Look::at(it, driver(it)?)).collect();
    let followed = looks.iter().map(|it| it.here.right_whole()).fold(0.0, f64::max);
    let best_of = |it: &Look| {
        let far = it.far.as_ref().map_or(0.0, |far| far.best.right_whole());
        it.here.right_whole().max(it.at_once.reversed_whole()).max(far)
    };
    let changes = |limit: f64| each.last().is_some_and(|it| it.changes_by(limit));
    match looks.iter().find(|it| best_of(it) >= PLAIN).map(Look::stands) {
        Some(Standing::Reversed(_)) if !changes(ONE_SPEED) => return Standing::Untold,
        Some(wrong @ (Standing::Reversed(_) | Standing::Late(..))) => return wrong,
        _ => {}
    }
    let by_chance = |it: &Look| {
        let hardly = (WINDOWS_SHARE / it.windows as f64).max(HARDLY);
        let chance = |share: f64, [usual, best]: [f64; 2]| {
            share < (OF_USUAL * usual).max(OF_BEST * best).max(hardly)
        };
        it.far.as_ref().is_some_and(|far| {
            chance(it.here.right_whole(), far.whole) && chance(it.signed_here, far.signed)
        })
    };
    match looks.is_empty() {
        true => Standing::Untold,
        false if followed < LITTLE && changes(LIVELY) && looks.iter().all(by_chance) => {
            Standing::Not(followed)
        }
        false if looks.iter().all(|it| it.far.is_none()) => Standing::Untold,
        false => Standing::Follows,
    }
}

/// Whether a torque mostly holds a load.
fn holds(torque: &[f64]) -> bool {
    let [mean, square] = moments(torque);
    square - mean * mean < (HOLDS * mean).powi(2)
}

/// Mean and mean square.
fn moments(values: &[f64]) -> [f64; 2] {
    let n = values.len() as f64;
    [values.iter().sum::<f64>() / n, values.iter().map(|it| it * it).sum::<f64>() / n]
}

impl Averaged {
    /// Whether the speed changes by more than that share of its root mean square; over long windows,
    /// in which the noise of a speed from differences is small.
    fn changes_by(&self, limit: f64) -> bool {
        let [mean, square] = moments(&self.speed);
        square - mean * mean > limit * limit * square
    }

    /// The columns of the balance; the inertia's of either sign where it is `free`.
    fn columns(&self, free_inertia: bool) -> Columns {
        let slow = super::motion::SLOW * self.greatest_speed();
        let sign = |speed: &f64| match speed.hypot(slow) {
            0.0 => 0.0,
            magnitude => speed / magnitude,
        };
        let signs = self.speed.iter().map(sign).collect();
        let [sines, cosines] =
            [f64::sin, f64::cos].map(|of| self.angle.iter().map(|angle| of(*angle)).collect());
        let free = [sines, cosines].into_iter().chain(self.load.clone());
        let (inertia, lost) = (self.acceleration.clone(), vec![self.speed.clone(), signs]);
        match free_inertia {
            true => Columns::new(lost, free.chain([inertia]).collect()),
            false => Columns::new([vec![inertia], lost].concat(), free.collect()),
        }
    }
}

impl Look {
    /// None where the driver does not change.
    fn at(averaged: &Averaged, driver: &[f64]) -> Option<Self> {
        let n = driver.len();
        let [mean, _] = moments(driver);
        let y: Vec<f64> = driver.iter().map(|value| value - mean).collect();
        let squares: f64 = y.iter().map(|value| value * value).sum();
        if squares <= n as f64 * (1e-9 * mean).powi(2) {
            return None;
        }
        let columns = averaged.columns(false);
        let explained = |lag: isize| columns.explained(&y, squares, lag);
        let window_s = averaged.window_s;
        let within = |seconds: f64| {
            let lags = ((seconds / window_s).floor() as isize).max(1).min(n as isize / 2);
            (-lags..=lags).map(explained).collect::<Vec<_>>()
        };
        let most = |of: fn(&Explained) -> f64, all: &[Explained]| {
            all.iter().copied().max_by(|a, b| of(a).total_cmp(&of(b))).unwrap_or_default()
        };
        let near = within(RESPONSE_S);
        let here = most(Explained::right_whole, &near);
        let at_once = within(AT_ONCE_S);
        let reversed = most(Explained::reversed_whole, &at_once);
        let plain = most(Explained::right_whole, &at_once);
        // The two best are not those of one lag: what each leaves is compared.
        let at_once = Explained {
            free: reversed.free,
            right: plain.right_whole() - reversed.free,
            reversed: reversed.reversed,
        };
        let lost = averaged.columns(true).explained(&y, squares, 0);
        let gains =
            lost.reversed >= LOST * (1.0 - lost.free) && lost.reversed >= LOST_TIMES * lost.right;
        let gives_power =
            driver.iter().zip(&averaged.speed).map(|(driver, speed)| driver * speed).sum::<f64>()
                < 0.0;
        let first = (SECONDS / window_s).max(FAR_WINDOWS).ceil() as isize;
        let step = ((STEP_S / window_s) as isize).max(1);
        let half = n as isize / 2;
        let lags = (first..half).step_by(step as usize).flat_map(|lag| [lag, -lag]);
        let far: Vec<(isize, Explained)> = lags.map(|lag| (lag, explained(lag))).collect();
        let signed_here = most(|it| it.right, &near).right;
        let far = Far::of(&far, window_s);
        Some(Self { windows: n, here, signed_here, at_once, gains, gives_power, far })
    }

    /// Of a relation that is plain with one sign and shift.
    fn stands(&self) -> Standing {
        let remainder = 1.0 - self.at_once.right_whole();
        let reversed = self.at_once.reversed_whole();
        let far = self.far.as_ref().map(|far| (far.best.right_whole(), far));
        let late = far.filter(|(whole, far)| {
            let here = self.here.right_whole();
            let clear = 1.0 - whole <= CLEARLY * (1.0 - here) && far.best.right >= SIGNED;
            here < FOLLOWS && *whole >= PLAIN && clear
        });
        let is_reversed = reversed >= PLAIN
            && 1.0 - reversed <= CLEARLY * remainder
            && self.at_once.reversed >= SIGNED
            && self.gains
            && self.gives_power;
        match late {
            // A sine that is half a period late is reversed too.
            Some((whole, far)) if !is_reversed || 1.0 - whole <= CLEARLY * (1.0 - reversed) => {
                Standing::Late(far.late_s, whole)
            }
            _ if is_reversed => Standing::Reversed(reversed),
            _ => Standing::Follows,
        }
    }
}

impl Far {
    /// None where there are too few shifts.
    fn of(all: &[(isize, Explained)], window_s: f64) -> Option<Self> {
        if all.len() < ENOUGH {
            return None;
        }
        let usual = |of: fn(&Explained) -> f64| {
            let mut values: Vec<f64> = all.iter().map(|(_, it)| of(it)).collect();
            let at = values.len() - 1 - (BEST * values.len() as f64) as usize;
            values.sort_by(f64::total_cmp);
            [values[at], values[values.len() - 1]]
        };
        let best = all.iter().max_by(|a, b| a.1.right_whole().total_cmp(&b.1.right_whole()))?;
        Some(Self {
            whole: usual(Explained::right_whole),
            signed: usual(|it| it.right),
            best: best.1,
            late_s: -(best.0 as f64) * window_s,
        })
    }
}
