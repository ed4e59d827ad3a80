//! Groups of patches: names and colours.

use suture_surface::{PatchId, PatchKind, Surface};
use suture_tessellate::Tessellation;

use crate::ExportError;

/// Patches that are shown alike.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Group {
    /// Name of the group and of its material.
    pub(crate) name: &'static str,
    /// Colour in sRGB, 8 bits.
    pub(crate) colour: [u8; 3],
}

/// All groups, in the order in which they are written. The colours of the first five are those of the figures of Wagner, Hormann &
/// Greiner (2003).
pub(crate) const GROUPS: [Group; 12] = [
    Group { name: "trimmed", colour: [72, 118, 200] },
    Group { name: "strip_even", colour: [200, 40, 40] },
    Group { name: "strip_odd", colour: [240, 140, 130] },
    Group { name: "strip_adjacent", colour: [70, 165, 80] },
    Group { name: "nblend", colour: [245, 205, 60] },
    Group { name: "face", colour: [91, 155, 213] },
    Group { name: "edge", colour: [232, 163, 61] },
    Group { name: "planar", colour: [150, 163, 178] },
    Group { name: "bubble", colour: [63, 167, 150] },
    Group { name: "fill", colour: [244, 177, 60] },
    Group { name: "given", colour: [142, 160, 190] },
    Group { name: "other", colour: [160, 160, 160] },
];

/// Number in [`GROUPS`] of a kind of patch.
pub(crate) fn group_of(kind: PatchKind) -> usize {
    match kind {
        PatchKind::Trimmed => 0,
        PatchKind::Strip { odd: false } => 1,
        PatchKind::Strip { odd: true } => 2,
        PatchKind::AdjacentStrip => 3,
        PatchKind::NBlend { .. } => 4,
        PatchKind::Face => 5,
        PatchKind::Edge => 6,
        PatchKind::Planar => 7,
        PatchKind::Bubble { .. } => 8,
        PatchKind::Fill { .. } => 9,
        PatchKind::Given => 10,
        _ => 11,
    }
}

impl Group {
    /// The colour in linear components of `[0, 1]` (IEC 61966-2-1).
    pub(crate) fn linear(&self) -> [f32; 3] {
        self.colour.map(|c| {
            let c = f32::from(c) / 255.0;
            if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        })
    }
}

/// The triangles of every group, and vertices with the normals of their own patch.
pub(crate) struct Grouped {
    /// Per group: vertex and normal numbers of the corners of its triangles.
    pub(crate) corners: Vec<Vec<[Corner; 3]>>,
    /// One normal per vertex of the mesh, then those of corners whose patch has another normal than their vertex.
    pub(crate) normals: Vec<glam::DVec3>,
    /// Vertex of every normal.
    pub(crate) vertex: Vec<u32>,
    /// Where every normal is taken.
    pub(crate) place: Vec<(PatchId, glam::DVec2)>,
}

/// Number of the normal of a corner; its vertex is [`Grouped::vertex`] of it.
pub(crate) type Corner = u32;

/// Angle beyond which a corner gets the normal of its own patch, radians: below any that shading shows.
const CREASE: f64 = 1e-3;

impl Grouped {
    /// Sorts the triangles by group and gives corners at creases normals of their own.
    ///
    /// # Errors
    /// [`ExportError::Tessellation`]: lengths, indices and patches that do not fit.
    pub(crate) fn new(surface: &Surface, tessellation: &Tessellation) -> Result<Self, ExportError> {
        check(surface, tessellation)?;
        let mesh = &tessellation.mesh;
        let own = |v: usize| {
            let patch = surface.patch(tessellation.vertex_patch[v]);
            patch.and_then(|p| p.normal(tessellation.vertex_parameter[v])).unwrap_or(glam::DVec3::Z)
        };
        let given = mesh.normals.as_ref();
        let unit = |v: usize| given.and_then(|n| n[v].try_normalize()).unwrap_or_else(|| own(v));
        let mut normals: Vec<glam::DVec3> = (0..mesh.positions.len()).map(unit).collect();
        let mut vertex: Vec<u32> = (0..normals.len() as u32).collect();
        let of_vertex = |v: usize| (tessellation.vertex_patch[v], tessellation.vertex_parameter[v]);
        let mut place: Vec<_> = (0..normals.len()).map(of_vertex).collect();
        let mut corners = vec![Vec::new(); GROUPS.len()];
        // Split corners of the same vertex and patch share their normal.
        let mut split: std::collections::HashMap<(u32, u32), u32> = std::collections::HashMap::new();
        for (t, face) in mesh.faces.iter().enumerate() {
            let id = tessellation.triangle_patch[t];
            let Some(patch) = surface.patch(id) else { continue };
            let mut triangle = *face;
            for c in 0..3 {
                let v = face[c];
                if tessellation.vertex_patch[v as usize] == id {
                    continue;
                }
                if let Some(&known) = split.get(&(v, id.0)) {
                    triangle[c] = known;
                    continue;
                }
                let n = patch.normal(tessellation.corner_parameters[t][c]);
                let shared = normals[v as usize];
                if let Some(n) =
                    n.filter(|n| n.is_finite() && n.cross(shared).length().atan2(n.dot(shared)) > CREASE)
                {
                    triangle[c] = normals.len() as u32;
                    split.insert((v, id.0), triangle[c]);
                    normals.push(n);
                    vertex.push(v);
                    place.push((id, tessellation.corner_parameters[t][c]));
                }
            }
            corners[group_of(patch.kind())].push(triangle);
        }
        Ok(Self { corners, normals, vertex, place })
    }
}

fn check(surface: &Surface, t: &Tessellation) -> Result<(), ExportError> {
    let refuse = |reason: String| Err(ExportError::Tessellation { reason });
    let (vertices, triangles) = (t.mesh.positions.len(), t.mesh.faces.len());
    let mut lengths = vec![
        ("vertex_patch", t.vertex_patch.len(), vertices),
        ("vertex_parameter", t.vertex_parameter.len(), vertices),
        ("triangle_patch", t.triangle_patch.len(), triangles),
        ("corner_parameters", t.corner_parameters.len(), triangles),
    ];
    lengths.extend(t.mesh.normals.as_ref().map(|n| ("normals", n.len(), vertices)));
    for (name, given, needed) in lengths {
        if given != needed {
            return refuse(format!("{name} has {given} entries instead of {needed}"));
        }
    }
    // Every corner may be split.
    if vertices + 3 * triangles > u32::MAX as usize {
        return refuse(format!("{vertices} vertices and {triangles} triangles are too many to be numbered"));
    }
    let patches = surface.patches().len();
    for (i, p) in t.triangle_patch.iter().enumerate() {
        if p.0 as usize >= patches {
            return refuse(format!("triangle {i} lies on patch {} of {patches}", p.0));
        }
    }
    for (i, face) in t.mesh.faces.iter().enumerate() {
        if let Some(v) = face.iter().find(|&&v| v as usize >= vertices) {
            return refuse(format!("triangle {i} names vertex {v} of {vertices}"));
        }
    }
    match t.mesh.positions.iter().position(|p| !p.is_finite()) {
        Some(i) => refuse(format!("vertex {i} is not finite")),
        None => Ok(()),
    }
}
