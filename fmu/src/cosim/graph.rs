//! The connection graph: the order of components that follows the data, and cycles.

/// The strongly connected parts of a graph, sources first (Tarjan 1972). Nodes within a part, and
/// parts that nothing orders, stay in the order of their numbers.
pub(super) fn strong_parts(nodes: usize, edges: &[(usize, usize)]) -> Vec<Vec<usize>> {
    let mut next: Vec<Vec<usize>> = vec![Vec::new(); nodes];
    for (from, to) in edges {
        next[*from].push(*to);
    }
    for targets in &mut next {
        // Reversed, as parts come out sinks first and the whole list is turned round at the end.
        targets.sort_unstable_by(|a, b| b.cmp(a));
        targets.dedup();
    }
    let mut search = Search {
        next,
        index: vec![None; nodes],
        low: vec![0; nodes],
        on_stack: vec![false; nodes],
        stack: Vec::new(),
        count: 0,
        parts: Vec::new(),
    };
    for node in (0..nodes).rev() {
        if search.index[node].is_none() {
            search.visit(node);
        }
    }
    search.parts.reverse();
    for part in &mut search.parts {
        part.sort_unstable();
    }
    search.parts
}

struct Search {
    next: Vec<Vec<usize>>,
    index: Vec<Option<usize>>,
    low: Vec<usize>,
    on_stack: Vec<bool>,
    stack: Vec<usize>,
    count: usize,
    parts: Vec<Vec<usize>>,
}

impl Search {
    /// A node and all it leads to, with a stack of its own: systems can be long chains.
    fn visit(&mut self, root: usize) {
        let mut path = vec![(root, 0)];
        self.open(root);
        while let Some((node, at)) = path.last_mut() {
            let node = *node;
            if let Some(&target) = self.next[node].get(*at) {
                *at += 1;
                match self.index[target] {
                    None => {
                        self.open(target);
                        path.push((target, 0));
                    }
                    Some(index) if self.on_stack[target] => {
                        self.low[node] = self.low[node].min(index);
                    }
                    Some(_) => {}
                }
                continue;
            }
            path.pop();
            if let Some((parent, _)) = path.last() {
                self.low[*parent] = self.low[*parent].min(self.low[node]);
            }
            if Some(self.low[node]) == self.index[node] {
                self.close(node);
            }
        }
    }

    fn open(&mut self, node: usize) {
        self.index[node] = Some(self.count);
        self.low[node] = self.count;
        self.count += 1;
        self.stack.push(node);
        self.on_stack[node] = true;
    }

    fn close(&mut self, node: usize) {
        let at = self.stack.iter().rposition(|other| *other == node).unwrap_or(0);
        let part = self.stack.split_off(at);
        for member in &part {
            self.on_stack[*member] = false;
        }
        self.parts.push(part);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_order_follows_the_edges() {
        let parts = strong_parts(4, &[(3, 1), (1, 0), (0, 2)]);
        assert_eq!(parts, [vec![3], vec![1], vec![0], vec![2]]);
    }

    #[test]
    fn cycles_are_found_and_stay_together() {
        let parts = strong_parts(5, &[(0, 1), (1, 2), (2, 0), (2, 3), (4, 0)]);
        assert_eq!(parts, [vec![4], vec![0, 1, 2], vec![3]]);
    }

    #[test]
    fn what_nothing_orders_keeps_its_order() {
        assert_eq!(strong_parts(3, &[]), [vec![0], vec![1], vec![2]]);
        assert_eq!(strong_parts(3, &[(1, 1)]), [vec![0], vec![1], vec![2]]);
    }

    #[test]
    fn long_chains_do_not_exhaust_the_stack() {
        let edges: Vec<_> = (1..200_000).map(|k| (k, k - 1)).collect();
        assert_eq!(strong_parts(200_000, &edges)[0], [199_999]);
    }
}
