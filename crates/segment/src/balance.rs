//! Corners whose arcs leave too close to each other.

use std::f64::consts::TAU;

use glam::{DQuat, DVec3};
use suture_mesh::{Topology, TriMesh, vertex_normals_area_weighted};

use crate::fair::nearest;
use crate::{MeshPoint, Segmentation};

/// Turns arcs about corners with sectors below `least` (radians), within `radius` of the corner and fading out there, until no
/// sector is: blends need room between the arcs, and on a coarse mesh neighbouring edges leave little. `lines` holds every arc from
/// corner to corner as [`fair_arcs`](crate::fair_arcs) draws them. Sectors that cannot all be as wide get equal ones.
///
/// # Panics
/// When the lines do not belong to the segmentation.
pub fn balance_corners(
    mesh: &TriMesh,
    topology: &Topology,
    segmentation: &Segmentation,
    lines: &mut [Vec<MeshPoint>],
    radius: f64,
    least: f64,
) {
    let normals = vertex_normals_area_weighted(mesh);
    for corner in &segmentation.corners {
        let origin = mesh.positions[corner.vertex as usize];
        let normal = normals[corner.vertex as usize];
        if normal == DVec3::ZERO {
            continue;
        }
        let e1 = normal.any_orthonormal_vector();
        let e2 = normal.cross(e1);
        let reaches: Vec<f64> =
            corner.arcs.iter().map(|end| radius.min(MOST_OF_ARC * length(&lines[end.arc]))).collect();
        let directions: Vec<f64> = corner
            .arcs
            .iter()
            .zip(&reaches)
            .map(|(end, &reach)| {
                let d = walk(&lines[end.arc], end.forward, 0.5 * reach) - origin;
                d.dot(e2).atan2(d.dot(e1))
            })
            .collect();
        let Some(turns) = turns(&directions, least) else { continue };
        for ((end, &reach), turn) in corner.arcs.iter().zip(&reaches).zip(turns) {
            let line = &mut lines[end.arc];
            let count = line.len();
            let mut travelled = 0.0;
            let mut previous = origin;
            for k in 1..count - 1 {
                let index = if end.forward { k } else { count - 1 - k };
                let point = line[index];
                travelled += previous.distance(point.position);
                previous = point.position;
                if travelled >= reach {
                    break;
                }
                let u = travelled / reach;
                let fade = 1.0 - u * u * u * (10.0 - 15.0 * u + 6.0 * u * u);
                let turned = DQuat::from_axis_angle(normal, turn * fade) * (point.position - origin);
                line[index] = nearest(mesh, topology, point.face, origin + turned);
            }
        }
    }
}

/// Largest part of an arc that is turned about either of its corners.
const MOST_OF_ARC: f64 = 0.45;

fn length(line: &[MeshPoint]) -> f64 {
    line.windows(2).map(|w| w[0].position.distance(w[1].position)).sum()
}

/// The point at arc length `at` from one end.
fn walk(line: &[MeshPoint], forward: bool, at: f64) -> DVec3 {
    let point = |k: usize| line[if forward { k } else { line.len() - 1 - k }].position;
    let mut travelled = 0.0;
    for k in 1..line.len() {
        let step = point(k).distance(point(k - 1));
        if travelled + step >= at && step > 0.0 {
            return point(k - 1).lerp(point(k), (at - travelled) / step);
        }
        travelled += step;
    }
    point(line.len() - 1)
}

/// By how much each direction turns so that no sector is below `least`: narrow sectors take from wide ones what they lack, and the
/// turns sum to zero. `None` where that is so already, or where the directions are not in counter-clockwise order.
fn turns(directions: &[f64], least: f64) -> Option<Vec<f64>> {
    let n = directions.len();
    let sectors: Vec<f64> =
        (0..n).map(|i| (directions[(i + 1) % n] - directions[i]).rem_euclid(TAU)).collect();
    let least = least.min(TAU / n as f64);
    let once = (sectors.iter().sum::<f64>() - TAU).abs() < 1e-6;
    if !once || sectors.iter().all(|&a| a >= least) {
        return None;
    }
    let lacking: f64 = sectors.iter().map(|a| (least - a).max(0.0)).sum();
    let spare: f64 = sectors.iter().map(|a| (a - least).max(0.0)).sum();
    let given = if spare > 0.0 { lacking / spare } else { 0.0 };
    let mut turns = vec![0.0; n];
    for i in 1..n {
        let a = sectors[i - 1];
        let wanted = if a < least { least } else { a - given * (a - least) };
        turns[i] = turns[i - 1] + wanted - a;
    }
    let mean = turns.iter().sum::<f64>() / n as f64;
    turns.iter_mut().for_each(|t| *t -= mean);
    Some(turns)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn narrow_sectors_are_opened() {
        let degrees = |d: &[f64]| d.iter().map(|x| x.to_radians()).collect::<Vec<_>>();
        let least = 50f64.to_radians();
        for directions in
            [&[0.0, 20.0, 200.0][..], &[10.0, 30.0, 45.0, 200.0], &[0.0, 5.0, 10.0, 15.0, 20.0, 25.0]]
        {
            let directions = degrees(directions);
            let turns = turns(&directions, least).unwrap();
            assert!(turns.iter().sum::<f64>().abs() < 1e-12);
            let n = directions.len();
            let new: Vec<f64> = directions.iter().zip(&turns).map(|(d, t)| d + t).collect();
            let sectors: Vec<f64> = (0..n).map(|i| (new[(i + 1) % n] - new[i]).rem_euclid(TAU)).collect();
            assert!(sectors.iter().all(|&a| a > least - 1e-12), "{sectors:?}");
            assert!((sectors.iter().sum::<f64>() - TAU).abs() < 1e-9, "{sectors:?}");
        }
        assert_eq!(turns(&degrees(&[0.0, 100.0, 200.0]), least), None, "wide enough");
        assert_eq!(turns(&degrees(&[0.0, 200.0, 100.0]), least), None, "clockwise");
    }
}
