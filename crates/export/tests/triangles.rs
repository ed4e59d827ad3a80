//! glTF, OBJ, PLY and STL, read back.

mod common;

use common::*;
use glam::{DVec2, DVec3, Vec3};
use gltf_json::mesh::Semantic;
use gltf_json::validation::{Checked, Validate};
use suture_export::{ExportError, Format, to_glb, to_glb_with, to_mtl, to_obj, write};
use suture_mesh::TriMesh;
use suture_surface::{PatchId, Surface};
use suture_tessellate::{Tessellation, TessellationOptions, tessellate};

fn tessellated(surface: &Surface) -> Tessellation {
    tessellate(surface, &TessellationOptions::default()).unwrap()
}

struct Part {
    material: String,
    positions: Vec<DVec3>,
    normals: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

/// Reads a file as the specification has it, checking what it demands on the way.
fn read(bytes: &[u8]) -> Vec<Part> {
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!((&bytes[..4], word(4), word(8)), (&b"glTF"[..], 2, bytes.len()));
    let head = word(12);
    assert_eq!((&bytes[16..20], head % 4), (&b"JSON"[..], 0));
    let body = 20 + head;
    assert_eq!((&bytes[body + 4..body + 8], word(body) % 4), (&b"BIN\0"[..], 0));
    assert_eq!(body + 8 + word(body), bytes.len());
    let body = &bytes[body + 8..];
    let root = gltf_json::Root::from_slice(&bytes[20..20 + head]).unwrap();
    let mut faults = Vec::new();
    root.validate(&root, gltf_json::Path::new, &mut |path, error| {
        faults.push(format!("{}: {error}", path()))
    });
    assert!(faults.is_empty(), "{faults:?}");
    assert_eq!(root.buffers.len(), 1);
    assert!(root.buffers[0].byte_length.0 as usize <= body.len());

    let view = |accessor: usize, size: usize| {
        let accessor = &root.accessors[accessor];
        let view = &root.buffer_views[accessor.buffer_view.unwrap().value()];
        let start = view.byte_offset.map_or(0, |o| o.0) as usize;
        assert_eq!(start % 4, 0);
        assert_eq!(view.byte_length.0, accessor.count.0 * size as u64);
        body[start..start + view.byte_length.0 as usize]
            .chunks_exact(4)
            .map(|w| <[u8; 4]>::try_from(w).unwrap())
    };
    let vectors = |accessor: usize| -> Vec<Vec3> {
        let floats: Vec<f32> = view(accessor, 12).map(f32::from_le_bytes).collect();
        floats.chunks_exact(3).map(Vec3::from_slice).collect()
    };
    let node = &root.nodes[0];
    let shift = Vec3::from(node.translation.unwrap()).as_dvec3();
    let mesh = &root.meshes[node.mesh.unwrap().value()];
    mesh.primitives
        .iter()
        .map(|p| {
            let position = p.attributes[&Checked::Valid(Semantic::Positions)].value();
            let local = vectors(position);
            let bound = |v: &Option<gltf_json::Value>| -> [f32; 3] {
                serde_json::from_value(v.clone().unwrap()).unwrap()
            };
            let extreme = |f: fn(Vec3, Vec3) -> Vec3| local.iter().copied().reduce(f).unwrap().to_array();
            assert_eq!(bound(&root.accessors[position].min), extreme(Vec3::min));
            assert_eq!(bound(&root.accessors[position].max), extreme(Vec3::max));
            let normals = vectors(p.attributes[&Checked::Valid(Semantic::Normals)].value());
            assert!(normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-6));
            assert_eq!(normals.len(), local.len());
            let indices: Vec<u32> = view(p.indices.unwrap().value(), 4).map(u32::from_le_bytes).collect();
            assert!(indices.iter().all(|&i| (i as usize) < local.len()));
            Part {
                material: root.materials[p.material.unwrap().value()].name.clone().unwrap(),
                positions: local.iter().map(|p| p.as_dvec3() + shift).collect(),
                normals,
                triangles: indices.chunks_exact(3).map(|t| t.try_into().unwrap()).collect(),
            }
        })
        .collect()
}

#[test]
fn glb_holds_the_triangles_by_group() {
    let surface = two(1.0, DVec3::ZERO);
    let t = tessellated(&surface);
    let parts = read(&to_glb(&surface, &t).unwrap());
    assert_eq!(parts.iter().map(|p| p.material.as_str()).collect::<Vec<_>>(), ["trimmed", "nblend"]);
    let count = |patch| t.triangle_patch.iter().filter(|p| **p == PatchId(patch)).count();
    assert_eq!((parts[0].triangles.len(), parts[1].triangles.len()), (count(0), count(1)));
    // No crease: the vertices of the tessellation, in their order.
    assert_eq!(parts[0].positions.len(), t.mesh.positions.len());
    for (a, b) in parts[0].positions.iter().zip(&t.mesh.positions) {
        assert!(a.distance(*b) < 1e-6);
    }
}

