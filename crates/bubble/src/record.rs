//! Patches as data, and back.

use std::sync::Arc;

use glam::DVec3;
use serde::{Deserialize, Serialize};
use suture_surface::{Patch, Record, RecordError, SplinePool};

use crate::{
    MAX_ORDER,
    corner::plane_count,
    hermite::Hermite,
    implicit::Implicit,
    lean::{self, Leans},
    patch::{BubblePatch, Pairing, Side},
    spline::{self, SplinePatch},
    strip::{Bend, Counts, Strip, bend_fits},
};

/// Names under which records of these patches are stored: what [`load`] reads.
pub const RECORDS: [&str; 2] = [BUBBLE, SPLINE];
const BUBBLE: &str = "bubble.patch";
const SPLINE: &str = "bubble.spline";

/// A patch as what it is made from: every number of it follows, to the same bits.
#[derive(Serialize, Deserialize)]
struct Sources {
    order: usize,
    contact: usize,
    pairing: Pairing,
    corners: Vec<DVec3>,
    implicits: Vec<Implicit>,
    /// From corner `k` to the next; `true` for those that run against their strip.
    reversed: Vec<bool>,
    /// Curves added to the sides, and whether they stand instead of a height; empty where none is.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    bends: Vec<(Vec<DVec3>, bool)>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    leans: Leans,
}

/// A patch as its numbers: over strips that were given.
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
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    leans: Leans,
}

#[derive(Serialize, Deserialize)]
struct SplineData {
    intervals: usize,
    exact_height: bool,
    patch: serde_json::Value,
}

pub(crate) fn record(patch: &BubblePatch) -> Record {
    Record { kind: BUBBLE.into(), data: value(patch) }
}

pub(crate) fn record_spline(patch: &SplinePatch) -> Record {
    let (intervals, exact_height) = (patch.intervals, patch.exact_height);
    let data = SplineData { intervals, exact_height, patch: value(&patch.exact) };
    Record { kind: SPLINE.into(), data: serde_json::to_value(data).unwrap_or_default() }
}

fn value(patch: &BubblePatch) -> serde_json::Value {
    let sides = &patch.sides[..patch.count];
    let strip = |s: &Side| &patch.strips[s.strip as usize];
    // Serialising numbers, strings and arrays into a value cannot fail; a null would be refused when loading.
    if let Some(implicits) = &patch.sources {
        let whole = |s: &Strip| s.height_taylor()[0].iter().all(|c| *c == 0.0);
        let bends = sides.iter().map(|s| (strip(s).bend().to_vec(), whole(strip(s))));
        let data = Sources {
            order: patch.order,
            contact: strip(&sides[0]).contact(),
            pairing: patch.pairing,
            corners: patch.corners().to_vec(),
            implicits: patch.vertices[..patch.count].iter().map(|&v| implicits[v as usize].clone()).collect(),
            reversed: sides.iter().map(|s| s.reversed).collect(),
            bends: if patch.bent { bends.collect() } else { Vec::new() },
            leans: patch.leans.clone(),
        };
        return serde_json::to_value(data).unwrap_or_default();
    }
    let data = Data {
        order: patch.order,
        pairing: patch.pairing,
        corners: patch.corners().to_vec(),
        normals: patch.corner_normals().to_vec(),
        strips: sides.iter().map(|s| (strip(s).clone(), s.reversed)).collect(),
        jets: patch.jets.clone(),
        twists: patch.twists.clone(),
        leans: patch.leans.clone(),
    };
    serde_json::to_value(data).unwrap_or_default()
}

/// Loads a patch that this crate recorded.
///
/// # Errors
/// [`RecordError::UnknownKind`] for records of other methods, [`RecordError::Malformed`].
pub fn load(record: &Record, _: &SplinePool) -> Result<Box<dyn Patch>, RecordError> {
    let bad = |reason: String| RecordError::Malformed { kind: record.kind.clone(), reason };
    match record.kind.as_str() {
        BUBBLE => Ok(Box::new(patch(&record.data).map_err(bad)?)),
        SPLINE => {
            let data = SplineData::deserialize(&record.data).map_err(|e| bad(e.to_string()))?;
            let exact = patch(&data.patch).map_err(bad)?;
            if !(spline::LEAST..=spline::MOST).contains(&data.intervals) || exact.order > 2 {
                return Err(bad("its order or number of intervals is out of range".into()));
            }
            Ok(Box::new(SplinePatch::new(&exact, data.intervals, data.exact_height)))
        }
        _ => Err(RecordError::UnknownKind { kind: record.kind.clone() }),
    }
}

