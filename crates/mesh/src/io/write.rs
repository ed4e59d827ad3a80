//! Writers.

use std::{
    fmt, io,
    io::{BufWriter, Write},
    path::Path,
};

use glam::DVec3;

use super::{MeshFormat, atomic_write};
use crate::{
    MeshError, TriMesh,
    measure::{cross, longest_edge, positive, unit},
};

/// How to write a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WriteOptions {
    /// The format; by default what the extension names.
    pub format: Option<MeshFormat>,
    /// Text instead of binary, for PLY and STL. Off by default: text is three times as large.
    pub ascii: bool,
}

/// Writes a mesh in the format that the extension names, atomically (see [`atomic_write`]).
///
/// OBJ, OFF and PLY return the mesh to the bit, normals included; STL rounds to 32 bits and drops shared vertices, normals of
/// vertices and unused vertices.
///
/// # Errors
/// [`MeshError::UnknownFormat`], [`MeshError::Io`], and what [`write_to`] refuses.
pub fn write(path: impl AsRef<Path>, mesh: &TriMesh) -> Result<(), MeshError> {
    write_with(path, mesh, WriteOptions::default())
}

/// [`write()`] with options.
///
/// # Errors
/// As for [`write()`].
pub fn write_with(path: impl AsRef<Path>, mesh: &TriMesh, options: WriteOptions) -> Result<(), MeshError> {
    let path = path.as_ref();
    let format = options
        .format
        .or_else(|| MeshFormat::from_extension(path))
        .ok_or_else(|| MeshError::UnknownFormat { path: path.to_owned() })?;
    validate(mesh, format)?;
    atomic_write(path, |out| write_body(out, mesh, format, options.ascii)).map_err(|source| MeshError::Io {
        action: "write",
        path: path.to_owned(),
        source,
    })
}

/// Writes a mesh as binary PLY with an sRGB colour for every face, atomically.
///
/// # Errors
/// [`MeshError::ColourCount`], and as for [`write()`].
pub fn write_coloured_ply(
    path: impl AsRef<Path>,
    mesh: &TriMesh,
    colours: &[[u8; 3]],
) -> Result<(), MeshError> {
    let path = path.as_ref();
    validate(mesh, MeshFormat::Ply)?;
    if colours.len() != mesh.faces.len() {
        return Err(MeshError::ColourCount { colours: colours.len(), faces: mesh.faces.len() });
    }
    atomic_write(path, |out| ply_binary(out, mesh, Some(colours))).map_err(|source| MeshError::Io {
        action: "write",
        path: path.to_owned(),
        source,
    })
}

/// Writes a mesh to `out`, buffered.
///
/// # Errors
/// Refuses what the readers would refuse: [`MeshError::NoFaces`], [`MeshError::VertexIndex`], [`MeshError::NormalCount`],
/// [`MeshError::NotWritable`]; and [`MeshError::Io`], with `the output` for its path.
pub fn write_to(
    out: impl Write,
    mesh: &TriMesh,
    format: MeshFormat,
    options: WriteOptions,
) -> Result<(), MeshError> {
    validate(mesh, format)?;
    let mut out = BufWriter::new(out);
    write_body(&mut out, mesh, format, options.ascii)
        .and_then(|()| out.flush())
        .map_err(|source| MeshError::Io { action: "write", path: "the output".into(), source })
}

fn validate(mesh: &TriMesh, format: MeshFormat) -> Result<(), MeshError> {
    let vertices = mesh.positions.len();
    if mesh.faces.is_empty() {
        return Err(MeshError::NoFaces { format, vertices });
    }
    for (face, corners) in mesh.faces.iter().enumerate() {
        if let Some(&vertex) = corners.iter().find(|&&v| v as usize >= vertices) {
            return Err(MeshError::VertexIndex { face, vertex, vertices });
        }
    }
    let normals = mesh.normals.as_deref().unwrap_or_default();
    if mesh.normals.is_some() && normals.len() != vertices {
        return Err(MeshError::NormalCount { normals: normals.len(), vertices });
    }
    let precision = if format == MeshFormat::Stl { "32-bit" } else { "64-bit" };
    let writable = |x: f64| if format == MeshFormat::Stl { (x as f32).is_finite() } else { x.is_finite() };
    for list in [&mesh.positions, normals] {
        for (vertex, p) in list.iter().enumerate() {
            if let Some(value) = p.to_array().into_iter().find(|&x| !writable(x)) {
                return Err(MeshError::NotWritable { format, vertex, value, precision });
            }
        }
    }
    Ok(())
}

fn write_body(out: &mut dyn Write, mesh: &TriMesh, format: MeshFormat, ascii: bool) -> io::Result<()> {
    match (format, ascii) {
        (MeshFormat::Obj, _) => obj(out, mesh),
        (MeshFormat::Off, _) => off(out, mesh),
        (MeshFormat::Ply, true) => ply_ascii(out, mesh),
        (MeshFormat::Ply, false) => ply_binary(out, mesh, None),
        (MeshFormat::Stl, true) => stl_ascii(out, mesh),
        (MeshFormat::Stl, false) => stl_binary(out, mesh),
    }
}

/// Shortest digits that read back to the bit; with an exponent where plain digits would be long.
struct Exact(f64);

impl fmt::Display for Exact {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = self.0.abs();
        if size == 0.0 || (1e-5..1e16).contains(&size) {
            write!(f, "{}", self.0)
        } else {
            write!(f, "{:e}", self.0)
        }
    }
}

