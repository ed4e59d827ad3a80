//! Ironing of knife edges: fins, flipped slivers and crumples that no smooth surface can follow.

use glam::DVec3;

use crate::{Topology, TriMesh};

/// When edges are ironed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IronOptions {
    /// Dihedral angle between the normals of two faces, in radians, above which their edge is ironed. π and more irons nothing.
    pub sharpest: f64,
    /// Part of this angle below which every edge at a moved vertex is brought.
    pub rest: f64,
    /// Most sweeps over the vertices.
    pub sweeps: usize,
}

/// What ironing moved.
#[derive(Clone, Debug, PartialEq)]
pub struct Ironed {
    /// Positions of all vertices.
    pub positions: Vec<DVec3>,
    /// The vertices that moved, ascending.
    pub moved: Vec<u32>,
    /// How far the farthest of them moved.
    pub farthest: f64,
    /// Edges that are still sharper than wanted.
    pub left: usize,
}

/// Moves the vertices at edges sharper than wanted towards the mean of their neighbours, and those around them as long as that does not
/// suffice; every other vertex stays where it is. Vertices on borders stay as well.
///
/// Edges of machined shapes turn by 90°, those of scans by less; beyond 120° there are fins of two faces back to back, faces that
/// turned over, and crumples. A chart fitted there folds whatever its parameters are.
pub fn iron(mesh: &TriMesh, topology: &Topology, options: &IronOptions) -> Ironed {
    let mut ironed = Ironed { positions: mesh.positions.clone(), moved: Vec::new(), farthest: 0.0, left: 0 };
    let mut chosen = vec![false; mesh.positions.len()];
    let sharp = sharper(mesh, topology, &ironed.positions, options.sharpest);
    choose(&mut chosen, topology, &sharp);
    for sweep in 0..options.sweeps {
        let sharp: Vec<u32> = sharper(mesh, topology, &ironed.positions, options.rest * options.sharpest)
            .into_iter()
            .filter(|&h| chosen[topology.tail(h) as usize] || chosen[topology.head(h) as usize])
            .collect();
        if sharp.is_empty() {
            break;
        }
        if (sweep + 1) % PATIENCE == 0 {
            choose(&mut chosen, topology, &sharp);
        }
        let means: Vec<(usize, DVec3)> = (0..chosen.len())
            .filter(|&v| chosen[v] && !topology.is_boundary_vertex(v as u32))
            .filter_map(|v| Some((v, mean_of_neighbours(topology, &ironed.positions, v as u32)?)))
            .collect();
        for (v, mean) in means {
            ironed.positions[v] = ironed.positions[v].lerp(mean, STEP);
        }
    }
    let travelled = |v: usize| ironed.positions[v].distance(mesh.positions[v]);
    ironed.moved = (0..chosen.len() as u32).filter(|&v| travelled(v as usize) > 0.0).collect();
    ironed.farthest = ironed.moved.iter().map(|&v| travelled(v as usize)).fold(0.0, f64::max);
    ironed.left = sharper(mesh, topology, &ironed.positions, options.sharpest).len();
    ironed
}

/// How far a vertex moves towards the mean of its neighbours in a sweep: half way damps every wave of a triangle mesh.
const STEP: f64 = 0.5;
/// Sweeps after which the vertices around what is still sharp are moved as well.
const PATIENCE: usize = 5;

/// One half-edge of every edge whose faces turn by more than `angle`.
fn sharper(mesh: &TriMesh, topology: &Topology, positions: &[DVec3], angle: f64) -> Vec<u32> {
    let normal = |h: u32| {
        let [a, b, c] = mesh.faces[topology.face(h) as usize].map(|v| positions[v as usize]);
        (b - a).cross(c - a)
    };
    let turned = |a: DVec3, b: DVec3| a.cross(b).length().atan2(a.dot(b)) > angle;
    (0..topology.half_edge_count() as u32)
        .filter(|&h| topology.opposite(h).is_some_and(|o| h < o && turned(normal(h), normal(o))))
        .collect()
}

fn choose(chosen: &mut [bool], topology: &Topology, edges: &[u32]) {
    for &h in edges {
        for v in [topology.tail(h), topology.head(h)] {
            chosen[v as usize] = true;
        }
    }
}

fn mean_of_neighbours(topology: &Topology, positions: &[DVec3], v: u32) -> Option<DVec3> {
    let (sum, count) = topology.outgoing(v).fold((DVec3::ZERO, 0.0), |(sum, count), h| {
        (sum + positions[topology.head(h) as usize], count + 1.0)
    });
    (count > 0.0).then(|| sum / count)
}

#[cfg(test)]
mod tests {
    use super::*;

    const OPTIONS: IronOptions =
        IronOptions { sharpest: 120.0 * std::f64::consts::PI / 180.0, rest: 0.75, sweeps: 50 };

    /// A flat grid of `n × n` vertices.
    fn grid(n: usize) -> TriMesh {
        let positions = (0..n * n).map(|k| DVec3::new((k % n) as f64, (k / n) as f64, 0.0)).collect();
        let faces = (0..(n - 1) * (n - 1))
            .flat_map(|k| {
                let a = (k / (n - 1) * n + k % (n - 1)) as u32;
                let n = n as u32;
                [[a, a + 1, a + n], [a + 1, a + n + 1, a + n]]
            })
            .collect();
        TriMesh::new(positions, faces)
    }

    #[test]
    fn a_turned_face_is_laid_flat_and_the_rest_stays() {
        let mut mesh = grid(9);
        // Over its neighbour: the faces between them turn over.
        mesh.positions[40] = DVec3::new(5.6, 4.0, 0.1);
        let topology = Topology::build(&mesh).unwrap();
        assert!(!sharper(&mesh, &topology, &mesh.positions, OPTIONS.sharpest).is_empty());
        let ironed = iron(&mesh, &topology, &OPTIONS);
        assert_eq!(ironed.left, 0);
        assert!(ironed.moved.contains(&40) && ironed.moved.len() < 20, "{:?}", ironed.moved);
        assert!(ironed.farthest < 2.0);
        for v in (0..81u32).filter(|v| !ironed.moved.contains(v)) {
            assert_eq!(ironed.positions[v as usize], mesh.positions[v as usize]);
        }
    }

    #[test]
    fn right_angles_stay() {
        let mut mesh = grid(9);
        for p in &mut mesh.positions {
            *p = if p.x > 4.0 { DVec3::new(4.0, p.y, p.x - 4.0) } else { *p };
        }
        let topology = Topology::build(&mesh).unwrap();
        let ironed = iron(&mesh, &topology, &OPTIONS);
        assert!(ironed.moved.is_empty() && ironed.positions == mesh.positions);
    }
}
