//! Collars: discs whatever happens, the same under every numbering, complete around every interior vertex.

mod common;

use common::*;
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};
use suture_mesh::{Topology, TriMesh};
use suture_param::{CollarOptions, Disc, ParamError, disc_with_collar};

/// A disc, by a count that shares nothing with the implementation.
#[track_caller]
fn check(mesh: &TriMesh, disc: &Disc) {
    disc.check().unwrap();
    let mut directed = BTreeSet::new();
    let mut around: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for (f, face) in disc.faces.iter().enumerate() {
        let over = mesh.faces[disc.mesh_faces[f] as usize];
        assert_eq!(face.map(|v| disc.vertices[v as usize]), over, "corners keep their order");
        for k in 0..3 {
            assert!(directed.insert((face[k], face[(k + 1) % 3])));
            around.entry(face[k]).or_default().push(disc.mesh_faces[f]);
        }
    }
    let boundary: BTreeSet<u32> =
        directed.iter().filter(|&&(a, b)| !directed.contains(&(b, a))).map(|e| e.0).collect();
    let rim = directed.iter().filter(|&&(a, b)| !directed.contains(&(b, a))).count();
    assert_eq!(boundary.len(), rim, "every boundary vertex has one boundary edge ahead");
    assert_eq!(disc.boundary().unwrap().len(), rim, "one loop");
    let euler = disc.vertices.len() as i64 - ((directed.len() + rim) / 2) as i64 + disc.faces.len() as i64;
    assert_eq!(euler, 1);
    let mut valence = vec![0; mesh.positions.len()];
    mesh.faces.iter().flatten().for_each(|&v| valence[v as usize] += 1);
    for (v, faces) in around {
        let different: BTreeSet<_> = faces.iter().collect();
        assert_eq!(different.len(), faces.len(), "no face twice at one vertex");
        if !boundary.contains(&v) {
            assert_eq!(faces.len(), valence[disc.vertices[v as usize] as usize], "branch point");
        }
    }
}

/// Faces that touch the segment, `rings` times over: what a collar is where it does not meet itself.
fn rings_by_touch(mesh: &TriMesh, segment: &[u32], rings: usize) -> Vec<u32> {
    let mut faces: BTreeSet<u32> = segment.iter().copied().collect();
    for _ in 0..rings {
        let vertices: BTreeSet<u32> = faces.iter().flat_map(|&f| mesh.faces[f as usize]).collect();
        faces = (0..mesh.faces.len() as u32)
            .filter(|&f| mesh.faces[f as usize].iter().any(|v| vertices.contains(v)))
            .collect();
    }
    faces.into_iter().collect()
}

fn sorted(faces: &[u32]) -> Vec<u32> {
    let mut faces = faces.to_vec();
    faces.sort_unstable();
    faces
}

#[test]
fn octants_of_a_sphere_grow_the_rings_that_touch() {
    let mesh = sphere(4);
    for octant in 0..8u32 {
        let segment: Vec<u32> = (octant * 256..(octant + 1) * 256).collect();
        for rings in 0..=5 {
            let disc = disc(&mesh, &segment, rings);
            check(&mesh, &disc);
            assert_eq!(disc.rings, rings);
            assert_eq!(sorted(&disc.mesh_faces), rings_by_touch(&mesh, &segment, rings));
            assert_eq!(&disc.mesh_faces[..256], &segment[..]);
            assert_eq!(disc.segment_len(), 256);
        }
    }
}

#[test]
fn a_collar_around_most_of_a_sphere_stops_before_it_closes() {
    let mesh = sphere(3);
    let disc = disc(&mesh, &[0], 1000);
    check(&mesh, &disc);
    assert!(disc.rings > 8 && disc.faces.len() < mesh.faces.len());
    assert_eq!(sorted(&disc.mesh_faces).windows(2).filter(|w| w[0] == w[1]).count(), 0);
}

