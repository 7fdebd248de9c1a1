//! What every law at its null, and every free curve, would explain beside a fitted drive.
//!
//! All columns of a recording stand in one matrix of products, so that the evidence of any set of
//! them is one small decomposition.

use drivescope_plant::drive::{Drive, Input};
use nalgebra::DMatrix;

use super::base::{Further, Pooled, grams, parameters, passes, terms};
use super::columns::{A_PASS, Series, Source};
use super::filter::{Tick, Track, own_states};
use super::gram::{Gram, Products, References};
use super::marginal::{Beside, Terms, coefficients, ln_mean_exp, log_evidence, standing_out};
use super::optimum::BackgroundCurve;
use super::randomness::Randomness;
use super::scene::{Recorded, Scene, longest};
use super::stepper::{Stepped, stepped};
use crate::discover::{Candidate, Curve, Scales, Trajectory, curves};

/// Standard deviations of a law's coefficients, of the balance's size.
pub(crate) const SIZES: [f64; 5] = [0.01, 0.03, 0.1, 0.3, 1.0];
/// The same of a curve's values.
const CURVE_SIZES: [f64; 5] = [0.003, 0.01, 0.03, 0.1, 0.3];

/// A law in one of its shapes, or a curve, with its columns.
#[derive(Debug, Clone)]
struct Seat {
    candidate: usize,
    variant: usize,
    columns: Vec<usize>,
}

/// What a law explains in its best shape.
#[derive(Debug, Clone)]
pub(crate) struct LawWeight {
    /// Its number in the list of candidates.
    pub(crate) candidate: usize,
    /// Its shapes, the most probable first.
    pub(crate) variants: Vec<usize>,
    /// Coefficients of the most probable shape; none where the null is infinite.
    pub(crate) coefficients: Vec<f64>,
    /// ln of the evidence over that of the base, averaged over shapes and sizes.
    pub(crate) evidence: f64,
    /// Whether the base imitates it.
    pub(crate) imitated: bool,
    /// Whether its column has a number everywhere.
    pub(crate) finite: bool,
}

/// What a curve explains.
#[derive(Debug, Clone)]
pub(crate) struct CurveWeight {
    pub(crate) curve: Curve,
    pub(crate) evidence: f64,
    /// ln of the probability of the recordings held out, given the others, over that of the base.
    pub(crate) repeats: f64,
    /// Root of its mean square, of the balance's size.
    pub(crate) size: f64,
    /// Its values at the knots, which of them were visited, and which the recordings of the fit tell
    /// beside the parameters of the base.
    pub(crate) values: Vec<f64>,
    pub(crate) visited: Vec<bool>,
    pub(crate) told: Vec<bool>,
}

/// The weights of everything.
#[derive(Debug, Clone)]
pub(crate) struct Weights {
    /// ln of the evidence of the base, in the recordings of the fit and in all.
    base: f64,
    base_of_all: f64,
    /// Most probable first.
    pub(crate) laws: Vec<LawWeight>,
    /// Most probable first.
    pub(crate) curves: Vec<CurveWeight>,
}

/// Standard deviation of a curve's value, over its largest, from which on it is not told, and the share
/// of its information that must be new beside those that are.
const TOLD: f64 = 0.1;
const NEW: f64 = 1e-3;

/// Which values are told by that information, given the others: the rest is better kept.
fn told_of(mut left: DMatrix<f64>, enough: f64) -> Vec<bool> {
    let whole = left.diagonal();
    let mut told = vec![false; whole.len()];
    loop {
        let open = (0..told.len()).filter(|k| !told[*k]);
        let Some(best) = open.max_by(|a, b| left[(*a, *a)].total_cmp(&left[(*b, *b)])) else {
            return told;
        };
        let pivot = left[(best, best)];
        // Not so, too, where the size is 0 and nothing is known.
        if !(pivot > enough.max(NEW * whole[best]) && pivot.is_finite()) {
            return told;
        }
        told[best] = true;
        let column = left.column(best).into_owned();
        left.ger(-1.0 / pivot, &column, &column, 1.0);
    }
}

/// Values of a curve.
#[derive(Debug, Clone, Default)]
struct Hats {
    size: f64,
    values: Vec<f64>,
    visited: Vec<bool>,
    told: Vec<bool>,
}

/// Share of a column's amplitude beside the base below which the base imitates it.
const IMITATED: f64 = 1e-2;

