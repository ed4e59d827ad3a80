//! What a page shows beyond the surface itself: degrees in words, the hull of A-patches, a mesh as a surface of facets.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};
use suture_apatch::{ApatchSurface, Cell};
use suture_mesh::TriMesh;
use suture_surface::{
    Continuity, Domain, EdgeRef, Jet2, Patch, PatchId, PatchKind, Record, Seam, SplinePool, Surface,
    SurfaceError,
};
use suture_tessellate::Tessellation;

/// Polynomial degree of every patch, in words; what is not polynomial is named for what it is.
pub fn degrees(surface: &Surface) -> Vec<String> {
    let mut pool = SplinePool::default();
    let mut bubble = None;
    surface.patches().iter().map(|patch| degree(patch.as_ref(), &mut pool, &mut bubble)).collect()
}

fn degree(patch: &dyn Patch, pool: &mut SplinePool, bubble: &mut Option<String>) -> String {
    let number = |v: &serde_json::Value| v.as_u64().unwrap_or(0);
    match patch.kind() {
        PatchKind::Face | PatchKind::Edge => "zeros of a cubic".into(),
        PatchKind::Planar => "1".into(),
        PatchKind::Bubble { .. } => bubble
            // The order is the same everywhere, and records of bubble patches are long.
            .get_or_insert_with(|| format!("rational, order {}", number(&patch.record(pool).data["order"])))
            .clone(),
        PatchKind::Trimmed => {
            let data = patch.record(pool).data;
            let [m, n] = spline_degree(pool, &data["surface"]);
            format!("{m} × {n}")
        }
        // Degree 7 across strips and on N-gons (spec/wagner.md §2), times a B-spline after a map.
        PatchKind::Strip { .. } | PatchKind::AdjacentStrip => {
            let data = patch.record(pool).data;
            let [m, n] = spline_degree(pool, &data["surfaces"][0]);
            let map = &data["maps"][0]["degree"];
            let [a, b] = [0, 1].map(|k| (m + n) * number(&map[k]));
            format!("{a} × {}", b + 7)
        }
        PatchKind::NBlend { n } => {
            let data = patch.record(pool).data;
            let [p, q] = spline_degree(pool, &data["surfaces"][0]);
            format!("{n} triangles of degree {}", (p + q) * number(&data["maps"][0]["degree"]) + 7)
        }
        PatchKind::Fill { .. } => "convex combination".into(),
        PatchKind::Given => "as given".into(),
        _ => "unknown".into(),
    }
}

fn spline_degree(pool: &SplinePool, index: &serde_json::Value) -> [u64; 2] {
    let spline = index.as_u64().and_then(|i| pool.get(i as usize));
    spline.map_or([0; 2], |s| s.degree().map(|d| d as u64))
}

/// The tetrahedra of an A-patch surface, and whether each belongs to an edge.
pub(crate) fn hull(surface: &ApatchSurface) -> Vec<([DVec3; 4], bool)> {
    let corners = |cell: Cell| Some((surface.cell_vertices(cell)?, matches!(cell, Cell::Edge { .. })));
    surface.cells().into_iter().filter_map(corners).collect()
}

/// The tetrahedra of the A-patches of a surface, and whether each belongs to an edge: what a saved surface still knows of its hull. Empty
/// for other surfaces.
pub fn hull_of(surface: &Surface) -> Vec<([DVec3; 4], bool)> {
    let mut pool = SplinePool::default();
    let mut all = Vec::new();
    for patch in surface.patches() {
        let edge = patch.kind() == PatchKind::Edge;
        if edge || patch.kind() == PatchKind::Face {
            // Faces and edges of another method have no tetrahedra.
            let found = suture_apatch::tetrahedra(&patch.record(&mut pool)).unwrap_or_default();
            all.extend(found.into_iter().map(|v| (v, edge)));
        }
    }
    all
}

