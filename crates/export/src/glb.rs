//! Binary glTF 2.0 (Khronos Group 2021, *glTF 2.0 Specification*, §4.4 and §5).

use glam::{DVec3, Vec3};
use gltf_json::accessor::{ComponentType, GenericComponentType, Type};
use gltf_json::buffer::{Target, View};
use gltf_json::material::{PbrBaseColorFactor, PbrMetallicRoughness, StrengthFactor};
use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::validation::{Checked::Valid, USize64};
use gltf_json::{Accessor, Asset, Buffer, Index, Material, Mesh, Node, Root, Scene};
use suture_surface::{Jet2, Surface};
use suture_tessellate::Tessellation;

use crate::ExportError;
use crate::group::{GROUPS, Group, Grouped};

/// Largest size of a binary glTF file: its header counts in 32 bits.
const LIMIT: u64 = u32::MAX as u64;

/// The surface as a binary glTF file: one node, one mesh, one primitive and one material per group of patches, all on the same
/// vertices.
///
/// Positions are 32-bit and relative to the translation of the node, which lies at the middle of the bounding box: a small part far
/// from the origin keeps its shape. The translation is what 32 bits hold of the middle, and the positions make up for the rest.
/// Normals are those of the patches; corners at creases have one vertex per patch.
///
/// # Errors
/// [`ExportError::Tessellation`], [`ExportError::Range`], [`ExportError::TooLarge`].
pub fn to_glb(surface: &Surface, tessellation: &Tessellation) -> Result<Vec<u8>, ExportError> {
    to_glb_with(surface, tessellation, None)
}

