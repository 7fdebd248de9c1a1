//! Products of whitened columns: all that the evidence of a law or a curve beside the base needs.

use std::ops::Range;

use drivescope_plant::drive::{Drive, Input};
use nalgebra::DMatrix;
use rayon::prelude::*;

use super::columns::{Pass, Share, Source};
use super::direction::Direction;
use super::filter::{LOAD, SENSORS, Tick, Track, VOLTAGE};
use crate::measured::Measured;

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
        let by = |tick: &Tick, row: usize, column: usize| tick.transition[(row, column)];
        let free = track.ticks.iter().max_by(|a, b| by(a, 1, LOAD).total_cmp(&by(b, 1, LOAD)));
        let at = |row: usize, column: usize| free.map_or(0.0, |tick| by(tick, row, column));
        let inductance = drive.motor.l.unwrap_or(1.0);
        let electrical = if drive.motor.input == Input::Voltage { 1.0 / inductance } else { 0.0 };
        Self {
            speed_of_torque: at(1, LOAD) / drive.motor.j,
            speed_of_voltage: electrical * at(1, VOLTAGE),
            current_of_voltage: electrical * at(0, VOLTAGE),
            read: std::array::from_fn(|it| {
                track.ticks.iter().any(|tick| tick.inverse_sd[it] > 0.0)
            }),
        }
    }

    /// Square of the size of a share: as the torque and the voltage that would do the same, and in
    /// what the sensors show.
    fn size(&self, share: &Share, references: &References) -> f64 {
        let over = |a: f64, b: f64| if b == 0.0 { 0.0 } else { a / b };
        let voltage = over(share.state[0], self.current_of_voltage);
        let torque = over(share.state[1] - self.speed_of_voltage * voltage, self.speed_of_torque);
        let read = (0..SENSORS).filter(|it| self.read[*it]);
        let shown = read.map(|it| (share.shown[it] / references.shown[it]).powi(2));
        (torque / references.torque).powi(2)
            + (voltage / references.voltage).powi(2)
            + shown.sum::<f64>()
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
    fn zeros(background: usize, groups: &[Range<usize>]) -> Self {
        let all = groups.last().map_or(background, |last| last.end);
        let square =
            |group: &Range<usize>| (group.clone(), DMatrix::zeros(group.len(), group.len()));
        Self {
            with_background: DMatrix::zeros(background + 1, all + 1),
            own: groups.iter().map(square).collect(),
        }
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

    fn add(&mut self, block: &DMatrix<f64>) {
        let background = self.background();
        let data = block.nrows() - 1;
        let mut rows = DMatrix::zeros(background + 1, block.ncols());
        rows.rows_mut(0, background).copy_from(&block.rows(0, background));
        rows.row_mut(background).copy_from(&block.row(data));
        self.with_background.gemm(1.0, &rows, &block.transpose(), 1.0);
        for (group, products) in &mut self.own {
            let own = block.rows(group.start, group.len()).into_owned();
            products.gemm(1.0, &own, &own.transpose(), 1.0);
        }
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

/// The products of the columns of those sources, in their order; those of the first `background`
/// sources are the background, each other source is a group of `groups` in turn.
pub(crate) fn gram<'a>(
    drive: &Drive,
    recording: (&'a Measured, &'a Direction),
    track: &Track,
    references: &References,
    (background, others): (&[Source<'a>], &[Source<'a>]),
    groups: &dyn Fn(usize, usize) -> Vec<Range<usize>>,
    stopped: &(dyn Fn() -> bool + Sync),
) -> Gram {
    let yields = Yield::of(track, drive);
    let make = |source: &Source<'a>| {
        let pass = Pass::new(drive, recording, *source);
        let size = vec![0.0; pass.len()];
        (pass, size)
    };
    let mut passes: Vec<(Pass<'a>, Vec<f64>)> = background.iter().chain(others).map(make).collect();
    let known = passes[..background.len()].iter().map(|(pass, _)| pass.len()).sum();
    let count: usize = passes.iter().map(|(pass, _)| pass.len()).sum();
    let mut products = Products::zeros(known, &groups(known, count));
    for (number, ticks) in track.ticks.chunks(BLOCK).enumerate() {
        if stopped() {
            break;
        }
        let measured_in = |tick: &Tick| tick.inverse_sd.iter().filter(|it| **it > 0.0).count();
        let width: usize = ticks.iter().map(measured_in).sum();
        let blocks: Vec<DMatrix<f64>> = passes
            .par_iter_mut()
            .map(|(pass, size)| {
                let mut block = DMatrix::zeros(pass.len(), width);
                pass.fill(ticks, number * BLOCK, &mut block, |shares| {
                    for (share, size) in shares.iter().zip(size.iter_mut()) {
                        *size += yields.size(share, references);
                    }
                });
                block
            })
            .collect();
        let mut all = DMatrix::zeros(count + 1, width);
        let mut first = 0;
        for block in &blocks {
            all.rows_mut(first, block.nrows()).copy_from(block);
            first += block.nrows();
        }
        let data = ticks.iter().flat_map(|tick| {
            (0..SENSORS).filter(|it| tick.inverse_sd[*it] > 0.0).map(|it| tick.innovation[it])
        });
        for (column, value) in data.enumerate() {
            all[(count, column)] = value;
        }
        products.add(&all);
    }
    let samples = track.ticks.len();
    let size = passes.into_iter().flat_map(|(_, size)| size);
    let size = size.map(|sum| sum / samples.max(1) as f64).collect();
    Gram { products, size, samples }
}