/// What is known of the variables along the tracks.
fn trajectory(it: &Recorded, track: &Track) -> Trajectory {
    let of = |value: &dyn Fn(&Tick) -> f64| track.by_sample(it.measured.len(), value);
    let force = it.drive.motor.input == Input::Force;
    Trajectory {
        current: if force { it.measured.u.clone() } else { of(&|tick| tick.filtered[0]) },
        speed: of(&|tick| tick.filtered[1]),
        position: of(&|tick| tick.filtered[2]),
        acceleration: of(&|tick| tick.acceleration(it.measured.period_s)),
    }
}

/// Laws at their nulls that share a pass, under names of their seats.
struct Passes {
    seats: Vec<Vec<(usize, usize)>>,
    names: Vec<Vec<String>>,
}

fn seat_name(place: usize) -> String {
    format!("seat {place}")
}

impl Passes {
    /// Stiff laws, laws of sensors and typed ones, which may overflow, keep to themselves, so that
    /// the rest needs no whole steps ([`passes`]).
    fn of(candidates: &[Candidate]) -> Self {
        let mut seats: Vec<Vec<(usize, usize)>> = Vec::new();
        let (mut room, mut company) = (0, usize::MAX);
        for (number, candidate) in candidates.iter().enumerate().filter(|it| it.1.is_linear()) {
            let k = candidate.coefficients.len();
            let info = candidate.info;
            let alone = info.stiff || info.senses() || info.id == "delay" || candidate.is_typed();
            let own = if alone { number } else { usize::MAX };
            for variant in 0..candidate.variants.len() {
                if room < k || own != company {
                    seats.push(Vec::new());
                    room = A_PASS;
                }
                if let Some(pass) = seats.last_mut() {
                    pass.push((number, variant));
                }
                (room, company) = (room - k, own);
            }
        }
        let of = |pass: &Vec<(usize, usize)>| {
            let one = |(place, (candidate, _)): (usize, &(usize, usize))| {
                let names = candidates[*candidate].coefficients.iter();
                names.map(move |name| format!("{}.{name}", seat_name(place))).collect::<Vec<_>>()
            };
            pass.iter().enumerate().flat_map(one).collect()
        };
        let names = seats.iter().map(of).collect();
        Self { seats, names }
    }

    fn drive(&self, pass: usize, drive: &Drive, candidates: &[Candidate]) -> Drive {
        let mut with = drive.clone();
        for (place, (candidate, variant)) in self.seats[pass].iter().enumerate() {
            let mut effect = candidates[*candidate].variants[*variant].effect.clone();
            effect.id = seat_name(place);
            with.effects.push(effect);
        }
        with
    }
}

/// The drives and series from which the columns of one recording are made.
struct Made {
    with: Vec<Drive>,
    stiff: Vec<(Drive, f64)>,
    /// The drive of the track, stepped; none where stiff laws are not weighed.
    stepped: Vec<Stepped>,
    curves: Vec<Vec<Series>>,
}

/// Size of the random load, and the time after which it forgets what it was, over those of the base,
/// with which laws and curves are weighed besides: it may have taken what they explain, and it takes
/// what stays the same by a long memory.
pub(super) const SMALLER: f64 = 0.2;
pub(super) const SHORTER: f64 = 0.2;

/// Weighs the candidates and the curves beside the scene's drive, with each of those randomnesses, of
/// which the first is its own.
///
/// `tolerated` names curves that stand in the background with a standard deviation: what the
/// formula of a named law may leave.
pub(crate) fn weigh(
    scene: &Scene,
    randomnesses: &[Randomness],
    references: &References,
    candidates: &[Candidate],
    scales: &Scales,
    tolerated: impl Fn(&Curve) -> Option<f64> + Sync,
    stopped: &(dyn Fn() -> bool + Sync),
) -> Option<Weights> {
    let (randomness, others) = randomnesses.split_first()?;
    let along = scene.tracks(randomness)?;
    let own = [randomness.scaled(SMALLER), randomness.with_time(SHORTER * randomness.load_s)];
    let others: Vec<Randomness> = own.into_iter().chain(others.iter().copied()).collect();
    let at = |other: &Randomness| scene.retraced(&along, other);
    let others: Vec<Vec<Track>> = others.iter().filter_map(at).collect();
    let mut filters = vec![along.as_slice()];
    filters.extend(others.iter().map(Vec::as_slice));
    let each =
        weigh_along((scene, &filters, references), candidates, (scales, &tolerated), stopped);
    each.into_iter().reduce(Weights::best_of)
}

