//! Neighbours, corners and components of the patches of a surface.

use suture_surface::{Domain, EdgeRef, Surface};

/// What makes a vertex one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Vertex {
    /// A corner of patches: the least number of an edge that starts there.
    Corner(usize),
    /// The middle of an edge: the lesser number of the two edges that lie there.
    Middle(usize),
    /// The centre of a patch.
    Centre(usize),
}

/// Domains, neighbours and corners.
pub(crate) struct Topology {
    pub(crate) domains: Vec<Domain>,
    /// Number of the first edge of every patch.
    pub(crate) first: Vec<usize>,
    /// Across every edge: the other edge and whether both run in the same direction.
    across: Vec<Option<(EdgeRef, bool)>>,
    /// The vertex at the start of every edge.
    start: Vec<usize>,
    pub(crate) patch_of: Vec<usize>,
}

impl Topology {
    pub(crate) fn new(surface: &Surface) -> Self {
        let domains: Vec<Domain> = surface.patches().iter().map(|p| p.domain()).collect();
        let mut first = Vec::with_capacity(domains.len());
        let mut patch_of = Vec::new();
        for (p, domain) in domains.iter().enumerate() {
            first.push(patch_of.len());
            patch_of.resize(patch_of.len() + domain.edge_count(), p);
        }
        let index = |e: EdgeRef| first[e.patch.0 as usize] + e.edge as usize;
        let end = |e: EdgeRef| {
            let p = e.patch.0 as usize;
            first[p] + domains[p].next_edge(e.edge as usize)
        };
        let mut across = vec![None; patch_of.len()];
        let mut corners = UnionFind::new(patch_of.len());
        for seam in surface.seams() {
            across[index(seam.a)] = Some((seam.b, seam.same_direction));
            across[index(seam.b)] = Some((seam.a, seam.same_direction));
            let (b0, b1) =
                if seam.same_direction { (index(seam.b), end(seam.b)) } else { (end(seam.b), index(seam.b)) };
            corners.join(index(seam.a), b0);
            corners.join(end(seam.a), b1);
        }
        let start = (0..patch_of.len()).map(|e| corners.root(e)).collect();
        Self { domains, first, across, start, patch_of }
    }

    pub(crate) fn index(&self, e: EdgeRef) -> usize {
        self.first[e.patch.0 as usize] + e.edge as usize
    }

    pub(crate) fn corner(&self, patch: usize, edge: usize) -> Vertex {
        Vertex::Corner(self.start[self.first[patch] + edge])
    }

    pub(crate) fn middle(&self, patch: usize, edge: usize) -> Vertex {
        let e = self.first[patch] + edge;
        Vertex::Middle(self.across[e].map_or(e, |(f, _)| self.index(f).min(e)))
    }

    /// The vertex at `t` of an edge: an end or the middle.
    pub(crate) fn vertex(&self, patch: usize, edge: usize, t: f64) -> Vertex {
        match t {
            0.0 => self.corner(patch, edge),
            1.0 => self.corner(patch, self.domains[patch].next_edge(edge)),
            _ => self.middle(patch, edge),
        }
    }

    pub(crate) fn across(&self, patch: usize, edge: usize) -> Option<(usize, usize, bool)> {
        self.across[self.first[patch] + edge].map(|(e, same)| (e.patch.0 as usize, e.edge as usize, same))
    }

    /// Component and orientation of every patch.
    pub(crate) fn shells(&self) -> Vec<(usize, bool)> {
        let mut shells: Vec<Option<(usize, bool)>> = vec![None; self.domains.len()];
        let mut count = 0;
        for seed in 0..self.domains.len() {
            if shells[seed].is_some() {
                continue;
            }
            shells[seed] = Some((count, false));
            let mut queue = vec![(seed, false)];
            while let Some((p, flipped)) = queue.pop() {
                for edge in 0..self.domains[p].edge_count() {
                    if let Some((q, _, same)) = self.across(p, edge)
                        && shells[q].is_none()
                    {
                        shells[q] = Some((count, flipped != same));
                        queue.push((q, flipped != same));
                    }
                }
            }
            count += 1;
        }
        shells.into_iter().map(Option::unwrap_or_default).collect()
    }
}

/// Disjoint sets; the least member stands for its set.
pub(crate) struct UnionFind(Vec<usize>);

impl UnionFind {
    pub(crate) fn new(count: usize) -> Self {
        Self((0..count).collect())
    }

    pub(crate) fn find(&self, mut x: usize) -> usize {
        while self.0[x] != x {
            x = self.0[x];
        }
        x
    }

    pub(crate) fn root(&mut self, x: usize) -> usize {
        let root = self.find(x);
        let mut x = x;
        while self.0[x] != root {
            x = std::mem::replace(&mut self.0[x], root);
        }
        root
    }

    pub(crate) fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b)] = a.min(b);
    }
}
