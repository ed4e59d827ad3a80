//! Polygons as the file has them, before they become triangles.

use glam::DVec3;

use super::{Loaded, MeshFormat, Notice, lexer::excerpt, mean_normal, polygon::triangulate};
use crate::{MeshError, Place, TriMesh};

const NONE: u32 = u32::MAX;

/// Collects vertices and polygons; indices may run ahead of the vertices until [`finish`](Self::finish).
#[derive(Debug)]
pub(super) struct Draft {
    pub(super) format: MeshFormat,
    pub(super) positions: Vec<DVec3>,
    /// One per vertex, or empty; what [`corner`](Self::corner) names, where corners name normals.
    pub(super) normals: Vec<DVec3>,
    normals_by_corner: bool,
    corners: Vec<[u32; 2]>,
    ends: Vec<usize>,
    places: Vec<Place>,
    skipped: Option<(usize, Place, usize)>,
    ignored: Vec<(String, usize, Place)>,
}

impl Draft {
    pub(super) fn new(format: MeshFormat) -> Self {
        Self {
            format,
            positions: Vec::new(),
            normals: Vec::new(),
            normals_by_corner: format == MeshFormat::Obj,
            corners: Vec::new(),
            ends: Vec::new(),
            places: Vec::new(),
            skipped: None,
            ignored: Vec::new(),
        }
    }

    /// Adds a corner to the polygon under construction. `index` and `normal` count from 0; `written` is the index as it stands in
    /// the file, for the error.
    pub(super) fn corner(
        &mut self,
        index: i64,
        normal: Option<i64>,
        at: Place,
        written: &[u8],
    ) -> Result<(), MeshError> {
        let vertex = u32::try_from(index).ok().filter(|&v| v != NONE);
        let vertex = vertex.ok_or_else(|| self.index_error("vertex", excerpt(written), at))?;
        let normal = match normal {
            None => NONE,
            Some(n) => u32::try_from(n)
                .ok()
                .filter(|&n| n != NONE)
                .ok_or_else(|| self.index_error("normal", excerpt(written), at))?,
        };
        self.corners.push([vertex, normal]);
        Ok(())
    }

    /// Corners of the polygon under construction.
    pub(super) fn open_corners(&self) -> usize {
        self.corners.len() - self.ends.last().copied().unwrap_or(0)
    }

    /// Ends the polygon under construction; skips it with a notice where it has fewer than three corners.
    pub(super) fn end_polygon(&mut self, at: Place) {
        let corners = self.open_corners();
        if corners < 3 {
            self.corners.truncate(self.corners.len() - corners);
            self.skipped.get_or_insert((0, at, corners)).0 += 1;
        } else {
            self.ends.push(self.corners.len());
            self.places.push(at);
        }
    }

    /// Notes something that is left out; beyond a handful of kinds all the rest is one, for names come from strangers.
    pub(super) fn ignore(&mut self, what: &str, count: usize, at: Place) {
        const KINDS: usize = 16;
        let known = self.ignored.iter().position(|(known, ..)| known == what);
        match known.or((self.ignored.len() > KINDS).then_some(KINDS)) {
            Some(k) => self.ignored[k].1 = self.ignored[k].1.saturating_add(count),
            None if self.ignored.len() < KINDS => self.ignored.push((what.to_owned(), count, at)),
            None => self.ignored.push(("other part of the file".to_owned(), count, at)),
        }
    }

    /// An index that names nothing, with the range that is valid so far.
    pub(super) fn index_error(&self, what: &'static str, index: String, at: Place) -> MeshError {
        let count = if what == "normal" { self.normals.len() } else { self.positions.len() };
        let valid = match (count, self.format) {
            (0, _) => format!("none, for the file has no {what}"),
            (_, MeshFormat::Obj) => format!("1 to {count} and −{count} to −1"),
            _ => format!("0 to {}", count - 1),
        };
        MeshError::Index { format: self.format, at, what, index, valid }
    }