#[test]
fn a_notch_closes_and_a_gap_around_a_face_closes_too() {
    // C-shaped: a ring of faces around a vertex's surroundings, open at one side; the collar fills mouth and middle.
    let mesh = grid(9, 9, |x, y| DVec3::new(x, y, 0.02 * (x - 4.0) * (y - 5.0)));
    let at = |i: u32, j: u32| 2 * (j * 9 + i);
    for mouth in 2..=6 {
        let mut segment = Vec::new();
        for i in 2..=6 {
            for j in 2..=6 {
                let ring = i == 2 || i == 6 || j == 2 || j == 6;
                if ring && (i, j) != (6, mouth) {
                    segment.extend([at(i, j), at(i, j) + 1]);
                }
            }
        }
        for rings in 1..=3 {
            let disc = disc(&mesh, &segment, rings);
            check(&mesh, &disc);
            let touched = rings_by_touch(&mesh, &segment, rings);
            assert!(sorted(&disc.mesh_faces).windows(2).all(|w| w[0] <= w[1]));
            // One ring leaves the middle open, and the arms' collars lie on each other in the mouth; later rings close both.
            let expected =
                if rings == 1 { touched.len()..usize::MAX } else { touched.len()..touched.len() + 1 };
            assert!(
                expected.contains(&disc.faces.len()),
                "{mouth} {rings}: {} {}",
                disc.faces.len(),
                touched.len()
            );
        }
    }
}

/// Around a torus the collar unrolls: it has the faces of the same collar in the plane, over and over.
#[test]
fn a_collar_unrolls_a_torus() {
    let (m, n) = (7, 5);
    let mesh = torus(m, n);
    let segment = [0, 1, 2, 3];
    let size = 40;
    let mut plane = grid(size, size, |x, y| DVec3::new(x, y, 0.0));
    plane.faces = (0..size * size)
        .flat_map(|q| {
            let a = q / size * (size + 1) + q % size;
            [[a, a + 1, a + size + 2], [a, a + size + 2, a + size + 1]]
        })
        .collect();
    let middle = 2 * (20 * size + 20);
    let lifted: Vec<u32> = segment.iter().map(|f| middle + f).collect();
    for rings in 1..=8 {
        let disc = disc(&mesh, &segment, rings);
        check(&mesh, &disc);
        let mut expected: Vec<u32> = rings_by_touch(&plane, &lifted, rings)
            .into_iter()
            .map(|f| {
                let (i, j) = ((f / 2) % size + 70 - 20, (f / 2) / size + 50 - 20);
                2 * ((j % n) * m + i % m) + f % 2
            })
            .collect();
        expected.sort_unstable();
        assert_eq!(sorted(&disc.mesh_faces), expected, "{rings} rings");
        assert_eq!(disc.in_segment.iter().filter(|&&s| s).count(), 4);
    }
}

#[test]
fn collars_do_not_depend_on_numbering() {
    let mut cases = vec![(torus(9, 6), vec![vec![0, 1, 2, 3, 20, 21]], 5)];
    for (name, labels, rings) in [
        ("good/blobby.off", "labels/blobby.vor.labels", 5),
        ("good/eight.off", "labels/eight.vor.labels", 4),
        ("good/knot1.off", "labels/knot1.vor.labels", 4),
        ("good/fandisk.off", "labels/fandisk.dihedral25_raw.labels", 2),
    ] {
        if let (Some(mesh), Some(segments)) = (mesh(name), segments(labels)) {
            cases.push((mesh, segments, rings));
        }
    }
    for (mesh, segments, max_rings) in cases {
        let (other, _, faces) = renumbered(&mesh, 7);
        let (a, b) = (Topology::build(&mesh).unwrap(), Topology::build(&other).unwrap());
        for sharp in [25f64.to_radians(), std::f64::consts::PI] {
            let options = CollarOptions { max_rings, sharp, ..CollarOptions::default() };
            for segment in &segments {
                let mapped: Vec<u32> = segment.iter().map(|&f| faces[f as usize]).collect();
                let first = disc_with_collar(&mesh, &a, segment, &options);
                let second = disc_with_collar(&other, &b, &mapped, &options);
                match (first, second) {
                    (Ok(first), Ok(second)) => {
                        check(&mesh, &first);
                        check(&other, &second);
                        let renamed: Vec<u32> = first.mesh_faces.iter().map(|&f| faces[f as usize]).collect();
                        assert_eq!(sorted(&renamed), sorted(&second.mesh_faces));
                        assert_eq!((first.rings, first.reach), (second.rings, second.reach));
                    }
                    (Err(first), Err(second)) => assert_eq!(first, second),
                    (first, second) => panic!("{first:?} {second:?}"),
                }
            }
        }
    }
}

