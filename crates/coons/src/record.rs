//! Patches as data, and back.

use std::sync::Arc;

use serde::{Deserialize, Serialize, de::DeserializeOwned};
use suture_surface::{Patch, Record, RecordError, SplinePool};

use crate::analytic::Analytic;
use crate::blend::{Blend, BlendFunction};
use crate::constituent::{Constituent, EdgeRibbon, Map, Mapped, PatchSheet, Reflected, Ribbon, Spline};
use crate::curve::CurveData;
use crate::four::FourSided;
use crate::nsided::Wedge;
use crate::sheet::SheetPatch;
use crate::three::ThreeSided;

/// Names under which records of these patches are stored: what [`load`] reads.
pub const RECORDS: [&str; 4] = [FOUR, THREE, WEDGE, GIVEN];
const FOUR: &str = "coons.four_sided";
const THREE: &str = "coons.three_sided";
const WEDGE: &str = "coons.wedge";
const GIVEN: &str = "coons.given";
/// A patch with parts that are functions of the program that made it.
const OPAQUE: &str = "coons.opaque";

pub(crate) const SPLINE: &str = "coons.spline";
pub(crate) const ANALYTIC: &str = "coons.analytic";
pub(crate) const MAPPED: &str = "coons.mapped";
pub(crate) const RIBBON: &str = "coons.ribbon";
pub(crate) const REFLECTED: &str = "coons.reflected";
pub(crate) const EDGE_RIBBON: &str = "coons.edge_ribbon";
pub(crate) const PATCH: &str = "coons.patch";

/// Deepest nesting of constituents: a file is not to be trusted with the stack.
const DEPTH: usize = 8;

#[derive(Serialize, Deserialize)]
pub(crate) struct MappedData {
    pub(crate) inner: Record,
    pub(crate) map: Map,
}

#[derive(Serialize, Deserialize)]
pub(crate) struct RibbonData {
    pub(crate) at: f64,
    pub(crate) curves: Vec<CurveData>,
}

#[derive(Serialize, Deserialize)]
pub(crate) struct ReflectedData {
    pub(crate) inner: Record,
    pub(crate) order: usize,
}

#[derive(Serialize, Deserialize)]
pub(crate) struct EdgeRibbonData {
    pub(crate) inner: Record,
    pub(crate) at: f64,
    pub(crate) order: usize,
}

#[derive(Serialize, Deserialize)]
struct FourData {
    r: [Record; 2],
    borders: [CurveData; 2],
    alpha: BlendFunction,
    beta: BlendFunction,
}

#[derive(Serialize, Deserialize)]
struct ThreeData {
    r: [Record; 3],
    alpha: BlendFunction,
    beta: BlendFunction,
}

#[derive(Serialize, Deserialize)]
struct WedgeData {
    fill: Record,
    normals: [CurveData; 2],
}

#[derive(Serialize, Deserialize)]
struct GivenData {
    sheet: Record,
    domain: [glam::DVec2; 2],
}

fn record(kind: &str, data: Option<impl Serialize>) -> Record {
    match data.and_then(|d| serde_json::to_value(d).ok()) {
        Some(data) => Record { kind: kind.into(), data },
        None => Record { kind: OPAQUE.into(), data: kind.into() },
    }
}

pub(crate) fn four(patch: &FourSided, pool: &mut SplinePool) -> Record {
    let mut data = || {
        Some(FourData {
            r: [patch.r[0].record(pool)?, patch.r[1].record(pool)?],
            borders: [patch.borders[0].data()?, patch.borders[1].data()?],
            alpha: patch.alpha.function()?,
            beta: patch.beta.function()?,
        })
    };
    record(FOUR, data())
}

pub(crate) fn three(patch: &ThreeSided, pool: &mut SplinePool) -> Record {
    let mut data = || {
        let r = [0, 1, 2].map(|k| patch.constituents()[k].record(pool));
        let [a, b, c] = r;
        let (alpha, beta) = (patch.alpha.function()?, patch.beta.function()?);
        Some(ThreeData { r: [a?, b?, c?], alpha, beta })
    };
    record(THREE, data())
}

pub(crate) fn wedge(patch: &Wedge, pool: &mut SplinePool) -> Record {
    let fill = four(&patch.fill, pool);
    let saved = fill.kind == FOUR;
    let normals = [0, 1].map(|s| CurveData::Bezier { net: patch.normals[s].net().to_vec() });
    record(WEDGE, saved.then_some(WedgeData { fill, normals }))
}

pub(crate) fn given(patch: &SheetPatch, pool: &mut SplinePool) -> Record {
    let sheet = patch.sheet.record(pool);
    record(GIVEN, sheet.map(|sheet| GivenData { sheet, domain: patch.domain }))
}

/// Loads a patch of another method, for constituents that are such patches.
pub type Foreign<'a> = &'a dyn Fn(&Record, &SplinePool) -> Result<Box<dyn Patch>, RecordError>;

/// Loads a patch that this crate recorded and whose constituents are this crate's.
///
/// # Errors
/// [`RecordError::UnknownKind`] for records of other methods, [`RecordError::Malformed`].
pub fn load(record: &Record, pool: &SplinePool) -> Result<Box<dyn Patch>, RecordError> {
    load_with(record, pool, &|r, _| Err(RecordError::UnknownKind { kind: r.kind.clone() }))
}

