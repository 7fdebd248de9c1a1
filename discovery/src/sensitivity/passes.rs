//! The passes of [`super`]: runs over duals, each for a few directions.

use drivescope_numerics::Dual;
use nalgebra::DMatrix;

use super::{Direction, Rows};
use crate::case::Case;
use crate::run::Runner;
use crate::start::Start;

/// Directions of a wide and of a narrow pass.
const WIDE: usize = 8;
const NARROW: usize = 4;
/// A start is forgotten when its columns fall below this share of their largest: they decay, so
/// nothing that adds up over a recording is lost.
const FORGOTTEN: f64 = 1e-9;
/// Samples between two looks at that.
const LOOK: usize = 64;

/// A run over plain numbers or duals that knows a part of a block.
pub(crate) trait Pass: Send {
    /// Runs over the samples, at which that many values were measured.
    fn part(&mut self, case: &Case<'_>, samples: &[usize], values: usize) -> Part;
}

/// What one pass knows of a block.
pub(crate) struct Part {
    /// Residuals, if it is the pass that tells them.
    residual: Option<Vec<f64>>,
    /// Numbers of its directions, and a row each.
    numbers: Vec<usize>,
    columns: DMatrix<f64>,
}

impl Part {
    fn new(numbers: Vec<usize>, values: usize, leads: bool) -> Self {
        let columns = DMatrix::zeros(numbers.len(), values);
        Self { residual: leads.then(|| vec![0.0; values]), numbers, columns }
    }

    /// Puts it where it belongs.
    pub(crate) fn put(self, rows: &mut Rows) {
        if let Some(residual) = self.residual {
            rows.residual = residual;
        }
        for (row, number) in self.columns.row_iter().zip(self.numbers) {
            rows.columns.row_mut(number).copy_from(&row);
        }
    }
}

/// The run over plain numbers: it knows the residuals.
struct Values<'a>(Runner<'a, f64>);

impl Pass for Values<'_> {
    fn part(&mut self, case: &Case<'_>, samples: &[usize], values: usize) -> Part {
        let mut residual = Vec::with_capacity(values);
        for &k in samples {
            let now = self.0.sample(k, [0.0; 2]);
            for (channel, sd) in case.measured.outputs.iter().zip(case.noise) {
                if channel.values[k].is_finite() {
                    let v = now[channel.output as usize];
                    residual.push((channel.values[k] - v) / sd);
                }
            }
        }
        Part { residual: Some(residual), ..Part::new(Vec::new(), values, false) }
    }
}

/// A direction with its number.
type Numbered<'a> = (usize, &'a Direction<'a>);

/// A pass of up to `P` directions.
struct Duals<'a, const P: usize> {
    directions: Vec<Numbered<'a>>,
    runner: Runner<'a, Dual<P>>,
    /// Whether it writes the residuals too.
    leads: bool,
    /// For starts of one piece, which a stable drive forgets.
    fading: Option<Fading>,
}

/// What is left of the derivatives by the start of a piece.
struct Fading {
    piece: std::ops::Range<usize>,
    /// Largest column so far, and since the last look.
    largest: f64,
    recent: f64,
    over: bool,
}

impl Fading {
    /// Whether there is nothing to compute at sample `k`.
    fn is_over(&mut self, k: usize) -> bool {
        if !self.piece.contains(&k) {
            return true;
        }
        if (k - self.piece.start) % LOOK == LOOK - 1 {
            self.over |= self.recent <= FORGOTTEN * self.largest;
            self.recent = 0.0;
        }
        self.over
    }

    fn see(&mut self, column: f64) {
        self.recent = self.recent.max(column.abs());
        self.largest = self.largest.max(column.abs());
    }
}

