//! Colours that tell charts apart.

use std::collections::BTreeSet;

use crate::Segmentation;

/// A small number for every chart, another one than those of all charts that it shares a corner with: the index of a colour.
///
/// Greedy in the order of the charts (Welsh and Powell, 1967), so that there are at most one more colours than charts around any one.
pub fn colouring(segmentation: &Segmentation) -> Vec<usize> {
    let mut beside: Vec<BTreeSet<usize>> = vec![BTreeSet::new(); segmentation.charts.len()];
    for corner in 0..segmentation.corners.len() {
        let around = segmentation.segments(corner);
        for &a in &around {
            beside[a as usize].extend(around.iter().map(|&b| b as usize).filter(|&b| b != a as usize));
        }
    }
    let mut colours: Vec<usize> = Vec::with_capacity(beside.len());
    for near in &beside {
        let taken: BTreeSet<usize> = near.iter().filter_map(|&n| colours.get(n).copied()).collect();
        colours.push((0..=taken.len()).find(|c| !taken.contains(c)).unwrap_or(taken.len()));
    }
    colours
}

#[cfg(test)]
mod tests {
    use suture_mesh::{Topology, shapes};

    use super::*;

    #[test]
    fn neighbours_have_different_colours() {
        // One chart per triangle of an icosahedron: those around a vertex all differ.
        let mesh = shapes::sphere(0);
        let topology = Topology::build(&mesh).unwrap();
        let labels: Vec<u32> = (0..20).collect();
        let segmentation = Segmentation::from_labels(&mesh, &topology, &labels).unwrap();
        let colours = colouring(&segmentation);
        for corner in 0..segmentation.corners.len() {
            let mut around: Vec<usize> =
                segmentation.segments(corner).iter().map(|&s| colours[s as usize]).collect();
            around.sort_unstable();
            around.dedup();
            assert_eq!(around.len(), 5);
        }
        assert!(colours.iter().all(|&c| c < 10), "{colours:?}");
    }
}
