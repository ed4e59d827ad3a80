//! Patches as data, and back.

use std::sync::Arc;

use glam::DVec3;
use serde::{Deserialize, Serialize};
use suture_surface::{Patch, Record, RecordError, SplinePool};

use crate::{
    MAX_ORDER,
    corner::plane_count,
    patch::{BubblePatch, Pairing, Side},
    strip::Strip,
};

/// Names under which records of these patches are stored: what [`load`] reads.
pub const RECORDS: [&str; 1] = [BUBBLE];
const BUBBLE: &str = "bubble.patch";

#[derive(Serialize, Deserialize)]
struct Data {
    order: usize,
    pairing: Pairing,
    corners: Vec<DVec3>,
    normals: Vec<DVec3>,
    /// From corner `k` to the next; `true` for those that run against their strip.
    strips: Vec<(Strip, bool)>,
    jets: Vec<f64>,
    twists: Vec<f64>,
}

pub(crate) fn record(patch: &BubblePatch) -> Record {
    let sides = patch.sides[..patch.count].iter();
    let data = Data {
        order: patch.order,
        pairing: patch.pairing,
        corners: patch.corners().to_vec(),
        normals: patch.corner_normals().to_vec(),
        strips: sides.map(|s| (patch.strips[s.strip as usize].clone(), s.reversed)).collect(),
        jets: patch.jets.clone(),
        twists: patch.twists.clone(),
    };
    // Serialising numbers, strings and arrays into a value cannot fail; a null would be refused when loading.
    Record { kind: BUBBLE.into(), data: serde_json::to_value(data).unwrap_or_default() }
}

/// Loads a patch that this crate recorded.
///
/// # Errors
/// [`RecordError::UnknownKind`] for records of other methods, [`RecordError::Malformed`].
pub fn load(record: &Record, _: &SplinePool) -> Result<Box<dyn Patch>, RecordError> {
    if record.kind != BUBBLE {
        return Err(RecordError::UnknownKind { kind: record.kind.clone() });
    }
    let bad = |reason: String| RecordError::Malformed { kind: BUBBLE.into(), reason };
    let data = Data::deserialize(&record.data).map_err(|e| bad(e.to_string()))?;
    let count = data.corners.len();
    let n = data.order;
    let contact = data.strips.first().map_or(0, |s| s.0.contact());
    let shape = (3..=4).contains(&count) && data.normals.len() == count && data.strips.len() == count;
    let orders = n <= MAX_ORDER && data.strips.iter().all(|(s, _)| s.order() == n && s.contact() == contact);
    if !shape || !orders || !data.pairing.valid() {
        return Err(bad("its corners, strips and orders do not match".into()));
    }
    let (jets, twists) = if n > 0 {
        let halves = if count == 3 { 6 } else { 4 };
        (count * plane_count(2 * n + 1), halves * (n + 1) * (2 * n + 2))
    } else if contact > 0 && count == 3 && data.pairing == Pairing::Mean {
        (count * plane_count(3), 0)
    } else {
        (0, 0)
    };
    if data.jets.len() != jets || data.twists.len() != twists {
        return Err(bad(format!("it needs {jets} coefficients of corners and {twists} of twists")));
    }
    let finite = data.corners.iter().chain(&data.normals).all(|p| p.is_finite())
        && data.jets.iter().chain(&data.twists).all(|x| x.is_finite());
    if !finite {
        return Err(bad("a number is not finite".into()));
    }
    let mut sides = [Side::default(); 4];
    let (mut corners, mut normals) = ([DVec3::ZERO; 4], [DVec3::ZERO; 4]);
    for k in 0..count {
        sides[k] = Side { strip: k as u32, reversed: data.strips[k].1 };
        (corners[k], normals[k]) = (data.corners[k], data.normals[k]);
    }
    let bent = data.strips.iter().any(|s| !s.0.bend().is_empty());
    let strips = Arc::new(data.strips.into_iter().map(|s| s.0).collect());
    let (jets, twists) = (data.jets, data.twists);
    let pairing = data.pairing;
    Ok(Box::new(BubblePatch {
        strips,
        sides,
        count,
        order: n,
        pairing,
        bent,
        corners,
        normals,
        jets,
        twists,
    }))
}