fn patch(data: &serde_json::Value) -> Result<BubblePatch, String> {
    if data.get("implicits").is_some() {
        from_sources(&Sources::deserialize(data).map_err(|e| e.to_string())?)
    } else {
        from_numbers(Data::deserialize(data).map_err(|e| e.to_string())?)
    }
}

fn from_sources(data: &Sources) -> Result<BubblePatch, String> {
    let count = data.corners.len();
    let (n, contact) = (data.order, data.contact);
    let counts = Counts { order: n, contact };
    let bends = data.bends.is_empty() || data.bends.len() == count;
    let shape = (3..=4).contains(&count) && data.implicits.len() == count && data.reversed.len() == count;
    if !shape || !bends || !lean::fit(&data.leans, count) || !counts.valid() || !data.pairing.valid() {
        return Err("its corners, implicits and orders do not match".into());
    }
    if !data.corners.iter().all(|p| p.is_finite()) || !data.implicits.iter().all(Implicit::valid) {
        return Err("a number is not finite, or an implicit has the wrong size".into());
    }
    let mut scratch = Vec::new();
    let mut strips = Vec::with_capacity(count);
    let mut sides = [Side::default(); 4];
    for k in 0..count {
        let next = (k + 1) % count;
        let [a, b] = if data.reversed[k] { [next, k] } else { [k, next] };
        let f = [&data.implicits[a], &data.implicits[b]];
        let bend = match data.bends.get(k) {
            Some((curve, _)) if curve.is_empty() => Bend::None,
            Some((curve, true)) => Bend::Whole(curve),
            Some((curve, false)) => Bend::Part(curve),
            None => Bend::None,
        };
        let ends = [data.corners[a], data.corners[b]];
        let strip = Strip::between(counts, ends, f.map(Implicit::gradient), f, bend, &mut scratch);
        if !strip.sound() || !bend_fits(bend.curve(), contact) {
            return Err("a number of a strip is not finite, or a bend does not vanish at its ends".into());
        }
        strips.push(strip);
        sides[k] = Side { strip: k as u32, reversed: data.reversed[k] };
    }
    let implicits: Vec<&Implicit> = data.implicits.iter().collect();
    let hermite = Hermite::new(n);
    let mut patch = BubblePatch::build(
        Arc::new(strips),
        &sides[..count],
        &data.corners,
        &implicits,
        (n, contact),
        data.pairing,
        Some(data.leans.clone()),
        &hermite,
        &mut scratch,
    );
    patch.sources = Some(Arc::new(data.implicits.clone()));
    patch.vertices = [0, 1, 2, 3];
    if patch.jets.iter().chain(&patch.twists).all(|x| x.is_finite()) {
        Ok(patch)
    } else {
        Err("a number of it is not finite".into())
    }
}

fn from_numbers(data: Data) -> Result<BubblePatch, String> {
    let count = data.corners.len();
    let n = data.order;
    let contact = data.strips.first().map_or(0, |s| s.0.contact());
    let shape = (3..=4).contains(&count) && data.normals.len() == count && data.strips.len() == count;
    let orders = n <= MAX_ORDER && data.strips.iter().all(|(s, _)| s.order() == n && s.contact() == contact);
    if !shape || !orders || !lean::fit(&data.leans, count) || !data.pairing.valid() {
        return Err("its corners, strips and orders do not match".into());
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
        return Err(format!("it needs {jets} coefficients of corners and {twists} of twists"));
    }
    let finite = data.corners.iter().chain(&data.normals).all(|p| p.is_finite())
        && data.jets.iter().chain(&data.twists).all(|x| x.is_finite());
    if !finite {
        return Err("a number is not finite".into());
    }
    let mut sides = [Side::default(); 4];
    let (mut corners, mut normals) = ([DVec3::ZERO; 4], [DVec3::ZERO; 4]);
    for k in 0..count {
        sides[k] = Side { strip: k as u32, reversed: data.strips[k].1 };
        (corners[k], normals[k]) = (data.corners[k], data.normals[k]);
    }
    let leans = data.leans;
    let bent = !leans.is_empty() || data.strips.iter().any(|s| !s.0.bend().is_empty());
    let strips = Arc::new(data.strips.into_iter().map(|s| s.0).collect());
    let (jets, twists) = (data.jets, data.twists);
    let pairing = data.pairing;
    let (sources, vertices) = (None, [0; 4]);
    let order = n;
    Ok(BubblePatch {
        strips,
        sides,
        count,
        order,
        pairing,
        bent,
        leans,
        sources,
        vertices,
        corners,
        normals,
        jets,
        twists,
    })
}
