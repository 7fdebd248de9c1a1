//! A bounded polytope {z : n_i . z <= h_i} by its vertices and edges, cut one half-space at a time.
//!
//! The double description method (T. S. Motzkin et al., 1953; K. Fukuda and A. Prodon, "Double
//! description method revisited", 1996), with the graph of edges kept beside the vertices: a cut
//! makes one new vertex on every edge that it crosses, and two vertices of the new facet are
//! joined if no third one lies on all facets that they share. A half-space that cuts nothing is
//! redundant and costs one scalar product a vertex. A linear function has its maximum over the
//! polytope where no neighbour of a vertex is better: from the vertex of the sample before, a few
//! steps along edges are a warm-started simplex method.

use std::collections::HashMap;

/// Slack below which a vertex lies on a hyperplane, where coordinates are of order one.
const ON: f64 = 1e-11;

/// n . z <= h.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct HalfSpace {
    pub(crate) normal: Vec<f64>,
    pub(crate) offset: f64,
}

/// What a cut did.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Cut {
    /// Nothing: the half-space holds everywhere.
    Redundant,
    /// A part is gone.
    Smaller,
    /// No point with all half-spaces strictly fulfilled is left.
    Empty,
}

#[derive(Debug, Clone)]
struct Vertex {
    at: Vec<f64>,
    /// Facets that it lies on, ascending.
    facets: Vec<usize>,
    neighbours: Vec<usize>,
}

/// A polytope with interior points.
#[derive(Debug, Clone)]
pub(crate) struct Polytope {
    half_spaces: Vec<HalfSpace>,
    vertices: Vec<Vertex>,
}

impl Polytope {
    /// The cube |z_i| <= `half_width`; its facets are the first 2 x `dimension` half-spaces.
    pub(crate) fn cube(dimension: usize, half_width: f64) -> Self {
        let half_space = |facet: usize| {
            let mut normal = vec![0.0; dimension];
            normal[facet / 2] = if facet.is_multiple_of(2) { 1.0 } else { -1.0 };
            HalfSpace { normal, offset: half_width }
        };
        let vertex = |corner: usize| {
            let low = |i: usize| corner >> i & 1;
            let side = |i: usize| if low(i) == 0 { half_width } else { -half_width };
            Vertex {
                at: (0..dimension).map(side).collect(),
                facets: (0..dimension).map(|i| 2 * i + low(i)).collect(),
                neighbours: (0..dimension).map(|i| corner ^ (1 << i)).collect(),
            }
        };
        Self {
            half_spaces: (0..2 * dimension).map(half_space).collect(),
            vertices: (0..1 << dimension).map(vertex).collect(),
        }
    }

    /// Intersects with one more half-space.
    pub(crate) fn cut(&mut self, half_space: HalfSpace) -> Cut {
        let HalfSpace { normal, offset } = &half_space;
        let slack: Vec<f64> =
            self.vertices.iter().map(|v| offset - product(normal, &v.at)).collect();
        if slack.iter().all(|slack| *slack >= -ON) {
            return Cut::Redundant;
        }
        if !slack.iter().any(|slack| *slack > ON) {
            return Cut::Empty;
        }
        let facet = self.half_spaces.len();
        self.half_spaces.push(half_space);
        let old = self.vertices.len();
        for w in (0..old).filter(|w| slack[*w] < -ON) {
            for u in self.vertices[w].neighbours.clone() {
                if slack[u] > ON {
                    self.split(u, w, slack[u] / (slack[u] - slack[w]), facet);
                }
            }
        }
        for v in (0..old).filter(|v| slack[*v].abs() <= ON) {
            self.vertices[v].facets.push(facet);
        }
        let on: Vec<usize> =
            (0..old).filter(|v| slack[*v].abs() <= ON).chain(old..self.vertices.len()).collect();
        self.join(&on);
        self.remove(|v| v < old && slack[v] < -ON);
        Cut::Smaller
    }

    /// A new vertex on the edge from `u` (kept) to `w` (cut off).
    fn split(&mut self, u: usize, w: usize, share: f64, facet: usize) {
        let (inside, outside) = (&self.vertices[u], &self.vertices[w]);
        let along = inside.at.iter().zip(&outside.at);
        let at = along.map(|(inside, outside)| inside + share * (outside - inside)).collect();
        let mut facets = shared(&inside.facets, &outside.facets);
        facets.push(facet);
        let new = self.vertices.len();
        self.vertices.push(Vertex { at, facets, neighbours: vec![u] });
        self.vertices[u].neighbours.push(new);
    }