fn weigh_along(
    (scene, filters, references): (&Scene, &[&[Track]], &References),
    candidates: &[Candidate],
    (scales, tolerated): (&Scales, &impl Fn(&Curve) -> Option<f64>),
    stopped: &(dyn Fn() -> bool + Sync),
) -> Vec<Weights> {
    let tracks = filters[0];
    let trajectories: Vec<Trajectory> =
        scene.recordings.iter().zip(tracks).map(|(it, track)| trajectory(it, track)).collect();
    let families = curves(&scene.drive, scales, &trajectories);
    let shared = Passes::of(candidates);
    let mut stiff: Vec<(usize, usize)> = Vec::new();
    for (number, candidate) in candidates.iter().enumerate().filter(|it| !it.1.is_linear()) {
        stiff.extend((0..candidate.variants.len()).map(|variant| (number, variant)));
    }
    let timed = |drive: Drive| {
        let longest_s = longest(&drive).min(scene.longest_s);
        (drive, longest_s)
    };
    let made: Vec<Made> = scene
        .recordings
        .iter()
        .zip(tracks)
        .zip(&trajectories)
        .map(|((it, track), trajectory)| {
            let with = |pass: usize| shared.drive(pass, &it.drive, candidates);
            let changed = |(candidate, variant): &(usize, usize)| {
                let candidate = &candidates[*candidate];
                timed(candidate.added(&it.drive, &candidate.variants[*variant]))
            };
            let step = !it.held_out && !stiff.is_empty();
            let own = own_states(&it.drive);
            let stepped = || stepped(&it.drive, &it.measured, own, scene.longest_s, &track.ticks);
            Made {
                stepped: if step { stepped() } else { Vec::new() },
                with: (0..shared.seats.len()).map(with).collect(),
                stiff: stiff.iter().map(changed).collect(),
                curves: families.iter().map(|curve| series(curve, it, track, trajectory)).collect(),
            }
        })
        .collect();
    // What stands in the background comes first, for only its products with all are known.
    let known: Vec<(usize, f64)> = families
        .iter()
        .enumerate()
        .filter_map(|(number, curve)| Some((number, tolerated(curve)?)))
        .collect();
    let is_known = |number: usize| known.iter().any(|(it, _)| *it == number);
    let mut seats = Vec::new();
    let mut background = terms(scene);
    let base = background.columns.len();
    let mut next = base;
    let mut take = |count: usize| {
        next += count;
        (next - count..next).collect::<Vec<usize>>()
    };
    for (number, sd) in &known {
        background = background.with(&take(families[*number].knots.len()), sd * sd);
    }
    for (candidate, variant) in shared.seats.iter().flatten() {
        let columns = take(candidates[*candidate].coefficients.len());
        seats.push(Seat { candidate: *candidate, variant: *variant, columns });
    }
    for (candidate, variant) in &stiff {
        seats.push(Seat { candidate: *candidate, variant: *variant, columns: take(1) });
    }
    // Columns of laws, which are judged by the recordings of the fit alone.
    let columns: usize = seats.iter().map(|seat| seat.columns.len()).sum();
    let curves: Vec<(Curve, Vec<usize>)> = families
        .iter()
        .enumerate()
        .filter(|(number, _)| !is_known(*number))
        .map(|(_, curve)| (curve.clone(), take(curve.knots.len())))
        .collect();
    let groups: Vec<usize> = seats
        .iter()
        .map(|seat| seat.columns.len())
        .chain(curves.iter().map(|(_, columns)| columns.len()))
        .collect();
    let further = |recording: usize| {
        let (made, held_out) = (&made[recording], scene.recordings[recording].held_out);
        let linear: Vec<Source<'_>> = if held_out {
            vec![Source::Nothing(columns - stiff.len())]
        } else {
            let each = made.with.iter().zip(&shared.names);
            each.flat_map(|(drive, names)| passes(drive, names)).collect()
        };
        let stiff: Vec<Source<'_>> = if made.stepped.is_empty() {
            vec![Source::Nothing(stiff.len())]
        } else {
            let own = own_states(&scene.recordings[recording].drive);
            made.stiff
                .iter()
                .map(|(of, longest_s)| Source::Difference {
                    of,
                    from: &made.stepped,
                    shared: own,
                    longest_s: *longest_s,
                })
                .collect()
        };
        let judged = made.curves.iter().enumerate().filter(|(number, _)| !is_known(*number));
        Further {
            background: known.iter().map(|(it, _)| Source::Series(&made.curves[*it])).collect(),
            judged: linear
                .into_iter()
                .chain(stiff)
                .chain(judged.map(|(_, it)| Source::Series(it)))
                .collect(),
            groups: &groups,
        }
    };
    let grams = grams(scene, filters, references, None, further, stopped);
    let with = |(grams, tracks): (&Vec<Gram>, &&[Track])| {
        let pooled = Pooled::of(grams, base, scene, references);
        let weighing = Weighing {
            fitted: pooled.sum(scene, |held_out| !held_out),
            all: pooled.sum(scene, |_| true),
            scale: &pooled.scale,
            background: background.clone(),
            parameters: parameters(scene),
        };
        let each = || scene.recordings.iter().zip(*tracks);
        let fitted = each().filter(|(it, _)| !it.held_out);
        let likelihood: f64 = fitted.map(|(_, track)| track.log_likelihood).sum();
        let all: f64 = each().map(|(_, track)| track.log_likelihood).sum();
        Weights {
            base: likelihood + log_evidence(&weighing.fitted, &weighing.background),
            base_of_all: all + log_evidence(&weighing.all, &weighing.background),
            laws: weighing.laws(candidates, &seats),
            curves: weighing.curves(curves.clone()),
        }
    };
    grams.iter().zip(filters).map(with).collect()
}

