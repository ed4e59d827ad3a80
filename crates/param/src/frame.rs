//! The frame of the parameter plane: a choice that depends on the shape only.

use glam::{DVec2, DVec3};

use crate::ParamError;
use crate::distortion::check_uv;
use crate::sheet::Sheet;

/// Above this number of boundary vertices the farthest pair is found by sweeps instead of all pairs.
const ALL_PAIRS: usize = 2048;

/// Scales, moves and turns parameters: their area becomes the area in space, their centroid (weighted by area in space) the
/// origin, and the direction between the two boundary vertices farthest apart in space the u axis.
///
/// The one of the two that is farther from the centroid in space is on the negative side. Where several pairs are equally far
/// apart, coordinates decide; a rigid motion of such a symmetric shape may then turn the frame.
///
/// # Errors
/// [`ParamError::Length`], [`ParamError::NotFinite`], [`ParamError::NotDisc`] and [`ParamError::Collapsed`].
pub fn normalize(positions: &[DVec3], faces: &[[u32; 3]], uv: &mut [DVec2]) -> Result<(), ParamError> {
    let sheet = Sheet::new(positions, faces)?;
    check_uv(uv, positions.len())?;
    // Relative to the first point and its extent: exact where the parameters are far from the origin or very small.
    let origin = uv[0];
    let extent = uv.iter().map(|p| (*p - origin).abs().max_element()).fold(0.0, f64::max);
    if !(extent > 0.0 && extent.is_finite()) {
        return Err(ParamError::Collapsed { area: 0.0 });
    }
    for p in uv.iter_mut() {
        *p = (*p - origin) / extent;
    }
    let (mut area, mut total, mut centre) = (0.0, 0.0, DVec2::ZERO);
    for (f, flat) in faces.iter().zip(&sheet.flats) {
        let [a, b, c] = f.map(|v| uv[v as usize]);
        area += 0.5 * (b - a).perp_dot(c - a).abs();
        total += flat.area;
        centre += (a + b + c) * (flat.area / 3.0);
    }
    let scale = (total / area).sqrt() * sheet.scale;
    if !(scale > 0.0 && scale.is_finite()) {
        return Err(ParamError::Collapsed { area: area * extent * extent });
    }
    let [a, b] = farthest(&sheet);
    let axis = (uv[b] - uv[a]).try_normalize().unwrap_or(DVec2::X);
    centre /= total;
    for p in uv.iter_mut() {
        let q = *p - centre;
        *p = DVec2::new(axis.dot(q), axis.perp_dot(q)) * scale;
    }
    Ok(())
}

/// The two boundary vertices farthest apart in space; first the one that is farther from the area's centroid.
pub(crate) fn farthest(sheet: &Sheet<'_>) -> [usize; 2] {
    let b = &sheet.boundary;
    let x = |v: u32| sheet.x[v as usize];
    // Equal distances are decided by coordinates, so that the numbering never matters.
    let key = |p: DVec3| [p.x, p.y, p.z];
    let before = |p: DVec3, q: DVec3| key(p).partial_cmp(&key(q)) == Some(std::cmp::Ordering::Less);
    let better = |d: f64, pair: [u32; 2], best: f64, old: [u32; 2]| {
        d > best
            || (d == best
                && (before(x(pair[0]), x(old[0]))
                    || (x(pair[0]) == x(old[0]) && before(x(pair[1]), x(old[1])))))
    };
    let mut centre = DVec3::ZERO;
    for (f, t) in sheet.faces.iter().zip(&sheet.flats) {
        centre += f.map(x).into_iter().sum::<DVec3>() * (t.area / 3.0);
    }
    centre /= sheet.area();
    let mut pair = [b[0], b[1]];
    let mut best = -1.0;
    if b.len() <= ALL_PAIRS {
        for (i, &v) in b.iter().enumerate() {
            for &w in &b[i + 1..] {
                let candidate = if before(x(v), x(w)) { [v, w] } else { [w, v] };
                let d = x(v).distance_squared(x(w));
                if better(d, candidate, best, pair) {
                    (best, pair) = (d, candidate);
                }
            }
        }
    } else {
        let far = |from: DVec3| {
            b.iter().copied().fold((-1.0, b[0]), |(d, v), w| {
                let e = from.distance_squared(x(w));
                if e > d || (e == d && before(x(w), x(v))) { (e, w) } else { (d, v) }
            })
        };
        let (_, mut from) = far(centre);
        // Each sweep lengthens the pair; a few suffice and the bound keeps rounding errors from cycling.
        for _ in 0..16 {
            let (d, to) = far(x(from));
            if d <= best {
                break;
            }
            (best, pair, from) = (d, [from, to], to);
        }
    }
    let [a, b] = pair;
    let (da, db) = (x(a).distance_squared(centre), x(b).distance_squared(centre));
    // The comparison must not hang on the last bit of the centroid.
    let swap = if (da - db).abs() > 1e-9 * (da + db) { db > da } else { before(x(b), x(a)) };
    if swap { [b as usize, a as usize] } else { [a as usize, b as usize] }
}