/// [`to_glb`] with the distances of the vertices of the tessellation from the mesh, in the unit of the surface, as `_DEVIATION`.
///
/// `_CURVATURE` is there always: both principal curvatures, the larger one first, in reciprocals of that unit; those of a sphere are
/// positive. Both are zero where the patch is singular.
///
/// # Errors
/// Those of [`to_glb`]; [`ExportError::Tessellation`] when there is not one distance per vertex.
pub fn to_glb_with(
    surface: &Surface,
    tessellation: &Tessellation,
    deviation: Option<&[f64]>,
) -> Result<Vec<u8>, ExportError> {
    let vertices = tessellation.mesh.positions.len();
    if let Some(d) = deviation.filter(|d| d.len() != vertices) {
        let reason = format!("there are {} deviations of {vertices} vertices", d.len());
        return Err(ExportError::Tessellation { reason });
    }
    let grouped = Grouped::new(surface, tessellation)?;
    let positions = &tessellation.mesh.positions;
    let (translation, local) = localise(positions, &grouped.vertex)?;
    let triangles: u64 = grouped.corners.iter().map(|g| g.len() as u64).sum();
    let bytes = 36 * local.len() as u64 + 12 * triangles;
    // The head is far below 2²⁰ bytes.
    if bytes + (1 << 20) > LIMIT {
        return Err(ExportError::TooLarge { bytes, limit: LIMIT });
    }
    let mut file = File::default();
    let corners = local.iter().flat_map(|p| p.to_array());
    let box_of = local
        .iter()
        .fold(None, |b: Option<[Vec3; 2]>, &p| Some(b.map_or([p; 2], |[lo, hi]| [lo.min(p), hi.max(p)])));
    let mut root = Root {
        asset: Asset {
            generator: Some(concat!("suture ", env!("CARGO_PKG_VERSION")).into()),
            ..Asset::default()
        },
        ..Root::default()
    };
    let mut primitives = Vec::new();
    if let Some([lo, hi]) = box_of.filter(|_| triangles > 0) {
        let point = file.view(&mut root, Some(12), Target::ArrayBuffer, corners.flat_map(f32::to_le_bytes));
        let point = accessor(&mut root, point, local.len(), ComponentType::F32, Type::Vec3);
        root.accessors[point.value()].min = Some(numbers(lo));
        root.accessors[point.value()].max = Some(numbers(hi));
        let normals = grouped.normals.iter().flat_map(|n| n.as_vec3().normalize_or(Vec3::Z).to_array());
        let normal = file.view(&mut root, Some(12), Target::ArrayBuffer, normals.flat_map(f32::to_le_bytes));
        let normal = accessor(&mut root, normal, local.len(), ComponentType::F32, Type::Vec3);
        let curvatures = grouped
            .place
            .iter()
            .flat_map(|&(id, at)| surface.patch(id).and_then(|p| curvatures(&p.jet(at))).unwrap_or_default());
        let bytes = curvatures.flat_map(f32::to_le_bytes);
        let curvature = file.view(&mut root, Some(8), Target::ArrayBuffer, bytes);
        let curvature = accessor(&mut root, curvature, local.len(), ComponentType::F32, Type::Vec2);
        let mut attributes = vec![
            (Valid(Semantic::Positions), point),
            (Valid(Semantic::Normals), normal),
            (Valid(Semantic::Extras("CURVATURE".into())), curvature),
        ];
        if let Some(d) = deviation {
            let bytes = grouped.vertex.iter().flat_map(|&v| finite(d[v as usize]).to_le_bytes());
            let view = file.view(&mut root, Some(4), Target::ArrayBuffer, bytes);
            let view = accessor(&mut root, view, local.len(), ComponentType::F32, Type::Scalar);
            attributes.push((Valid(Semantic::Extras("DEVIATION".into())), view));
        }
        for (group, triangles) in GROUPS.iter().zip(&grouped.corners).filter(|(_, t)| !t.is_empty()) {
            let indices = triangles.iter().flatten().flat_map(|i| i.to_le_bytes());
            let view = file.view(&mut root, None, Target::ElementArrayBuffer, indices);
            let indices = accessor(&mut root, view, 3 * triangles.len(), ComponentType::U32, Type::Scalar);
            let material = root.push(material(group));
            primitives.push(Primitive {
                attributes: attributes.iter().cloned().collect(),
                extensions: None,
                extras: Default::default(),
                indices: Some(indices),
                material: Some(material),
                mode: Valid(Mode::Triangles),
                targets: None,
            });
        }
        root.buffers.push(Buffer {
            byte_length: USize64::from(file.body.len()),
            name: None,
            uri: None,
            extensions: None,
            extras: Default::default(),
        });
        let mesh = root.push(Mesh {
            extensions: None,
            extras: Default::default(),
            name: Some("surface".into()),
            primitives,
            weights: None,
        });
        let node = root.push(Node {
            mesh: Some(mesh),
            name: Some("surface".into()),
            translation: Some(translation.to_array()),
            ..Node::default()
        });
        let scene =
            root.push(Scene { extensions: None, extras: Default::default(), name: None, nodes: vec![node] });
        root.scene = Some(scene);
    }
    file.assemble(&root)
}

/// The translation of the node, and the vertices relative to it.
fn localise(positions: &[DVec3], vertex: &[u32]) -> Result<(Vec3, Vec<Vec3>), ExportError> {
    let first = positions.first().copied().unwrap_or_default();
    let (lo, hi) = positions.iter().fold((first, first), |(lo, hi), &p| (lo.min(p), hi.max(p)));
    let translation = (0.5 * lo + 0.5 * hi).as_vec3();
    let local = |&v: &u32| {
        let p = positions[v as usize];
        let q = (p - translation.as_dvec3()).as_vec3();
        let value = p.to_array().into_iter().fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a });
        if q.is_finite() { Ok(q) } else { Err(ExportError::Range { vertex: v as usize, value }) }
    };
    Ok((translation, vertex.iter().map(local).collect::<Result<_, _>>()?))
}