#[test]
fn glb_holds_curvature_and_deviation() {
    let surface = two(1.0, DVec3::ZERO);
    let t = tessellated(&surface);
    let distances: Vec<f64> = (0..t.mesh.positions.len()).map(|i| i as f64 * 0.25).collect();
    let bytes = to_glb_with(&surface, &t, Some(&distances)).unwrap();
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let root: serde_json::Value = serde_json::from_slice(&bytes[20..20 + length]).unwrap();
    let body = &bytes[28 + length..];
    let floats = |name: &str| -> Vec<f32> {
        let accessor = root["meshes"][0]["primitives"][0]["attributes"][name].as_u64().unwrap();
        let view = root["accessors"][accessor as usize]["bufferView"].as_u64().unwrap();
        let view = &root["bufferViews"][view as usize];
        let at = view["byteOffset"].as_u64().unwrap_or(0) as usize;
        let bytes = &body[at..at + view["byteLength"].as_u64().unwrap() as usize];
        bytes.chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect()
    };
    let told: Vec<f32> = distances.iter().map(|&d| d as f32).collect();
    assert_eq!(floats("_DEVIATION"), told);
    let curvature = floats("_CURVATURE");
    assert_eq!(curvature.len(), 2 * told.len());
    for (i, pair) in curvature.chunks_exact(2).enumerate() {
        // From the shape operator in an orthonormal frame.
        let jet = surface.patch(t.vertex_patch[i]).unwrap().jet(t.vertex_parameter[i]);
        let n = jet.normal().unwrap();
        let (e, f, g) = (jet.du.dot(jet.du), jet.du.dot(jet.dv), jet.dv.dot(jet.dv));
        for &k in pair {
            let k = f64::from(k);
            let m = [jet.duu, jet.duv, jet.dvv].map(|d| -d.dot(n));
            let determinant = (m[0] - k * e) * (m[2] - k * g) - (m[1] - k * f).powi(2);
            assert!(determinant.abs() < 1e-5 * (1.0 + k * k) * (e * g), "{i} {k} {determinant}");
        }
        assert!(pair[0] >= pair[1]);
    }
    assert!(matches!(to_glb_with(&surface, &t, Some(&[0.0])), Err(ExportError::Tessellation { .. })));
}

#[test]
fn a_small_part_far_away_keeps_its_shape() {
    for power in [-20, 0, 20] {
        let s = 2f64.powi(power);
        let surface = two(s, DVec3::new(1e7, -3e6, 12345.678) * s);
        let t = tessellated(&surface);
        let parts = read(&to_glb(&surface, &t).unwrap());
        let size = 2.0 * s;
        for (a, b) in parts[0].positions.iter().zip(&t.mesh.positions) {
            // Half an ulp of f32 of coordinates about as large as the part (the node takes the rest), and f64 far away.
            assert!(a.distance(*b) < 2e-7 * size, "{:e}", a.distance(*b) / size);
        }
    }
}

#[test]
fn creases_have_a_normal_per_side() {
    let surface = roof();
    let t = tessellated(&surface);
    let on_crease = t.mesh.positions.iter().filter(|p| p.x == 0.0 && p.z == 0.0).count();
    let parts = read(&to_glb(&surface, &t).unwrap());
    assert_eq!(parts.len(), 1);
    assert_eq!(parts[0].positions.len(), t.mesh.positions.len() + on_crease);
    for (i, triangle) in parts[0].triangles.iter().enumerate() {
        let want = if t.triangle_patch[i] == PatchId(0) { Vec3::Z } else { Vec3::X };
        assert!(triangle.iter().all(|&v| parts[0].normals[v as usize].abs_diff_eq(want, 1e-6)), "{i}");
    }
}

#[test]
fn numbers_beyond_32_bits_are_refused() {
    let surface = two(1e40, DVec3::ZERO);
    let t = tessellated(&surface);
    assert!(matches!(to_glb(&surface, &t), Err(ExportError::Range { .. })));
}

#[test]
fn an_empty_tessellation_is_a_valid_empty_scene() {
    let none = Tessellation {
        mesh: TriMesh::default(),
        vertex_patch: vec![],
        vertex_parameter: vec![],
        triangle_patch: vec![],
        corner_parameters: vec![],
    };
    let bytes = to_glb(&Surface::default(), &none).unwrap();
    assert_eq!(bytes.len() % 4, 0);
    assert_eq!(u32::from_le_bytes(bytes[8..12].try_into().unwrap()) as usize, bytes.len());
}