impl Weights {
    /// The curves for which the recordings held out speak too, most probable first.
    pub(crate) fn repeating(&self) -> impl Iterator<Item = &CurveWeight> {
        self.curves.iter().filter(|curve| curve.repeats > 0.0)
    }

    /// ln of the evidence of a curve in the recordings of the fit over a base at its best, that of which
    /// is given.
    pub(crate) fn beyond(&self, base: f64, curve: &CurveWeight) -> f64 {
        curve.evidence + (self.base - base).min(0.0)
    }

    /// Each law and curve where it explains more, over the base where that does.
    fn best_of(self, other: Self) -> Self {
        let base = self.base.max(other.base);
        let base_of_all = self.base_of_all.max(other.base_of_all);
        let (mine, others) = (self.base - base, other.base - base);
        let [my_rest, their_rest] = [(&self, mine), (&other, others)]
            .map(|(it, fitted)| it.base_of_all - base_of_all - fitted);
        let mut laws = self.laws;
        for law in &mut laws {
            law.evidence += mine;
            let found = other.laws.iter().find(|it| it.candidate == law.candidate);
            let more = |it: &&LawWeight| it.finite && it.evidence + others > law.evidence;
            if let Some(it) = found.filter(more) {
                *law = LawWeight { evidence: it.evidence + others, ..it.clone() };
            }
        }
        laws.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
        let mut curves = self.curves;
        for it in &mut curves {
            (it.evidence, it.repeats) = (it.evidence + mine, it.repeats + my_rest);
        }
        curves.extend(other.curves.into_iter().map(|it| CurveWeight {
            evidence: it.evidence + others,
            repeats: it.repeats + their_rest,
            ..it
        }));
        curves.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
        Self { base, base_of_all, laws, curves }
    }
}

/// A curve in the background of a scene, as large as it was found.
pub(super) fn beside(scene: &Scene, tracks: &[Track], curve: &CurveWeight) -> BackgroundCurve {
    let each = scene.recordings.iter().zip(tracks);
    let one = |(it, track)| series(&curve.curve, it, track, &trajectory(it, track));
    BackgroundCurve { series: each.map(one).collect(), sd: curve.size }
}

/// A curve's hats along a recording.
fn series(curve: &Curve, it: &Recorded, track: &Track, along: &Trajectory) -> Vec<Series> {
    let of = |values: &Vec<f64>| -> Vec<f64> {
        let at = |sample: usize| values.get(sample).copied().unwrap_or(0.0);
        track.ticks.iter().map(|tick| at(tick.sample)).collect()
    };
    let forcings = curve.forcings(&it.drive, &it.measured, along);
    let one = |it: &crate::response::Forcing| Series {
        torque: of(&it.torque),
        voltage: of(&it.voltage),
        ..Series::default()
    };
    forcings.iter().map(one).collect()
}

struct Weighing<'a> {
    fitted: Products,
    all: Products,
    scale: &'a [f64],
    background: Terms,
    /// The parameters of the base alone.
    parameters: Terms,
}