#[test]
fn the_width_is_reached_and_not_exceeded_by_more_than_a_ring() {
    let mesh = sphere(5);
    let topology = Topology::build(&mesh).unwrap();
    let segment: Vec<u32> = (0..1024).collect();
    let mut last = 0;
    for width in [0.0, 0.05, 0.1, 0.2, 0.4] {
        let options = CollarOptions { width, max_rings: 100, ..smooth() };
        let disc = disc_with_collar(&mesh, &topology, &segment, &options).unwrap();
        check(&mesh, &disc);
        let boundary = disc.boundary().unwrap();
        let reach = disc.reach.unwrap();
        assert!(reach > width && reach < width + 0.12, "{width}: {reach}");
        assert!(boundary.iter().all(|&v| disc.distance[v as usize] >= reach));
        assert!(boundary.iter().all(|&v| disc.distance[v as usize] < width + 0.2));
        assert!(disc.faces.len() > last);
        last = disc.faces.len();
        // Along edges is never shorter than through space.
        for (v, p) in disc.positions.iter().enumerate() {
            let straight = disc.faces[..1024]
                .iter()
                .flatten()
                .map(|&w| p.distance(disc.positions[w as usize]))
                .fold(f64::INFINITY, f64::min);
            assert!(disc.distance[v] >= straight - 1e-12);
        }
    }
}

/// A roof whose ridge ends in the middle: x beyond 5 is flat.
fn ridge() -> TriMesh {
    grid(10, 10, |x, y| DVec3::new(x, y, -0.8 * (y - 5.0).abs() * ((6.0 - x) / 4.0).clamp(0.0, 1.0)))
}

#[test]
fn collars_stop_at_sharp_edges_and_pass_beside_them() {
    // A sheet bent at a right angle.
    let bent = grid(8, 4, |x, y| DVec3::new(x.min(4.0), y, -(x - 4.0).max(0.0)));
    let topology = Topology::build(&bent).unwrap();
    let half: Vec<u32> = (0..32).flat_map(|q| [2 * q, 2 * q + 1]).filter(|f| f / 2 % 8 < 4).collect();
    let sharp = CollarOptions { sharp: 25f64.to_radians(), ..smooth() };
    let disc = disc_with_collar(&bent, &topology, &half, &sharp).unwrap();
    assert_eq!((disc.faces.len(), disc.rings, disc.reach), (32, 0, None));
    let disc = disc_with_collar(&bent, &topology, &half, &smooth()).unwrap();
    assert_eq!((disc.faces.len(), disc.rings, disc.reach), (56, 3, Some(3.0)));
    let mesh = ridge();
    let topology = Topology::build(&mesh).unwrap();
    // A segment that has the ridge's beginning on its boundary only at one vertex.
    let segment: Vec<u32> = (0..10).flat_map(|j| [2 * (j * 10), 2 * (j * 10) + 1]).collect();
    for rings in 1..=9 {
        let options =
            CollarOptions { max_rings: rings, sharp: 25f64.to_radians(), ..CollarOptions::default() };
        let disc = disc_with_collar(&mesh, &topology, &segment, &options).unwrap();
        check(&mesh, &disc);
        let crossed = |disc: &Disc| {
            let mut edges = BTreeMap::new();
            for (f, face) in disc.faces.iter().enumerate() {
                for k in 0..3 {
                    edges.insert((face[k], face[(k + 1) % 3]), f);
                }
            }
            let normal = |f: usize| mesh.area_vector(disc.mesh_faces[f] as usize).normalize();
            edges
                .iter()
                .filter_map(|(&(a, b), &f)| Some((f, *edges.get(&(b, a))?)))
                .filter(|&(f, g)| !(disc.in_segment[f] && disc.in_segment[g]))
                .map(|(f, g)| normal(f).angle_between(normal(g)))
                .fold(0.0, f64::max)
        };
        assert!(crossed(&disc) <= 25.01f64.to_radians(), "{rings}");
        let over = disc_with_collar(
            &mesh,
            &topology,
            &segment,
            &CollarOptions { sharp: std::f64::consts::PI, ..options },
        );
        assert!(crossed(&over.unwrap()) > 30f64.to_radians());
    }
}

