//! Products of whitened columns: all that the evidence of a law or a curve beside the base needs.

use std::ops::Range;

use drivescope_numerics::dispatch::{Work, widest};
use drivescope_plant::drive::{Drive, Input};
use drivescope_plant::model::{CURRENT, SPEED};
use nalgebra::{DMatrix, DMatrixView, Dyn};
use rayon::prelude::*;

use super::columns::{Pass, Source};
use super::direction::Direction;
use super::rows::{LANES, Row};
use super::share::Share;
use super::state::{LOAD, SENSORS, VOLTAGE, Vector};
use super::track::{Tick, Track};
use crate::measured::Measured;

/// A matrix whose rows and columns are exchanged.
type Transposed<'a> = DMatrixView<'a, f64, Dyn, Dyn>;

/// Ticks of a block.
const BLOCK: usize = 512;

/// What a balance and a sensor have in size: a share of one is as large as what is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct References {
    /// N m (N).
    pub(crate) torque: f64,
    /// V.
    pub(crate) voltage: f64,
    /// In each sensor's unit.
    pub(crate) shown: [f64; SENSORS],
}

/// What a torque and a voltage do to the next state of a shaft that slips.
#[derive(Debug, Clone, Copy)]
struct Yield {
    speed_of_torque: f64,
    speed_of_voltage: f64,
    current_of_voltage: f64,
    /// Which sensors were read.
    read: [bool; SENSORS],
}

impl Yield {
    fn of(track: &Track, drive: &Drive) -> Self {
        let column = |place: usize| track.steps.iter().map(move |it| it.transition.column(place));
        let freest = |a: &(Vector, Vector), b: &(Vector, Vector)| a.0[SPEED].total_cmp(&b.0[SPEED]);
        let free = column(LOAD).zip(column(VOLTAGE)).max_by(freest);
        let (torque, voltage) = free.unwrap_or_default();
        let inductance = drive.motor.l.unwrap_or(1.0);
        let electrical = if drive.motor.input == Input::Voltage { 1.0 / inductance } else { 0.0 };
        Self {
            speed_of_torque: torque[SPEED] / drive.motor.j,
            speed_of_voltage: electrical * voltage[SPEED],
            current_of_voltage: electrical * voltage[CURRENT],
            read: std::array::from_fn(|it| {
                track.ticks.iter().any(|tick| tick.inverse_sd[it] > 0.0)
            }),
        }
    }

    /// Adds the squares of the sizes of shares: as the torque and the voltage that would do the
    /// same, and in what the sensors show.
    fn add_sizes(&self, share: &Share, references: &References, sizes: &mut Row) {
        let over = |a: f64, b: f64| if b == 0.0 { 0.0 } else { a / b };
        let of_current = over(1.0, self.current_of_voltage);
        let of_speed = over(1.0, self.speed_of_torque) / references.torque;
        let (current, speed) = (&share.state[CURRENT], &share.state[SPEED]);
        for (lane, size) in sizes.iter_mut().enumerate() {
            let voltage = current[lane] * of_current;
            let torque = (speed[lane] - self.speed_of_voltage * voltage) * of_speed;
            let voltage = voltage / references.voltage;
            *size += torque * torque + voltage * voltage;
        }
        for sensor in (0..SENSORS).filter(|it| self.read[*it]) {
            for (size, shown) in sizes.iter_mut().zip(&share.shown[sensor]) {
                let shown = shown / references.shown[sensor];
                *size += shown * shown;
            }
        }
    }
}

/// Products of columns: those of the background with all, and those of each further group among
/// themselves. The data are the last column.
#[derive(Debug, Clone)]
pub(crate) struct Products {
    /// Rows: the background's columns, then the data.
    with_background: DMatrix<f64>,
    /// Each further group, by the range of its columns.
    own: Vec<(Range<usize>, DMatrix<f64>)>,
}

