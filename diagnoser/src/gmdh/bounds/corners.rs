//! The vertices of a parameter set at work: extremes of r^T p, sample after sample.
//!
//! Both extremes are kept from the sample before and followed along edges uphill; where no
//! neighbour is better the extreme is found. A slowly moving regressor takes no step at all.

use super::regressor::Regressor;
use crate::memory::{Memory, MemoryError, Walk};

/// Vertices and edges of all parts of a set.
#[derive(Debug, Clone)]
pub(crate) struct Corners {
    dimension: usize,
    parts: Vec<PartCorners>,
    upper: Vec<f64>,
    lower: Vec<f64>,
}

#[derive(Debug, Clone)]
struct PartCorners {
    signs: Vec<i8>,
    /// Vertex after vertex.
    vertices: Vec<f64>,
    /// Neighbours of vertex v: `edges[first[v]..first[v + 1]]`.
    edges: Vec<u32>,
    first: Vec<usize>,
    /// Where the last maximum and minimum were.
    highest: usize,
    lowest: usize,
}

impl Corners {
    pub(super) fn new(dimension: usize) -> Self {
        Self {
            dimension,
            parts: Vec::new(),
            upper: vec![0.0; dimension],
            lower: vec![0.0; dimension],
        }
    }

    pub(super) fn push<'a>(
        &mut self,
        signs: &[i8],
        vertices: impl Iterator<Item = Vec<f64>>,
        edges: impl Iterator<Item = &'a [usize]>,
    ) {
        let mut part = PartCorners {
            signs: signs.to_vec(),
            vertices: vertices.flatten().collect(),
            edges: Vec::new(),
            first: vec![0],
            highest: 0,
            lowest: 0,
        };
        for neighbours in edges {
            part.edges.extend(neighbours.iter().map(|n| *n as u32));
            part.first.push(part.edges.len());
        }
        self.parts.push(part);
    }

    /// Back to the first vertices.
    pub(crate) fn reset(&mut self) {
        for part in &mut self.parts {
            (part.highest, part.lowest) = (0, 0);
        }
    }

    /// Vertices of all parts.
    pub(crate) fn count(&self) -> usize {
        self.parts.iter().map(|part| part.first.len() - 1).sum()
    }

    /// Smallest and largest r^T p (12), with an uncertain regressor (16).
    #[inline]
    pub(crate) fn interval(&mut self, regressor: Regressor) -> (f64, f64) {
        let mut interval = (f64::INFINITY, f64::NEG_INFINITY);
        for part in &mut self.parts {
            let (low, high) = if regressor.errors.is_empty() {
                part.extremes(self.dimension, regressor.values, regressor.values)
            } else {
                for i in 0..self.dimension {
                    let [least, most] = regressor.errors[i];
                    let positive = part.signs[i] >= 0;
                    self.upper[i] = regressor.values[i] - if positive { least } else { most };
                    self.lower[i] = regressor.values[i] - if positive { most } else { least };
                }
                part.extremes(self.dimension, &self.lower, &self.upper)
            };
            interval = (interval.0.min(low), interval.1.max(high));
        }
        interval
    }
}

impl PartCorners {
    #[inline]
    fn extremes(&mut self, d: usize, lower: &[f64], upper: &[f64]) -> (f64, f64) {
        let (highest, high) = self.climb(d, self.highest, upper, 1.0);
        let (lowest, low) = self.climb(d, self.lowest, lower, -1.0);
        (self.highest, self.lowest) = (highest, lowest);
        (-low, high)
    }

    /// The vertex with the largest sign x (r . p), from a vertex uphill.
    #[inline]
    fn climb(&self, d: usize, from: usize, r: &[f64], sign: f64) -> (usize, f64) {
        let value = |v: usize| {
            let p = &self.vertices[v * d..][..d];
            sign * p.iter().zip(r).map(|(p, r)| p * r).sum::<f64>()
        };
        let (mut at, mut best) = (from, value(from));
        loop {
            let here = at;
            for neighbour in &self.edges[self.first[here]..self.first[here + 1]] {
                let reached = value(*neighbour as usize);
                if reached > best {
                    (at, best) = (*neighbour as usize, reached);
                }
            }
            if at == here {
                return (at, best);
            }
        }
    }
}

impl Memory for Corners {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        self.parts.iter_mut().try_for_each(|part| {
            let vertices = part.first.len() - 1;
            walk.below(&mut part.highest, vertices)?;
            walk.below(&mut part.lowest, vertices)
        })
    }
}