/// The principal curvatures, those of a sphere positive.
fn curvatures(jet: &Jet2) -> Option<[f32; 2]> {
    let n = jet.normal()?;
    let [e, f, g] = [jet.du.length_squared(), jet.du.dot(jet.dv), jet.dv.length_squared()];
    let [l, m, k] = [jet.duu, jet.duv, jet.dvv].map(|d| -d.dot(n));
    let area = e * g - f * f;
    let (mean, gauss) = (0.5 * (e * k - 2.0 * f * m + g * l) / area, (l * k - m * m) / area);
    let root = (mean * mean - gauss).max(0.0).sqrt();
    Some([finite(mean + root), finite(mean - root)])
}

/// In 32 bits; zero for what they do not hold.
fn finite(x: f64) -> f32 {
    let x = x as f32;
    if x.is_finite() { x } else { 0.0 }
}

fn numbers(p: Vec3) -> gltf_json::Value {
    // Through f64, whose shortest digits read back to the same f32: the validator compares bits.
    p.to_array().map(f64::from).to_vec().into()
}

fn material(group: &Group) -> Material {
    let [r, g, b] = group.linear();
    Material {
        name: Some(group.name.into()),
        // Open surfaces are seen from both sides.
        double_sided: true,
        pbr_metallic_roughness: PbrMetallicRoughness {
            base_color_factor: PbrBaseColorFactor([r, g, b, 1.0]),
            metallic_factor: StrengthFactor(0.0),
            roughness_factor: StrengthFactor(0.5),
            ..PbrMetallicRoughness::default()
        },
        ..Material::default()
    }
}

fn accessor(
    root: &mut Root,
    view: Index<View>,
    count: usize,
    component: ComponentType,
    type_: Type,
) -> Index<Accessor> {
    root.push(Accessor {
        buffer_view: Some(view),
        byte_offset: None,
        count: USize64::from(count),
        component_type: Valid(GenericComponentType(component)),
        extensions: None,
        extras: Default::default(),
        type_: Valid(type_),
        min: None,
        max: None,
        name: None,
        normalized: false,
        sparse: None,
    })
}

/// The two chunks of the file.
#[derive(Default)]
struct File {
    body: Vec<u8>,
}

impl File {
    /// Appends the bytes, whose number is a multiple of four, as a buffer view.
    fn view(
        &mut self,
        root: &mut Root,
        stride: Option<usize>,
        target: Target,
        bytes: impl Iterator<Item = u8>,
    ) -> Index<View> {
        let start = self.body.len();
        self.body.extend(bytes);
        root.push(View {
            buffer: Index::new(0),
            byte_length: USize64::from(self.body.len() - start),
            byte_offset: Some(USize64::from(start)),
            byte_stride: stride.map(gltf_json::buffer::Stride),
            name: None,
            target: Some(Valid(target)),
            extensions: None,
            extras: Default::default(),
        })
    }

    /// Header, JSON chunk padded with spaces, binary chunk padded with zeros.
    fn assemble(mut self, root: &Root) -> Result<Vec<u8>, ExportError> {
        let mut head = root.to_vec()?;
        head.resize(head.len().next_multiple_of(4), b' ');
        self.body.resize(self.body.len().next_multiple_of(4), 0);
        let binary = if self.body.is_empty() { 0 } else { 8 + self.body.len() };
        let total = 20 + head.len() + binary;
        let count = |n: usize| {
            u32::try_from(n).map_err(|_| ExportError::TooLarge { bytes: total as u64, limit: LIMIT })
        };
        let mut out = Vec::with_capacity(total);
        out.extend(b"glTF");
        out.extend(2u32.to_le_bytes());
        out.extend(count(total)?.to_le_bytes());
        out.extend(count(head.len())?.to_le_bytes());
        out.extend(b"JSON");
        out.extend(head);
        if binary > 0 {
            out.extend(count(self.body.len())?.to_le_bytes());
            out.extend(b"BIN\0");
            out.extend(self.body);
        }
        Ok(out)
    }
}