    /// Checks all indices and triangulates.
    pub(super) fn finish(mut self) -> Result<Loaded, MeshError> {
        if self.positions.len() >= NONE as usize {
            let (count, limit) = (self.positions.len(), NONE as usize - 1);
            return Err(MeshError::TooLarge { what: "vertices", count, limit });
        }
        if self.ends.is_empty() {
            return Err(MeshError::NoFaces { format: self.format, vertices: self.positions.len() });
        }
        self.check_indices()?;
        let mut notices = Vec::new();
        let faces = self.triangles(&mut notices)?;
        if let Some((faces, first, corners)) = self.skipped {
            notices.push(Notice::SkippedFaces { faces, first, corners });
        }
        for (what, count, first) in std::mem::take(&mut self.ignored) {
            notices.push(Notice::Ignored { what, count, first });
        }
        let normals = self.vertex_normals(&mut notices);
        Ok(Loaded { mesh: TriMesh { positions: self.positions, faces, normals }, notices })
    }

    fn polygons(&self) -> impl Iterator<Item = (&[[u32; 2]], Place)> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).zip(&self.places).map(|((start, &end), &at)| (&self.corners[start..end], at))
    }

    fn check_indices(&self) -> Result<(), MeshError> {
        // OBJ counts from 1.
        let base = u64::from(self.format == MeshFormat::Obj);
        let missing = |index: u32, count: usize| index != NONE && index as usize >= count;
        for (polygon, at) in self.polygons() {
            for &[vertex, normal] in polygon {
                if missing(vertex, self.positions.len()) {
                    return Err(self.index_error("vertex", (u64::from(vertex) + base).to_string(), at));
                }
                if missing(normal, self.normals.len()) {
                    return Err(self.index_error("normal", (u64::from(normal) + base).to_string(), at));
                }
            }
        }
        Ok(())
    }

    fn triangles(&self, notices: &mut Vec<Notice>) -> Result<Vec<[u32; 3]>, MeshError> {
        let mut faces = Vec::with_capacity(self.corners.len() - 2 * self.ends.len());
        let (mut polygons, mut largest, mut irregular) = (0, 0, None);
        let mut outline = Vec::new();
        for (polygon, at) in self.polygons() {
            let n = polygon.len();
            if n == 3 {
                faces.push([polygon[0][0], polygon[1][0], polygon[2][0]]);
                continue;
            }
            polygons += 1;
            largest = largest.max(n);
            outline.clear();
            outline.extend(polygon.iter().map(|c| self.positions[c[0] as usize]));
            let cut = triangulate(&outline).map_err(|reflex| MeshError::Polygon {
                format: self.format,
                at,
                corners: n,
                reflex,
            })?;
            if !cut.simple {
                irregular.get_or_insert((0, at)).0 += 1;
            }
            faces.extend(cut.triangles.iter().map(|t| t.map(|k| polygon[k][0])));
        }
        if polygons > 0 {
            notices.push(Notice::Triangulated { polygons, largest });
        }
        if let Some((polygons, first)) = irregular {
            notices.push(Notice::IrregularPolygons { polygons, first });
        }
        Ok(faces)
    }

    fn vertex_normals(&mut self, notices: &mut Vec<Notice>) -> Option<Vec<DVec3>> {
        if self.normals.is_empty() {
            return None;
        }
        let mut drop = |reason| {
            notices.push(Notice::DroppedNormals { reason });
            None
        };
        if self.normals.iter().any(|n| !n.is_finite()) {
            return drop("one of them is not finite");
        }
        if !self.normals_by_corner {
            return Some(std::mem::take(&mut self.normals));
        }
        // Sorted pairs of vertex and normal: every run belongs to one vertex.
        let mut pairs = self.corners.clone();
        pairs.sort_unstable();
        pairs.dedup();
        if pairs.iter().all(|&[_, n]| n == NONE) {
            return drop("no face names them");
        }
        if pairs.iter().any(|&[_, n]| n == NONE) {
            return drop("some faces name none");
        }
        let mut normals = vec![DVec3::ZERO; self.positions.len()];
        let mut averaged = 0;
        let mut members = Vec::new();
        for run in pairs.chunk_by(|a, b| a[0] == b[0]) {
            members.clear();
            members.extend(run.iter().map(|&[_, n]| self.normals[n as usize]));
            let Some(mean) = mean_normal(&members) else {
                return drop("those of one vertex cancel each other");
            };
            averaged += usize::from(members.iter().any(|&n| n != members[0]));
            normals[run[0][0] as usize] = mean;
        }
        if averaged > 0 {
            notices.push(Notice::AveragedNormals { vertices: averaged });
        }
        Some(normals)
    }
}