impl Products {
    /// Of rows that are whitened: columns of the background, further ones in groups of so many, and
    /// the data.
    pub(super) fn of_rows(
        background: &DMatrix<f64>,
        judged: &DMatrix<f64>,
        groups: &[usize],
        data: &DMatrix<f64>,
    ) -> Self {
        let (known, count) = (background.ncols(), judged.ncols());
        let mut with_background = DMatrix::zeros(known + 1, known + count + 1);
        for (rows, row) in [(background, 0), (data, known)] {
            let height = rows.ncols();
            for (columns, column) in [(background, 0), (judged, known), (data, known + count)] {
                let shape = (height, columns.ncols());
                with_background
                    .view_mut((row, column), shape)
                    .copy_from(&(rows.transpose() * columns));
            }
        }
        let mut from = 0;
        let own = groups.iter().map(|count| {
            from += count;
            let columns = judged.columns(from - count, *count);
            (known + from - count..known + from, columns.transpose() * columns)
        });
        Self { with_background, own: own.collect() }
    }

    /// The number of the data among the columns.
    pub(crate) fn data(&self) -> usize {
        self.with_background.ncols() - 1
    }

    /// Columns of the background.
    pub(crate) fn background(&self) -> usize {
        self.with_background.nrows() - 1
    }

    /// The product of two columns, at least one of them of the background or the data, or both of
    /// one group.
    pub(crate) fn of(&self, a: usize, b: usize) -> f64 {
        let (background, data) = (self.background(), self.data());
        let row = |column: usize| match column {
            column if column == data => Some(background),
            column => (column < background).then_some(column),
        };
        if let Some(row) = row(a) {
            return self.with_background[(row, b)];
        }
        if let Some(row) = row(b) {
            return self.with_background[(row, a)];
        }
        let group = self.own.partition_point(|(group, _)| group.end <= a);
        let (group, products) = &self.own[group];
        products[(a - group.start, b - group.start)]
    }

    /// The same with every column times its factor, the data's 1.
    pub(crate) fn scaled(&self, scale: &[f64]) -> Self {
        let (background, data) = (self.background(), self.data());
        let of = |row: usize| if row == background { scale[data] } else { scale[row] };
        let finite = |value: f64| if value.is_finite() { value } else { 0.0 };
        let mut scaled = self.clone();
        for ((row, column), value) in indexed(&mut scaled.with_background) {
            *value = finite(*value * of(row) * scale[column]);
        }
        for (group, products) in &mut scaled.own {
            let first = group.start;
            for ((row, column), value) in indexed(products) {
                *value = finite(*value * scale[first + row] * scale[first + column]);
            }
        }
        scaled
    }

    /// Both together.
    pub(crate) fn and(mut self, other: &Self) -> Self {
        self.with_background += &other.with_background;
        for ((_, own), (_, others)) in self.own.iter_mut().zip(&other.own) {
            *own += others;
        }
        self
    }

    /// The data with the sum of columns of the background added, and by how much -y'y/2 changes.
    pub(crate) fn shifted(&self, values: &[f64]) -> (Self, f64) {
        let (background, data) = (self.background(), self.data());
        let mut moved = self.clone();
        let mut change = 0.0;
        for (place, value) in values.iter().enumerate().filter(|(_, value)| **value != 0.0) {
            change -= value * self.of(place, data);
            for column in 0..data {
                moved.with_background[(background, column)] += value * self.of(place, column);
            }
            for (other, with) in values.iter().enumerate() {
                change -= 0.5 * value * with * self.of(place, other);
            }
        }
        for row in 0..background {
            moved.with_background[(row, data)] = moved.with_background[(background, row)];
        }
        (moved, change)
    }
}

fn indexed(matrix: &mut DMatrix<f64>) -> impl Iterator<Item = ((usize, usize), &mut f64)> {
    let rows = matrix.nrows();
    matrix.iter_mut().enumerate().map(move |(k, value)| ((k % rows, k / rows), value))
}

/// Products of the columns of one recording, and the size of each column.
#[derive(Debug, Clone)]
pub(crate) struct Gram {
    pub(crate) products: Products,
    /// Mean squares of each column's share in units of [`References`], over the samples.
    pub(crate) size: Vec<f64>,
    pub(crate) samples: usize,
}