struct Triple(DVec3);

impl fmt::Display for Triple {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {} {}", Exact(self.0.x), Exact(self.0.y), Exact(self.0.z))
    }
}

fn obj(out: &mut dyn Write, mesh: &TriMesh) -> io::Result<()> {
    for &p in &mesh.positions {
        writeln!(out, "v {}", Triple(p))?;
    }
    for &n in mesh.normals.iter().flatten() {
        writeln!(out, "vn {}", Triple(n))?;
    }
    for face in &mesh.faces {
        let [a, b, c] = face.map(|v| u64::from(v) + 1);
        if mesh.normals.is_some() {
            writeln!(out, "f {a}//{a} {b}//{b} {c}//{c}")?;
        } else {
            writeln!(out, "f {a} {b} {c}")?;
        }
    }
    Ok(())
}

fn off(out: &mut dyn Write, mesh: &TriMesh) -> io::Result<()> {
    let keyword = if mesh.normals.is_some() { "NOFF" } else { "OFF" };
    writeln!(out, "{keyword}\n{} {} 0", mesh.positions.len(), mesh.faces.len())?;
    text_vertices(out, mesh)?;
    text_faces(out, mesh)
}

fn text_vertices(out: &mut dyn Write, mesh: &TriMesh) -> io::Result<()> {
    for (v, &p) in mesh.positions.iter().enumerate() {
        match &mesh.normals {
            Some(normals) => writeln!(out, "{} {}", Triple(p), Triple(normals[v]))?,
            None => writeln!(out, "{}", Triple(p))?,
        }
    }
    Ok(())
}

fn text_faces(out: &mut dyn Write, mesh: &TriMesh) -> io::Result<()> {
    for [a, b, c] in &mesh.faces {
        writeln!(out, "3 {a} {b} {c}")?;
    }
    Ok(())
}

fn ply_header(out: &mut dyn Write, mesh: &TriMesh, encoding: &str, coloured: bool) -> io::Result<()> {
    writeln!(out, "ply\nformat {encoding} 1.0\nelement vertex {}", mesh.positions.len())?;
    let names: &[&str] =
        if mesh.normals.is_some() { &["x", "y", "z", "nx", "ny", "nz"] } else { &["x", "y", "z"] };
    for name in names {
        writeln!(out, "property double {name}")?;
    }
    // Many readers know only `int` here.
    let index = if mesh.positions.len() > i32::MAX as usize { "uint" } else { "int" };
    writeln!(out, "element face {}\nproperty list uchar {index} vertex_indices", mesh.faces.len())?;
    if coloured {
        writeln!(out, "property uchar red\nproperty uchar green\nproperty uchar blue")?;
    }
    writeln!(out, "end_header")
}

fn ply_ascii(out: &mut dyn Write, mesh: &TriMesh) -> io::Result<()> {
    ply_header(out, mesh, "ascii", false)?;
    text_vertices(out, mesh)?;
    text_faces(out, mesh)
}

fn ply_binary(out: &mut dyn Write, mesh: &TriMesh, colours: Option<&[[u8; 3]]>) -> io::Result<()> {
    ply_header(out, mesh, "binary_little_endian", colours.is_some())?;
    for (v, p) in mesh.positions.iter().enumerate() {
        let normal = mesh.normals.as_ref().map(|n| n[v]);
        for x in std::iter::once(*p).chain(normal).flat_map(|p| p.to_array()) {
            out.write_all(&x.to_le_bytes())?;
        }
    }
    for (f, face) in mesh.faces.iter().enumerate() {
        out.write_all(&[3])?;
        for v in face {
            out.write_all(&v.to_le_bytes())?;
        }
        out.write_all(colours.map_or(&[], |c| &c[f]))?;
    }
    Ok(())
}

/// The corners of a facet and its unit normal, or zero where it has none.
fn facet(mesh: &TriMesh, f: usize) -> [DVec3; 4] {
    let corners = mesh.corners(f);
    let normal = unit(cross(corners, positive(longest_edge(corners)))).unwrap_or_default();
    let [a, b, c] = corners;
    [normal, a, b, c]
}

fn stl_binary(out: &mut dyn Write, mesh: &TriMesh) -> io::Result<()> {
    let facets = u32::try_from(mesh.faces.len())
        .map_err(|_| io::Error::new(io::ErrorKind::InvalidInput, "STL cannot count this many facets"))?;
    let mut header = [b' '; 80];
    // Not "solid": readers take that for text.
    let title = b"binary STL";
    header[..title.len()].copy_from_slice(title);
    out.write_all(&header)?;
    out.write_all(&facets.to_le_bytes())?;
    for f in 0..mesh.faces.len() {
        for x in facet(mesh, f).iter().flat_map(|p| p.to_array()) {
            out.write_all(&(x as f32).to_le_bytes())?;
        }
        out.write_all(&[0, 0])?;
    }
    Ok(())
}

fn stl_ascii(out: &mut dyn Write, mesh: &TriMesh) -> io::Result<()> {
    writeln!(out, "solid mesh")?;
    for f in 0..mesh.faces.len() {
        let [n, a, b, c] = facet(mesh, f);
        writeln!(out, "facet normal {}\n outer loop", Triple(n))?;
        for p in [a, b, c] {
            writeln!(out, "  vertex {}", Triple(p.as_vec3().as_dvec3()))?;
        }
        writeln!(out, " endloop\nendfacet")?;
    }
    writeln!(out, "endsolid mesh")
}