#[test]
fn a_foreign_tessellation_is_refused() {
    let surface = two(1.0, DVec3::ZERO);
    let good = tessellated(&surface);
    let refused = |spoil: fn(&mut Tessellation)| {
        let mut t = good.clone();
        spoil(&mut t);
        match to_glb(&surface, &t) {
            Err(ExportError::Tessellation { reason }) => reason,
            other => panic!("{:?}", other.map(|b| b.len())),
        }
    };
    assert!(refused(|t| t.triangle_patch[3] = PatchId(2)).contains("triangle 3 lies on patch 2 of 2"));
    assert!(refused(|t| t.mesh.faces[1][2] = 1 << 30).contains("triangle 1 names vertex"));
    assert!(refused(|t| t.corner_parameters.truncate(1)).contains("corner_parameters has 1 entries"));
    assert!(refused(|t| t.mesh.positions[0].x = f64::NAN).contains("vertex 0 is not finite"));
    assert!(refused(|t| t.mesh.normals = Some(vec![])).contains("normals"));
    // Parameters are only evaluated, normals only replaced where they are none.
    let mut t = good.clone();
    t.vertex_parameter[0] = DVec2::splat(f64::NAN);
    t.mesh.normals = None;
    assert!(to_glb(&surface, &t).is_ok());
}

#[test]
fn obj_reads_back_to_the_bit() {
    for surface in [two(1.0 / 3.0, DVec3::new(1e6, 1e-9, 0.1)), roof()] {
        let t = tessellated(&surface);
        let text = String::from_utf8(to_obj(&surface, &t, Some("part.mtl")).unwrap()).unwrap();
        let vertices: Vec<DVec3> = text
            .lines()
            .filter_map(|l| l.strip_prefix("v "))
            .map(|l| DVec3::from_slice(&l.split(' ').map(|x| x.parse().unwrap()).collect::<Vec<_>>()))
            .collect();
        assert_eq!(vertices, t.mesh.positions);
        let normals = text.lines().filter(|l| l.starts_with("vn ")).count();
        let mut faces = Vec::new();
        for line in text.lines().filter_map(|l| l.strip_prefix("f ")) {
            faces.push(
                line.split(' ')
                    .map(|c| {
                        let (v, n) = c.split_once("//").unwrap();
                        assert!((1..=normals).contains(&n.parse().unwrap()));
                        v.parse::<u32>().unwrap() - 1
                    })
                    .collect::<Vec<_>>(),
            );
        }
        let mut want: Vec<Vec<u32>> = t.mesh.faces.iter().map(|f| f.to_vec()).collect();
        want.sort();
        faces.sort();
        assert_eq!(faces, want);
        let materials = to_mtl();
        for line in text.lines().filter_map(|l| l.strip_prefix("usemtl ")) {
            assert!(materials.lines().any(|l| l == format!("newmtl {line}")));
        }
        assert!(text.starts_with("mtllib part.mtl\n"));
    }
}

#[test]
fn files_are_written_by_extension() {
    let folder = tempfile::tempdir().unwrap();
    let surface = two(1.0, DVec3::ZERO);
    let t = tessellated(&surface);
    for name in ["a.glb", "b c.obj", "d.PLY", "e.stl", "f.suture.json"] {
        let path = folder.path().join(name);
        let format = Format::from_path(&path).unwrap();
        write(&path, format, &surface, Some(&t)).unwrap();
        assert!(std::fs::metadata(&path).unwrap().len() > 100, "{name}");
        let alone = write(&path, format, &surface, None);
        assert_eq!(alone.is_ok(), !format.needs_tessellation());
        if ["b c.obj", "d.PLY"].contains(&name) {
            let mesh = suture_mesh::io::read(&path).unwrap().mesh;
            assert_eq!(mesh.positions, t.mesh.positions, "{name}");
            assert_eq!(mesh.faces.len(), t.mesh.faces.len());
        }
    }
    let mut names: Vec<_> = std::fs::read_dir(folder.path())
        .unwrap()
        .map(|e| e.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    assert_eq!(names, ["a.glb", "b c.mtl", "b c.obj", "d.PLY", "e.stl", "f.suture.json"]);
}

#[test]
fn unknown_formats_and_folders_are_named() {
    for name in ["part.iges", "part.gltf", "part", ".glb", ""] {
        let e = Format::from_path(name).unwrap_err();
        assert!(
            matches!(&e, ExportError::UnknownFormat { .. }) && e.to_string().contains(".step, .glb, .obj"),
            "{e}"
        );
    }
    let path = std::path::Path::new("no/such/folder/a.json");
    let e = write(path, Format::Native, &Surface::default(), None).unwrap_err();
    assert!(matches!(e, ExportError::Io { .. }));
}