/// Products so far of the columns of a source under one of the filters.
#[derive(Clone)]
struct Multiplied {
    with_background: DMatrix<f64>,
    /// Of each column with those that stand so many places behind it, as far as a group reaches: of
    /// small groups that is less than all, and goes over the columns as they lie in memory.
    apart: Vec<Vec<f64>>,
}

impl Multiplied {
    /// Adds the products of `count` columns with the background and with each other.
    fn add(&mut self, block: &[f64], count: usize, background: &DMatrix<f64>) {
        let width = background.ncols();
        let columns = Transposed::from_slice_with_strides(block, width, count, count, 1);
        self.with_background.gemm(1.0, background, &columns, 1.0);
        widest(OfNeighbours { block, count, apart: &mut self.apart });
    }
}

/// Adds to the products of each column with those so many places behind it.
struct OfNeighbours<'a> {
    block: &'a [f64],
    count: usize,
    apart: &'a mut [Vec<f64>],
}

impl Work for OfNeighbours<'_> {
    #[inline(always)]
    fn run(self) {
        for row in self.block.chunks_exact(self.count) {
            for (places, products) in self.apart.iter_mut().enumerate() {
                for ((product, a), b) in products.iter_mut().zip(row).zip(&row[places..]) {
                    *product += a * b;
                }
            }
        }
    }
}

/// The columns of a source on their way along a track, under each of the filters.
struct Judged<'a> {
    pass: Pass<'a>,
    /// The groups of its columns, counted from its first.
    groups: Vec<Range<usize>>,
    /// Sums of the squares of the sizes of its columns.
    sizes: Vec<Row>,
    /// Its whitened columns along a few ticks, the values of a sensor one after the other.
    blocks: Vec<Vec<f64>>,
    products: Vec<Multiplied>,
}

impl<'a> Judged<'a> {
    fn new(
        drive: &Drive,
        recording: (&'a Measured, &'a Direction),
        source: Source<'a>,
        (background, filters): (usize, usize),
    ) -> Self {
        let pass = Pass::new(drive, recording, source);
        let with_background = DMatrix::zeros(background + 1, pass.len());
        let products = vec![Multiplied { with_background, apart: Vec::new() }; filters];
        let sizes = vec![[0.0; LANES]; pass.len().div_ceil(LANES)];
        Self { pass, groups: Vec::new(), sizes, blocks: vec![Vec::new(); filters], products }
    }

    fn fill(&mut self, along: &Along<'_>, ticks: Range<usize>, width: usize) {
        let Self { pass, sizes, blocks, .. } = self;
        for block in blocks.iter_mut() {
            block.resize(pass.len() * width, 0.0);
        }
        pass.fill(along.tracks, ticks, blocks, |shares| {
            for (share, sizes) in shares.iter().zip(sizes.iter_mut()) {
                along.yields.add_sizes(share, along.references, sizes);
            }
        });
    }

    fn multiply(&mut self, backgrounds: &[DMatrix<f64>]) {
        if self.pass.is_nothing() {
            return;
        }
        let each = self.products.iter_mut().zip(&self.blocks).zip(backgrounds);
        for ((products, block), background) in each {
            products.add(block, self.pass.len(), background);
        }
    }
}

/// A recording under one filter or several that were linearised along the first one's track, and in
/// which units the columns' sizes are.
struct Along<'a> {
    tracks: &'a [&'a Track],
    yields: Yield,
    references: &'a References,
}

