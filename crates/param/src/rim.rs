//! The boundary loop of a triangulated disc, and the proof that it is one.

use crate::ParamError;

/// The boundary loop of a disc, counter-clockwise (faces on the left), beginning at its smallest vertex.
///
/// # Errors
/// [`ParamError::Empty`], [`ParamError::VertexIndex`], [`ParamError::NotDisc`].
pub(crate) fn boundary_loop(vertices: usize, faces: &[[u32; 3]]) -> Result<Vec<u32>, ParamError> {
    if faces.is_empty() {
        return Err(ParamError::Empty);
    }
    for (face, corners) in faces.iter().enumerate() {
        if let Some(&vertex) = corners.iter().find(|&&v| v as usize >= vertices) {
            return Err(ParamError::VertexIndex { face, vertex, vertices });
        }
    }
    // Directed edges by (tail, head), each with its half-edge 3 f + k.
    let mut edges: Vec<(u32, u32, usize)> = Vec::with_capacity(3 * faces.len());
    let mut defects = 0;
    for (f, corners) in faces.iter().enumerate() {
        for k in 0..3 {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            defects += usize::from(a == b);
            edges.push((a, b, 3 * f + k));
        }
    }
    edges.sort_unstable();
    defects += edges.windows(2).filter(|w| (w[0].0, w[0].1) == (w[1].0, w[1].1)).count();
    let mut fans = Union::new(3 * faces.len());
    let mut parts = Union::new(faces.len());
    let mut next = vec![u32::MAX; vertices];
    let mut rim = 0;
    for &(a, b, h) in &edges {
        let at = edges.partition_point(|e| (e.0, e.1) < (b, a));
        match edges.get(at) {
            Some(&(c, d, o)) if (c, d) == (b, a) => {
                // Corner h is at a, as is the corner after o.
                fans.unite(h, o - o % 3 + (o + 1) % 3);
                parts.unite(h / 3, o / 3);
            }
            _ => {
                rim += 1;
                defects += usize::from(next[a as usize] != u32::MAX);
                next[a as usize] = b;
            }
        }
    }
    // Every vertex of a surface has one fan; more fans than vertices means pinched, fewer means isolated vertices.
    let (fans, components) = (fans.count(), parts.count());
    defects += fans.abs_diff(vertices);
    let mut loops = 0;
    let mut first = Vec::new();
    let mut seen = vec![false; vertices];
    for v in 0..vertices {
        if next[v] == u32::MAX || seen[v] {
            continue;
        }
        loops += 1;
        let mut at = v;
        while !seen[at] && next[at] != u32::MAX {
            seen[at] = true;
            if loops == 1 {
                first.push(at as u32);
            }
            at = next[at] as usize;
        }
    }
    let euler = vertices as i64 - ((edges.len() + rim) / 2) as i64 + faces.len() as i64;
    if euler == 1 && loops == 1 && components == 1 && defects == 0 && first.len() == rim && rim >= 3 {
        Ok(first)
    } else {
        Err(ParamError::NotDisc { euler, loops, components, defects })
    }
}

/// Disjoint sets with path halving; the smaller index is the root.
#[derive(Clone, Debug)]
pub(crate) struct Union {
    parent: Vec<u32>,
}

impl Union {
    pub(crate) fn new(n: usize) -> Self {
        Self { parent: (0..n as u32).collect() }
    }

    /// Adds `n` sets of one element.
    pub(crate) fn grow(&mut self, n: usize) {
        let from = self.parent.len() as u32;
        self.parent.extend(from..from + n as u32);
    }

    pub(crate) fn find(&mut self, mut a: usize) -> usize {
        while self.parent[a] as usize != a {
            self.parent[a] = self.parent[self.parent[a] as usize];
            a = self.parent[a] as usize;
        }
        a
    }

    pub(crate) fn unite(&mut self, a: usize, b: usize) {
        let (a, b) = (self.find(a), self.find(b));
        self.parent[a.max(b)] = a.min(b) as u32;
    }

    fn count(&self) -> usize {
        self.parent.iter().enumerate().filter(|&(i, &p)| i == p as usize).count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_has_its_four_edges_as_loop() {
        assert_eq!(boundary_loop(4, &[[0, 1, 2], [0, 2, 3]]), Ok(vec![0, 1, 2, 3]));
    }

    #[test]
    fn everything_else_is_refused() {
        assert_eq!(boundary_loop(3, &[]), Err(ParamError::Empty));
        let closed = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        let cases: [(usize, &[[u32; 3]]); 6] = [
            (4, &closed),
            (6, &[[0, 1, 2], [3, 4, 5]]),
            (5, &[[0, 1, 2], [0, 3, 4]]),
            (4, &[[0, 1, 2]]),
            (4, &[[0, 1, 2], [1, 2, 3]]),
            (2, &[[0, 0, 1]]),
        ];
        for (n, faces) in cases {
            assert!(matches!(boundary_loop(n, faces), Err(ParamError::NotDisc { .. })), "{faces:?}");
        }
        assert!(matches!(boundary_loop(2, &[[0, 1, 2]]), Err(ParamError::VertexIndex { vertex: 2, .. })));
    }
}