impl Weighing<'_> {
    /// ln of the evidence of columns of any of those sizes beside the background.
    fn of(&self, products: &Products, columns: &[usize], sizes: &[f64]) -> f64 {
        let with = |size: &f64| log_evidence(products, &self.background.with(columns, size * size));
        ln_mean_exp(sizes.iter().map(with))
    }

    fn laws(&self, candidates: &[Candidate], seats: &[Seat]) -> Vec<LawWeight> {
        let base = log_evidence(&self.fitted, &self.background);
        let mut found = Vec::new();
        for (number, candidate) in candidates.iter().enumerate() {
            let mut own: Vec<(&Seat, f64)> = seats
                .iter()
                .filter(|seat| seat.candidate == number)
                .map(|seat| (seat, self.of(&self.fitted, &seat.columns, &SIZES) - base))
                .collect();
            let evidence = ln_mean_exp(own.iter().map(|(_, evidence)| *evidence));
            own.sort_by(|a, b| b.1.total_cmp(&a.1));
            let Some((best, _)) = own.first() else { continue };
            let finite = best.columns.iter().all(|column| self.scale[*column] > 0.0);
            let coefficients = if candidate.is_linear() { self.coefficients(best) } else { vec![] };
            // What would need a coefficient that cannot be is no evidence for the law.
            let impossible =
                coefficients.iter().zip(&candidate.ranges).any(|(c, (low, _))| c < low);
            let evidence = if impossible { evidence.min(0.0) } else { evidence };
            found.push(LawWeight {
                candidate: number,
                variants: own.iter().map(|(seat, _)| seat.variant).collect(),
                coefficients,
                evidence,
                imitated: own.iter().all(|(seat, _)| self.imitated(&seat.columns)),
                finite,
            });
        }
        found.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
        found
    }

    /// The most probable coefficients of a law, in their own units.
    fn coefficients(&self, seat: &Seat) -> Vec<f64> {
        let terms = self.background.with(&seat.columns, 1.0);
        let mean = coefficients(&self.fitted, &terms);
        let place = self.background.columns.len();
        let one = |(k, column): (usize, &usize)| {
            mean.as_ref().map_or(0.0, |mean| mean[place + k] * self.scale[*column])
        };
        seat.columns.iter().enumerate().map(one).collect()
    }

    /// Whether nothing of a law stands out of the base's own columns.
    fn imitated(&self, columns: &[usize]) -> bool {
        let out = |column: &usize| standing_out(&self.fitted, &self.parameters, *column);
        columns.iter().all(|column| out(column) < IMITATED)
    }

    /// The most probable values of hats drawn with that standard deviation: root of their mean square,
    /// each of them in its own unit, and which are told.
    fn hats(&self, columns: &[usize], sd: f64) -> Hats {
        let terms = self.background.with(columns, sd * sd);
        let from = self.background.columns.len();
        let Some(mean) = coefficients(&self.fitted, &terms) else { return Hats::default() };
        let own = mean.rows(from, columns.len());
        let enough = 1.0 / (TOLD * own.amax()).powi(2);
        let visited = columns.iter().map(|it| self.fitted.of(*it, *it) > enough).collect();
        let told = Beside::of(&self.fitted, &self.background);
        Hats {
            size: own.norm(),
            values: (0..columns.len()).map(|k| own[k] * self.scale[columns[k]]).collect(),
            visited,
            told: told.map_or_else(
                || vec![false; columns.len()],
                |it| told_of(it.told(&self.fitted, columns).0, enough),
            ),
        }
    }

    fn curves(&self, curves: Vec<(Curve, Vec<usize>)>) -> Vec<CurveWeight> {
        let bases =
            [&self.fitted, &self.all].map(|products| log_evidence(products, &self.background));
        let mut found: Vec<CurveWeight> = curves
            .into_iter()
            .map(|(curve, columns)| {
                let [fitted, all] = [&self.fitted, &self.all]
                    .map(|products| self.of(products, &columns, &CURVE_SIZES));
                let evidence = fitted - bases[0];
                let size = CURVE_SIZES.into_iter().max_by(|a, b| {
                    let of = |size: f64| self.of(&self.fitted, &columns, &[size]);
                    of(*a).total_cmp(&of(*b))
                });
                let hats = self.hats(&columns, size.unwrap_or(CURVE_SIZES[0]));
                let repeats = all - bases[1] - evidence;
                let Hats { size, values, visited, told } = hats;
                CurveWeight { curve, evidence, repeats, size, values, visited, told }
            })
            .collect();
        found.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
        found
    }
}