/// The products of the columns of those sources under each of the filters, in their order; those of
/// the first ones are the background, each of the others is made of groups of so many columns.
pub(crate) fn gram<'a>(
    drive: &Drive,
    recording: (&'a Measured, &'a Direction),
    tracks: &[&Track],
    references: &References,
    (background, others): (&[Source<'a>], &[Source<'a>]),
    groups: &[usize],
    stopped: &(dyn Fn() -> bool + Sync),
) -> Vec<Gram> {
    let along = Along { tracks, yields: Yield::of(tracks[0], drive), references };
    let known: usize = background.iter().map(Source::len).sum();
    let new = |source: &Source<'a>| Judged::new(drive, recording, *source, (known, tracks.len()));
    let mut base: Vec<Judged<'a>> = background.iter().map(new).collect();
    let mut others: Vec<Judged<'a>> = others.iter().map(new).collect();
    group(&mut others, groups);
    let mut of_background = vec![DMatrix::zeros(known + 1, known + 1); tracks.len()];
    let measured_in = |tick: &Tick| tick.inverse_sd.iter().filter(|it| **it > 0.0).count();
    let count = tracks[0].ticks.len();
    for from in (0..count).step_by(BLOCK) {
        if stopped() {
            break;
        }
        let ticks = from..(from + BLOCK).min(count);
        let width: usize = tracks[0].ticks[ticks.clone()].iter().map(measured_in).sum();
        base.par_iter_mut().for_each(|one| one.fill(&along, ticks.clone(), width));
        let rows: Vec<DMatrix<f64>> = (0..tracks.len())
            .map(|filter| {
                let mut rows = DMatrix::zeros(known + 1, width);
                let mut first = 0;
                for one in &base {
                    let count = one.pass.len();
                    let block = DMatrixView::from_slice(&one.blocks[filter], count, width);
                    rows.rows_mut(first, count).copy_from(&block);
                    first += count;
                }
                let innovations = tracks[filter].ticks[ticks.clone()].iter().flat_map(|tick| {
                    let read = (0..SENSORS).filter(|it| tick.inverse_sd[*it] > 0.0);
                    read.map(|it| tick.innovation[it])
                });
                for (column, value) in innovations.enumerate() {
                    rows[(known, column)] = value;
                }
                rows
            })
            .collect();
        for (products, rows) in of_background.iter_mut().zip(&rows) {
            products.gemm(1.0, rows, &rows.transpose(), 1.0);
        }
        others.par_iter_mut().for_each(|one| {
            one.fill(&along, ticks.clone(), width);
            one.multiply(&rows);
        });
    }
    let one = |(filter, products): (usize, DMatrix<f64>)| {
        Gram::of((&base, &others), filter, &products, count)
    };
    of_background.into_iter().enumerate().map(one).collect()
}

/// Tells each of the sources which groups its columns are.
fn group(others: &mut [Judged<'_>], groups: &[usize]) {
    let mut counts = groups.iter();
    for one in others {
        let (columns, mut next) = (one.pass.len(), 0);
        while next < columns {
            let Some(count) = counts.next() else { return };
            one.groups.push(next..next + count);
            next += count;
        }
        debug_assert_eq!(next, columns, "a group has one source");
        let reach = one.groups.iter().map(Range::len).max().unwrap_or(0);
        for products in &mut one.products {
            products.apart = (0..reach).map(|places| vec![0.0; columns - places]).collect();
        }
    }
}

impl Gram {
    fn of(
        (base, others): (&[Judged<'_>], &[Judged<'_>]),
        filter: usize,
        of_background: &DMatrix<f64>,
        samples: usize,
    ) -> Self {
        let known = of_background.nrows() - 1;
        let count: usize = known + others.iter().map(|one| one.pass.len()).sum::<usize>();
        let mut with_background = DMatrix::zeros(known + 1, count + 1);
        with_background.columns_mut(0, known).copy_from(&of_background.columns(0, known));
        with_background.column_mut(count).copy_from(&of_background.column(known));
        let sizes = base.iter().chain(others).flat_map(|one| {
            one.sizes.iter().flatten().take(one.pass.len()).map(|sum| sum / samples.max(1) as f64)
        });
        let (mut own, mut first) = (Vec::new(), known);
        for one in others {
            let count = one.pass.len();
            let products = &one.products[filter];
            with_background.columns_mut(first, count).copy_from(&products.with_background);
            let of_group = |group: &Range<usize>| {
                let of = |a: usize, b: usize| products.apart[a.abs_diff(b)][group.start + a.min(b)];
                let own = DMatrix::from_fn(group.len(), group.len(), of);
                (first + group.start..first + group.end, own)
            };
            own.extend(one.groups.iter().map(of_group));
            first += count;
        }
        Self { products: Products { with_background, own }, size: sizes.collect(), samples }
    }
}