/// A mesh as a surface: one plane patch per face, joined along the edges that have two faces. Shows meshes with the means for surfaces.
///
/// # Errors
/// None that a mesh can cause: seams are made of existing edges, each once.
pub fn facets(mesh: &TriMesh) -> Result<(Surface, Tessellation), SurfaceError> {
    let corners = [DVec2::ZERO, DVec2::X, DVec2::Y];
    // Faces that name missing vertices have no place.
    let faces: Vec<[u32; 3]> = mesh
        .faces
        .iter()
        .filter(|f| f.iter().all(|&v| (v as usize) < mesh.positions.len()))
        .copied()
        .collect();
    let mut edges: BTreeMap<[u32; 2], Vec<EdgeRef>> = BTreeMap::new();
    for (f, face) in faces.iter().enumerate() {
        for k in 0..3 {
            let (a, b) = (face[k], face[(k + 1) % 3]);
            let edge = EdgeRef { patch: PatchId(f as u32), edge: k as u32 };
            edges.entry([a.min(b), a.max(b)]).or_default().push(edge);
        }
    }
    let start = |e: &EdgeRef| faces[e.patch.0 as usize][e.edge as usize];
    let seams = edges.values().filter(|list| list.len() == 2).map(|list| Seam {
        same_direction: start(&list[0]) == start(&list[1]),
        ..Seam::new(list[0], list[1], Continuity::C0)
    });
    let facet = |f: &[u32; 3]| Box::new(Facet(f.map(|v| mesh.positions[v as usize]))) as Box<dyn Patch>;
    let surface = Surface::new(faces.iter().map(facet).collect(), seams.collect())?;
    let mut of_vertex = vec![(PatchId(0), DVec2::ZERO); mesh.positions.len()];
    for (f, face) in faces.iter().enumerate() {
        for (k, &v) in face.iter().enumerate() {
            of_vertex[v as usize] = (PatchId(f as u32), corners[k]);
        }
    }
    let tessellation = Tessellation {
        mesh: TriMesh::new(mesh.positions.clone(), faces.clone()),
        vertex_patch: of_vertex.iter().map(|v| v.0).collect(),
        vertex_parameter: of_vertex.iter().map(|v| v.1).collect(),
        triangle_patch: (0..faces.len() as u32).map(PatchId).collect(),
        corner_parameters: vec![corners; faces.len()],
    };
    Ok((surface, tessellation))
}

/// A plane triangle on the triangle `(0, 0), (1, 0), (0, 1)`.
#[derive(Debug)]
struct Facet([DVec3; 3]);

impl Patch for Facet {
    fn domain(&self) -> Domain {
        Domain::Polygon(vec![DVec2::ZERO, DVec2::X, DVec2::Y])
    }

    fn jet(&self, at: DVec2) -> Jet2 {
        let [a, b, c] = self.0;
        Jet2 { p: a + (b - a) * at.x + (c - a) * at.y, du: b - a, dv: c - a, ..Jet2::default() }
    }

    fn kind(&self) -> PatchKind {
        PatchKind::Planar
    }

    /// Not to be saved: a mesh file says the same in fewer words.
    fn record(&self, _: &mut SplinePool) -> Record {
        Record { kind: "facet".into(), data: serde_json::Value::Null }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use suture_mesh::shapes;

    #[test]
    fn a_mesh_is_a_surface_of_facets() {
        let mesh = shapes::sphere(1);
        let (surface, tessellation) = facets(&mesh).unwrap();
        assert_eq!(surface.patches().len(), mesh.faces.len());
        assert_eq!(2 * surface.seams().len(), 3 * mesh.faces.len());
        let report =
            suture_certify::certify(&surface, mesh.diagonal(), &suture_certify::CertifyOptions::default())
                .unwrap();
        assert_eq!((report.measured, report.open_edges), (Some(Continuity::C0), 0));
        // Neighbours reach a point of their edge from different corners: rounding alone.
        assert!(report.position <= 1e-15, "{:e}", report.position);
        assert_eq!(tessellation.mesh.faces, mesh.faces);
        assert!(degrees(&surface).iter().all(|d| d == "1"));
    }

    #[test]
    fn fans_and_dangling_faces_are_facets_too() {
        let points = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z, -DVec3::Y];
        let faces = vec![[0, 1, 2], [0, 1, 3], [1, 0, 4], [7, 8, 9]];
        let (surface, _) = facets(&TriMesh::new(points.to_vec(), faces)).unwrap();
        // Three faces at one edge: no seam says which belong together.
        assert_eq!((surface.patches().len(), surface.seams().len()), (3, 0));
    }
}