impl<'a, const P: usize> Duals<'a, P> {
    fn new(case: &Case<'a>, directions: Vec<Numbered<'a>>, leads: bool) -> Self {
        let slot = |wanted: Direction<'_>| directions.iter().position(|(_, it)| **it == wanted);
        let dual = |value: f64, slot: Option<usize>| {
            slot.map_or(Dual { v: value, d: [0.0; P] }, |k| Dual::parameter(value, k))
        };
        let start = |(piece, start): (usize, &Start)| {
            let values = start.values();
            let of = |state| dual(values[state], slot(Direction::Start { piece, state }));
            std::array::from_fn(of)
        };
        let starts = case.starts.iter().enumerate().map(start).collect();
        let parameter = |name: &str, value| dual(value, slot(Direction::Parameter(name)));
        let mut runner = Runner::new(case, starts, parameter);
        let fading = only_piece(&directions).filter(|_| !leads).map(|piece| {
            runner.skip_to(piece);
            let piece = case.measured.pieces[piece].clone();
            Fading { piece, largest: 0.0, recent: 0.0, over: false }
        });
        Self { directions, runner, leads, fading }
    }

    /// What is added to the balances over a sample.
    fn added(&self, k: usize) -> [Dual<P>; 2] {
        let mut added = [Dual { v: 0.0, d: [0.0; P] }; 2];
        for (slot, (_, direction)) in self.directions.iter().enumerate() {
            match direction {
                Direction::Torque(series) => added[0].d[slot] = series[k],
                Direction::Voltage(series) => added[1].d[slot] = series[k],
                Direction::Parameter(_) | Direction::Start { .. } => {}
            }
        }
        added
    }
}

/// The piece whose starts these directions are, if they are nothing else.
fn only_piece(directions: &[Numbered<'_>]) -> Option<usize> {
    let piece = |(_, it): &Numbered<'_>| match it {
        Direction::Start { piece, .. } => Some(*piece),
        _ => None,
    };
    let first = piece(directions.first()?)?;
    directions.iter().all(|it| piece(it) == Some(first)).then_some(first)
}

impl<const P: usize> Pass for Duals<'_, P> {
    fn part(&mut self, case: &Case<'_>, samples: &[usize], values: usize) -> Part {
        let outputs = &case.measured.outputs;
        let numbers = self.directions.iter().map(|(number, _)| *number).collect();
        let mut part = Part::new(numbers, values, self.leads);
        let mut row = 0;
        for &k in samples {
            if self.fading.as_mut().is_some_and(|fading| fading.is_over(k)) {
                row += outputs.iter().filter(|channel| channel.values[k].is_finite()).count();
                continue;
            }
            let now = self.runner.sample(k, self.added(k));
            for (channel, sd) in outputs.iter().zip(case.noise) {
                let y = channel.values[k];
                if !y.is_finite() {
                    continue;
                }
                let Dual { v, d } = now[channel.output as usize];
                if let Some(residual) = &mut part.residual {
                    residual[row] = (y - v) / sd;
                }
                for slot in 0..self.directions.len() {
                    let column = d[slot] / sd;
                    part.columns[(slot, row)] = column;
                    if let Some(fading) = &mut self.fading {
                        fading.see(column);
                    }
                }
                row += 1;
            }
        }
        part
    }
}

/// The passes that together know the residuals and every column.
pub(crate) fn passes<'a>(
    case: &Case<'a>,
    directions: &'a [Direction<'a>],
) -> Vec<Box<dyn Pass + 'a>> {
    let (mut starts, mut others) = (vec![Vec::new(); case.measured.pieces.len()], Vec::new());
    for (number, direction) in directions.iter().enumerate() {
        match direction {
            Direction::Start { piece, .. } => starts[*piece].push((number, direction)),
            _ => others.push((number, direction)),
        }
    }
    let mut passes: Vec<Box<dyn Pass + 'a>> = Vec::new();
    for some in others.chunks(WIDE) {
        let leads = passes.is_empty();
        passes.push(if some.len() > NARROW {
            Box::new(Duals::<WIDE>::new(case, some.to_vec(), leads))
        } else {
            Box::new(Duals::<NARROW>::new(case, some.to_vec(), leads))
        });
    }
    if passes.is_empty() {
        passes.push(Box::new(Values(Runner::of_values(case))));
    }
    for some in starts.iter().flat_map(|of_piece| of_piece.chunks(NARROW)) {
        passes.push(Box::new(Duals::<NARROW>::new(case, some.to_vec(), false)));
    }
    passes
}