    /// Joins the vertices of a new facet that share an edge of it.
    fn join(&mut self, on: &[usize]) {
        let Some(dimension) = on.first().map(|v| self.vertices[*v].at.len()) else { return };
        if on.iter().all(|v| self.vertices[*v].facets.len() == dimension) {
            self.join_simple(on);
            return;
        }
        for (i, &x) in on.iter().enumerate() {
            for &y in &on[i + 1..] {
                let (a, b) = (&self.vertices[x], &self.vertices[y]);
                let common = shared(&a.facets, &b.facets);
                if common.len() + 1 < dimension || a.neighbours.contains(&y) {
                    continue;
                }
                let simple = a.facets.len() == dimension && b.facets.len() == dimension;
                let third = |z: &&usize| {
                    **z != x && **z != y && contains(&self.vertices[**z].facets, &common)
                };
                if simple || !on.iter().any(|z| third(&z)) {
                    self.vertices[x].neighbours.push(y);
                    self.vertices[y].neighbours.push(x);
                }
            }
        }
    }

    /// Where every vertex lies on as many facets as there are dimensions, an edge is what two
    /// vertices share by all facets but one: each facet but the new one is left out in turn.
    fn join_simple(&mut self, on: &[usize]) {
        let mut waiting: HashMap<Vec<usize>, usize> = HashMap::with_capacity(4 * on.len());
        for &x in on {
            let facets = &self.vertices[x].facets;
            // The new facet has the highest number, so it is the last.
            let edges: Vec<Vec<usize>> = (0..facets.len().saturating_sub(1))
                .map(|left_out| {
                    let kept = facets.iter().enumerate().filter(|(i, _)| *i != left_out);
                    kept.map(|(_, facet)| *facet).collect()
                })
                .collect();
            for edge in edges {
                match waiting.remove(&edge) {
                    Some(y) => {
                        self.vertices[x].neighbours.push(y);
                        self.vertices[y].neighbours.push(x);
                    }
                    None => {
                        waiting.insert(edge, x);
                    }
                }
            }
        }
    }

    fn remove(&mut self, gone: impl Fn(usize) -> bool) {
        let mut place = Vec::with_capacity(self.vertices.len());
        let mut next = 0;
        for v in 0..self.vertices.len() {
            place.push((!gone(v)).then_some(next));
            next += usize::from(!gone(v));
        }
        let mut index = 0;
        self.vertices.retain(|_| {
            index += 1;
            place[index - 1].is_some()
        });
        for vertex in &mut self.vertices {
            vertex.neighbours = vertex.neighbours.iter().filter_map(|n| place[*n]).collect();
        }
    }

    /// Whether one of the first `count` half-spaces bounds the polytope.
    pub(crate) fn touches_first(&self, count: usize) -> bool {
        self.vertices.iter().any(|vertex| vertex.facets.iter().any(|facet| *facet < count))
    }

    /// The half-spaces that are facets: those that remain when redundant ones are removed.
    pub(crate) fn facets(&self) -> Vec<HalfSpace> {
        let mut used = vec![false; self.half_spaces.len()];
        self.vertices.iter().flat_map(|v| &v.facets).for_each(|facet| used[*facet] = true);
        let kept = self.half_spaces.iter().zip(used).filter(|(_, used)| *used);
        kept.map(|(half_space, _)| half_space.clone()).collect()
    }

    /// Coordinates of every vertex.
    pub(crate) fn vertices(&self) -> impl Iterator<Item = &[f64]> {
        self.vertices.iter().map(|vertex| &vertex.at[..])
    }

    /// Neighbours of every vertex.
    pub(crate) fn edges(&self) -> impl Iterator<Item = &[usize]> {
        self.vertices.iter().map(|vertex| &vertex.neighbours[..])
    }
}

pub(crate) fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Intersection of two ascending lists.
fn shared(a: &[usize], b: &[usize]) -> Vec<usize> {
    let mut common = Vec::with_capacity(a.len() + 1);
    let mut b = b.iter().peekable();
    for a in a {
        while b.next_if(|b| *b < a).is_some() {}
        if b.next_if(|b| *b == a).is_some() {
            common.push(*a);
        }
    }
    common
}

/// Whether an ascending list holds all of another.
fn contains(list: &[usize], part: &[usize]) -> bool {
    let mut list = list.iter();
    part.iter().all(|p| list.any(|l| l == p))
}

