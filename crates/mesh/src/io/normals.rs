//! One normal per vertex out of many.

use glam::DVec3;

use crate::measure::unit;

/// The common direction of `normals`: the normal itself, bit for bit, where all are equal; otherwise the unit vector along the sum
/// of the unit vectors, or `None` where they cancel or one of them has no direction.
pub(crate) fn mean_normal(normals: &[DVec3]) -> Option<DVec3> {
    let (&first, rest) = normals.split_first()?;
    if rest.iter().all(|&n| n == first) {
        return Some(first);
    }
    let mut sum = DVec3::ZERO;
    for n in normals {
        sum += unit(*n)?;
    }
    // Units that cancel leave rounding errors of their sum, which are no direction.
    (sum.length() > 16.0 * f64::EPSILON * normals.len() as f64).then(|| sum.normalize())
}