/// As [`load`]; constituents that are patches of other methods are loaded by `foreign`.
///
/// # Errors
/// As [`load`].
pub fn load_with(
    record: &Record,
    pool: &SplinePool,
    foreign: Foreign<'_>,
) -> Result<Box<dyn Patch>, RecordError> {
    let bad = |reason: String| RecordError::Malformed { kind: record.kind.clone(), reason };
    match record.kind.as_str() {
        FOUR => Ok(Box::new(load_four(record, pool, foreign)?)),
        THREE => {
            let data: ThreeData = parse(record)?;
            let [a, b, c] = data.r;
            let r = [
                constituent(&a, pool, foreign, 0)?,
                constituent(&b, pool, foreign, 0)?,
                constituent(&c, pool, foreign, 0)?,
            ];
            Ok(Box::new(ThreeSided::raw(r, blends(data.alpha, data.beta))))
        }
        WEDGE => {
            let data: WedgeData = parse(record)?;
            if data.fill.kind != FOUR {
                return Err(bad("its fill is not four-sided".into()));
            }
            let fill = load_four(&data.fill, pool, foreign)?;
            let [a, b] = data.normals.map(|n| match n {
                CurveData::Bezier { net } => {
                    suture_bernstein::BezierCurve::new(net).map_err(|e| bad(e.to_string()))
                }
                _ => Err(bad("its normals are not Bézier curves".into())),
            });
            Ok(Box::new(Wedge { fill, normals: [a?, b?] }))
        }
        GIVEN => {
            let data: GivenData = parse(record)?;
            let sheet = constituent(&data.sheet, pool, foreign, 0)?;
            SheetPatch::new(sheet, data.domain)
                .map(|p| Box::new(p) as Box<dyn Patch>)
                .ok_or_else(|| bad("its domain is empty".into()))
        }
        OPAQUE => Err(bad("it was made from functions, which no file can hold".into())),
        other => Err(RecordError::UnknownKind { kind: other.into() }),
    }
}

fn load_four(record: &Record, pool: &SplinePool, foreign: Foreign<'_>) -> Result<FourSided, RecordError> {
    let data: FourData = parse(record)?;
    let r = [constituent(&data.r[0], pool, foreign, 0)?, constituent(&data.r[1], pool, foreign, 0)?];
    let curve = |c: &CurveData| {
        c.build().map_err(|e| RecordError::Malformed { kind: record.kind.clone(), reason: e.to_string() })
    };
    let borders = [curve(&data.borders[0])?, curve(&data.borders[1])?];
    Ok(FourSided::raw(r, borders, blends(data.alpha, data.beta)))
}

fn blends(alpha: BlendFunction, beta: BlendFunction) -> [Arc<dyn Blend>; 2] {
    [Arc::new(alpha), Arc::new(beta)]
}

fn constituent(
    record: &Record,
    pool: &SplinePool,
    foreign: Foreign<'_>,
    depth: usize,
) -> Result<Arc<dyn Constituent>, RecordError> {
    let bad = |reason: &str| RecordError::Malformed { kind: record.kind.clone(), reason: reason.into() };
    if depth > DEPTH {
        return Err(bad("constituents are nested too deeply"));
    }
    Ok(match record.kind.as_str() {
        SPLINE => {
            let index: usize = parse(record)?;
            Arc::new(Spline(pool.get(index).cloned().ok_or_else(|| bad("there is no such B-spline"))?))
        }
        ANALYTIC => {
            let surface: Analytic = parse(record)?;
            if !surface.valid() {
                return Err(bad("a number is not finite, or a curve has no or too many points"));
            }
            Arc::new(surface)
        }
        MAPPED => {
            let data: MappedData = parse(record)?;
            if !data.map.valid() {
                return Err(bad("a number of the map is not finite"));
            }
            Arc::new(Mapped { inner: constituent(&data.inner, pool, foreign, depth + 1)?, map: data.map })
        }
        RIBBON => {
            let data: RibbonData = parse(record)?;
            if data.curves.is_empty() || data.curves.len() > 4 || !data.at.is_finite() {
                return Err(bad("a ribbon has 1 to 4 curves"));
            }
            let curves = data.curves.iter().map(|c| c.build().map_err(|e| bad(&e.to_string())));
            Arc::new(Ribbon { at: data.at, curves: curves.collect::<Result<_, _>>()? })
        }
        EDGE_RIBBON => {
            let data: EdgeRibbonData = parse(record)?;
            if !data.at.is_finite() {
                return Err(bad("its edge is not finite"));
            }
            let inner = constituent(&data.inner, pool, foreign, depth + 1)?;
            let ribbon = EdgeRibbon::new(inner, data.at, data.order);
            Arc::new(ribbon.ok_or_else(|| bad("its surface cannot be expanded"))?)
        }
        REFLECTED => {
            let data: ReflectedData = parse(record)?;
            let inner = constituent(&data.inner, pool, foreign, depth + 1)?;
            Arc::new(Reflected { inner, order: data.order.min(3) })
        }
        PATCH => {
            let inner: Record = parse(record)?;
            Arc::new(PatchSheet(Arc::from(foreign(&inner, pool)?)))
        }
        other => return Err(RecordError::UnknownKind { kind: other.into() }),
    })
}

fn parse<T: DeserializeOwned>(record: &Record) -> Result<T, RecordError> {
    T::deserialize(&record.data)
        .map_err(|e| RecordError::Malformed { kind: record.kind.clone(), reason: e.to_string() })
}