#[cfg(test)]
pub(crate) mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::*;
    use crate::testing::noise;

    /// All vertices by solving every choice of `dimension` half-spaces: the oracle.
    pub(crate) fn enumerated(half_spaces: &[HalfSpace], dimension: usize) -> Vec<Vec<f64>> {
        fn choose(
            from: usize,
            count: usize,
            of: usize,
            chosen: &mut Vec<usize>,
            out: &mut Vec<Vec<usize>>,
        ) {
            if count == 0 {
                out.push(chosen.clone());
                return;
            }
            for i in from..=of - count {
                chosen.push(i);
                choose(i + 1, count - 1, of, chosen, out);
                chosen.pop();
            }
        }
        let mut choices = Vec::new();
        choose(0, dimension, half_spaces.len(), &mut Vec::new(), &mut choices);
        let vertex = |choice: &Vec<usize>| {
            let a = DMatrix::from_fn(dimension, dimension, |i, j| half_spaces[choice[i]].normal[j]);
            let h = DVector::from_fn(dimension, |i, _| half_spaces[choice[i]].offset);
            let z = a.lu().solve(&h)?;
            let inside =
                half_spaces.iter().all(|s| product(&s.normal, z.as_slice()) <= s.offset + 1e-9);
            (inside && z.iter().all(|z| z.is_finite())).then(|| z.as_slice().to_vec())
        };
        choices.iter().filter_map(vertex).collect()
    }

    /// Random half-spaces around the origin, with the cube's.
    pub(crate) fn random(dimension: usize, count: usize, seed: u64) -> Vec<HalfSpace> {
        let mut draws = noise(count * (dimension + 1), seed).into_iter();
        let mut half_spaces = Polytope::cube(dimension, 3.0).half_spaces;
        for _ in 0..count {
            let normal = draws.by_ref().take(dimension).collect();
            let offset = 0.7 + 0.2 * draws.next().unwrap().abs();
            half_spaces.push(HalfSpace { normal, offset });
        }
        half_spaces
    }

    #[test]
    fn vertices_equal_enumeration_in_up_to_six_dimensions() {
        for (dimension, count) in [(1, 4), (2, 20), (3, 20), (4, 12), (5, 8), (6, 6)] {
            let half_spaces = random(dimension, count, dimension as u64);
            let mut polytope = Polytope::cube(dimension, 3.0);
            for half_space in &half_spaces[2 * dimension..] {
                polytope.cut(half_space.clone());
            }
            let oracle = enumerated(&half_spaces, dimension);
            assert_eq!(polytope.vertices.len(), oracle.len(), "dimension {dimension}");
            for vertex in polytope.vertices() {
                let near = |z: &Vec<f64>| z.iter().zip(vertex).all(|(a, b)| (a - b).abs() < 1e-9);
                assert!(oracle.iter().any(near), "{vertex:?}");
            }
            // A simple polytope has as many edges at a vertex as dimensions.
            assert!(polytope.edges().all(|edges| edges.len() == dimension));
        }
    }

    #[test]
    fn degenerate_vertices_keep_their_edges() {
        // |x| + |y| + |z| <= 1: an octahedron, four facets at every vertex.
        let mut polytope = Polytope::cube(3, 3.0);
        for corner in 0..8 {
            let normal = (0..3).map(|i| if corner >> i & 1 == 0 { 1.0 } else { -1.0 }).collect();
            polytope.cut(HalfSpace { normal, offset: 1.0 });
        }
        assert_eq!((polytope.vertices.len(), polytope.facets().len()), (6, 8));
        assert!(polytope.edges().all(|edges| edges.len() == 4));
        assert!(!polytope.touches_first(6));
    }

    #[test]
    fn redundant_and_contradicting_half_spaces_are_told_apart() {
        let half_space = |normal: [f64; 2], offset| HalfSpace { normal: normal.to_vec(), offset };
        let mut polytope = Polytope::cube(2, 1.0);
        assert_eq!(polytope.cut(half_space([1.0, 1.0], 2.0)), Cut::Redundant);
        assert_eq!(polytope.cut(half_space([1.0, 1.0], 0.0)), Cut::Smaller);
        assert_eq!(polytope.vertices.len(), 3);
        assert!(polytope.touches_first(4));
        assert_eq!(polytope.cut(half_space([-1.0, -1.0], -0.1)), Cut::Empty);
    }
}
