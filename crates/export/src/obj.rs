//! Wavefront OBJ with materials.

use std::fmt::Write;

use glam::DVec3;
use suture_surface::Surface;
use suture_tessellate::Tessellation;

use crate::ExportError;
use crate::group::{GROUPS, Grouped};

/// The tessellation as a Wavefront OBJ file: positions and normals in digits that read back to the same bits, vertices in the order of
/// the tessellation, triangles sorted by group of patches with a `g` and a `usemtl` line each; `materials` is the name of the
/// material file ([`to_mtl`]) that the file refers to, if any.
///
/// # Errors
/// [`ExportError::Tessellation`].
pub fn to_obj(
    surface: &Surface,
    tessellation: &Tessellation,
    materials: Option<&str>,
) -> Result<Vec<u8>, ExportError> {
    let grouped = Grouped::new(surface, tessellation)?;
    let mut out = String::new();
    let mut line = |text: std::fmt::Arguments<'_>| {
        // Writing to a string cannot fail.
        let _ = out.write_fmt(text);
        out.push('\n');
    };
    if let Some(name) = materials {
        line(format_args!("mtllib {name}"));
    }
    for &p in &tessellation.mesh.positions {
        line(format_args!("v {}", Triple(p)));
    }
    for &n in &grouped.normals {
        line(format_args!("vn {}", Triple(n)));
    }
    for (group, triangles) in GROUPS.iter().zip(&grouped.corners).filter(|(_, t)| !t.is_empty()) {
        line(format_args!("g {}", group.name));
        if materials.is_some() {
            line(format_args!("usemtl {}", group.name));
        }
        for triangle in triangles {
            let [a, b, c] = triangle.map(|n| (u64::from(grouped.vertex[n as usize]) + 1, u64::from(n) + 1));
            line(format_args!("f {}//{} {}//{} {}//{}", a.0, a.1, b.0, b.1, c.0, c.1));
        }
    }
    Ok(out.into_bytes())
}

/// The materials of all groups of patches.
pub fn to_mtl() -> String {
    let mut out = String::new();
    for group in &GROUPS {
        let [r, g, b] = group.colour.map(|c| f64::from(c) / 255.0);
        let _ = writeln!(
            out,
            "newmtl {}\nKa 0 0 0\nKd {r:.4} {g:.4} {b:.4}\nKs 0.2 0.2 0.2\nNs 40\nillum 2\n",
            group.name
        );
    }
    out
}

/// Shortest digits that read back to the bit, with an exponent where plain digits would be long.
struct Triple(DVec3);

impl std::fmt::Display for Triple {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for (i, x) in self.0.to_array().into_iter().enumerate() {
            let gap = if i == 0 { "" } else { " " };
            let size = x.abs();
            if size == 0.0 || (1e-5..1e16).contains(&size) {
                write!(f, "{gap}{x}")?;
            } else {
                write!(f, "{gap}{x:e}")?;
            }
        }
        Ok(())
    }
}