#[test]
fn collars_cross_creases_that_are_short() {
    let mesh = ridge();
    let topology = Topology::build(&mesh).unwrap();
    let segment: Vec<u32> = (0..10).flat_map(|j| [2 * (j * 10), 2 * (j * 10) + 1]).collect();
    let cut = |sharp: f64, shortest: f64| {
        let options = CollarOptions { max_rings: 9, sharp, shortest, ..CollarOptions::default() };
        disc_with_collar(&mesh, &topology, &segment, &options).unwrap()
    };
    // The ridge is sharp over some four of the ten units.
    let angle = 25f64.to_radians();
    let (stopped, crossing) = (cut(angle, 0.0), cut(std::f64::consts::PI, 0.0));
    assert_ne!(stopped, crossing);
    assert_eq!(cut(angle, 2.0), stopped);
    assert_eq!(cut(angle, 6.0), crossing);
}

#[test]
fn collars_end_where_they_grow_too_much() {
    // Spikes all over: a collar goes around each on either side and unfolds like a tree.
    let spike = |x: f64, y: f64| if x % 5.0 == 2.0 && y % 5.0 == 2.0 { 1.0 } else { 0.0 };
    let mesh = grid(30, 30, |x, y| DVec3::new(x, y, spike(x, y)));
    let topology = Topology::build(&mesh).unwrap();
    let middle = 2 * (15 * 30 + 14);
    let cut = |growth: f64, max_rings: usize| {
        let options = CollarOptions { growth, max_rings, ..CollarOptions::default() };
        disc_with_collar(&mesh, &topology, &[middle], &options).unwrap()
    };
    let whole = cut(f64::INFINITY, 12);
    let part = cut(2.0, 12);
    assert!(part.rings < whole.rings, "{} {}", part.rings, whole.rings);
    assert_eq!(cut(f64::INFINITY, part.rings), part, "the rings up to there are the same");
    assert!(whole.faces.len() > mesh.faces.len());
    // Nothing on a sphere grows more than in the plane.
    let ball = suture_mesh::shapes::sphere(3);
    let topology = Topology::build(&ball).unwrap();
    let cut = |growth: f64| {
        disc_with_collar(&ball, &topology, &[0], &CollarOptions { growth, max_rings: 8, ..smooth() }).unwrap()
    };
    assert_eq!(cut(1.2), cut(f64::INFINITY));
}

#[test]
fn what_is_not_a_disc_is_refused() {
    let mesh = torus(8, 6);
    let topology = Topology::build(&mesh).unwrap();
    let cut = |faces: &[u32]| disc_with_collar(&mesh, &topology, faces, &smooth()).unwrap_err();
    assert_eq!(cut(&[]), ParamError::Empty);
    assert_eq!(cut(&[3, 96]), ParamError::FaceIndex { face: 96, faces: 96 });
    assert_eq!(cut(&[3, 4, 3]), ParamError::RepeatedFace { face: 3 });
    let band: Vec<u32> = (0..16).collect();
    assert!(matches!(cut(&band), ParamError::NotDisc { loops: 2, .. }));
    assert!(matches!(cut(&[0, 50]), ParamError::NotDisc { components: 2, .. }));
    let all: Vec<u32> = (0..96).collect();
    assert!(matches!(cut(&all), ParamError::NotDisc { loops: 0, euler: 0, .. }));
    for (option, options) in [
        ("width", CollarOptions { width: f64::NAN, ..smooth() }),
        ("sharp", CollarOptions { sharp: 4.0, ..smooth() }),
        ("shortest", CollarOptions { shortest: -1.0, ..smooth() }),
        ("growth", CollarOptions { growth: 0.5, ..smooth() }),
    ] {
        let error = disc_with_collar(&mesh, &topology, &[0], &options).unwrap_err();
        assert!(matches!(error, ParamError::Option { option: o, .. } if o == option));
    }
    let other = torus(5, 5);
    assert!(matches!(disc_with_collar(&other, &topology, &[0], &smooth()), Err(ParamError::Length { .. })));
    let mut broken = mesh.clone();
    broken.positions[0].x = f64::NAN;
    let error = disc_with_collar(&broken, &topology, &[0], &smooth()).unwrap_err();
    assert!(matches!(error, ParamError::NotFinite { vertex: 0, .. }));
    // A double torus unrolls exponentially: the limit ends it.
    let wide = CollarOptions { max_rings: usize::MAX, ..smooth() };
    let error = disc_with_collar(&mesh, &topology, &[0], &wide).unwrap_err();
    assert!(matches!(error, ParamError::CollarTooLarge { .. }));
}
