//! The direction that sees a set of directions best.

use glam::DVec3;

use crate::measure::unit;

/// Exchanges of the directions on the rim: each makes the cap larger, so that few are ever needed.
const EXCHANGES: usize = 200;

/// How much further from the centre than the rim a direction may lie, in cosines.
const SLACK: f64 = 1e-14;

/// Centre of the smallest cap around directions of unit length, and its least cosine to any of them: the unit vector that has the largest
/// angle to them as small as it can be. `None` where no half space contains them all (or there are none, or they are not finite).
///
/// # References
/// E. Welzl, *Smallest enclosing disks (balls and ellipsoids)*, 1991: two or three directions determine the cap; the farthest is exchanged.
pub fn smallest_cap(directions: &[DVec3]) -> Option<(DVec3, f64)> {
    let farthest = |c: DVec3| directions.iter().copied().min_by(|a, b| a.dot(c).total_cmp(&b.dot(c)));
    let mut rim = vec![*directions.first()?];
    let mut cap = rim.first().map(|&d| (d, 1.0))?;
    for _ in 0..EXCHANGES {
        let next = farthest(cap.0)?;
        if next.dot(cap.0) >= cap.1 - SLACK {
            break;
        }
        rim.push(next);
        cap = around(&rim)?;
        // Three on the rim determine it, the new one among them.
        rim.sort_by(|a, b| a.dot(cap.0).total_cmp(&b.dot(cap.0)));
        rim.truncate(3);
    }
    let least = farthest(cap.0)?.dot(cap.0);
    (least > 0.0).then_some((cap.0, least))
}

/// The smallest cap around few directions, by trying all pairs and triples.
fn around(all: &[DVec3]) -> Option<(DVec3, f64)> {
    let mut best: Option<(DVec3, f64)> = None;
    let mut offer = |d: Option<DVec3>| {
        let Some(d) = d else { return };
        let least = all.iter().fold(f64::INFINITY, |m, v| m.min(v.dot(d)));
        if best.is_none_or(|b| least > b.1) {
            best = Some((d, least));
        }
    };
    for i in 0..all.len() {
        for j in 0..i {
            offer(unit(all[i] + all[j]));
            for k in 0..j {
                let d = unit((all[i] - all[j]).cross(all[j] - all[k]));
                offer(d);
                offer(d.map(|d| -d));
            }
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn no_direction_sees_more(
            around in prop::array::uniform3(-1.0..1.0f64), spread in 0.05..2.0f64,
            all in prop::collection::vec(prop::array::uniform3(-1.0..1.0f64), 1..30),
            others in prop::collection::vec(prop::array::uniform3(-1.0..1.0f64), 50),
        ) {
            let Some(axis) = unit(DVec3::from_array(around)) else { return Ok(()) };
            let all: Vec<DVec3> = all.into_iter().filter_map(|d| unit(axis + spread * DVec3::from_array(d))).collect();
            let least = |c: DVec3| all.iter().fold(f64::INFINITY, |m, d| m.min(d.dot(c)));
            let others = others.into_iter().filter_map(|d| unit(DVec3::from_array(d)));
            match smallest_cap(&all) {
                Some((c, cosine)) => {
                    prop_assert!((least(c) - cosine).abs() < 1e-15 && cosine > 0.0);
                    // Far ones, and those beside it.
                    for d in others {
                        for share in [1.0, 1e-2, 1e-4] {
                            prop_assert!(least(unit(c + share * d).unwrap_or(c)) <= cosine + 1e-12);
                        }
                    }
                }
                None => prop_assert!(others.chain([axis]).all(|d| least(d) <= 1e-12)),
            }
        }
    }

    #[test]
    fn folded_faces_are_seen_from_the_side_and_opposite_ones_not_at_all() {
        let fold = [DVec3::Z, DVec3::new(0.02, 0.0, -1.0).normalize()];
        let (c, least) = smallest_cap(&fold).unwrap();
        assert!(c.distance(DVec3::X) < 0.02 && (least - 0.01).abs() < 1e-4);
        assert_eq!(smallest_cap(&[DVec3::Z, -DVec3::Z]), None);
        assert_eq!(smallest_cap(&[]), None);
        assert_eq!(smallest_cap(&[DVec3::NAN]), None);
        let (c, least) = smallest_cap(&[DVec3::X, DVec3::Y, DVec3::Z, DVec3::X]).unwrap();
        assert!(c.distance(DVec3::ONE.normalize()) < 1e-15 && (least - 1.0 / 3f64.sqrt()).abs() < 1e-15);
    }
}
