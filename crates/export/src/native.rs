//! The native format: the patches themselves as JSON, lossless.

use std::sync::Arc;

use glam::DVec3;
use serde::{Deserialize, Serialize};
use suture_bernstein::{BSplineSurface, MAX_DEGREE, NetError};
use suture_surface::{Patch, Record, RecordError, Seam, SplinePool, Surface};

use crate::ExportError;

/// Number of the schema that this version writes and reads.
pub const SCHEMA: u64 = 1;

/// Builds a patch from its record: one per method.
pub type Loader = fn(&Record, &SplinePool) -> Result<Box<dyn Patch>, RecordError>;

#[derive(Serialize)]
struct Out<'a> {
    /// Version of the program, for people.
    suture: &'a str,
    schema: u64,
    splines: Vec<SplineOut<'a>>,
    patches: &'a [Record],
    seams: &'a [Seam],
}

#[derive(Serialize)]
struct SplineOut<'a> {
    degree: [usize; 2],
    knots: [&'a [f64]; 2],
    net: &'a [DVec3],
}

#[derive(Deserialize)]
struct In {
    #[serde(default)]
    splines: Vec<SplineIn>,
    patches: Vec<Record>,
    seams: Vec<Seam>,
}

/// As read: [`BSplineSurface::new`] has not judged it yet.
#[derive(Deserialize)]
struct SplineIn {
    degree: [u8; 2],
    knots: [Vec<f64>; 2],
    net: Vec<DVec3>,
}

#[derive(Deserialize)]
struct Head {
    schema: u64,
}

/// The surface as native JSON.
///
/// One object: `"suture"` (the version that wrote it), `"schema"` ([`SCHEMA`]), `"splines"` (B-splines that patches share, once each:
/// `"degree"`, `"knots"`, `"net"`, the second index fastest), `"patches"` (a [`Record`] each: `"type"` and `"data"`) and `"seams"`
/// (`"a"` and `"b"`, each with `"patch"` and `"edge"`, `"same_direction"`, `"claimed"`). Numbers have the digits that read back to
/// the same bits.
///
/// # Errors
/// [`ExportError::Json`] when a record holds what JSON cannot.
pub fn write_native(surface: &Surface) -> Result<Vec<u8>, ExportError> {
    let mut pool = SplinePool::default();
    let patches: Vec<Record> = surface.patches().iter().map(|p| p.record(&mut pool)).collect();
    let out = Out {
        suture: env!("CARGO_PKG_VERSION"),
        schema: SCHEMA,
        splines: pool
            .splines()
            .iter()
            .map(|s| SplineOut { degree: s.degree(), knots: s.knots(), net: s.net() })
            .collect(),
        patches: &patches,
        seams: surface.seams(),
    };
    let mut bytes = serde_json::to_vec(&out)?;
    bytes.push(b'\n');
    Ok(bytes)
}

/// Reads native JSON; `loaders` are the types of records with the functions that build them.
///
/// Untrusted bytes cost no more memory than a small multiple of their number, as far as the loaders keep to that.
///
/// # Errors
/// [`ExportError::Json`] with line and column, [`ExportError::Schema`], [`ExportError::Spline`], [`ExportError::Patch`] with the
/// number of the patch, [`ExportError::Surface`].
pub fn read_native(bytes: &[u8], loaders: &[(&str, Loader)]) -> Result<Surface, ExportError> {
    // The schema first: a file of another one would be called malformed for the wrong reason.
    let head: Head = serde_json::from_slice(bytes)?;
    if head.schema != SCHEMA {
        return Err(ExportError::Schema { found: head.schema, supported: SCHEMA });
    }
    let file: In = serde_json::from_slice(bytes)?;
    let splines = file
        .splines
        .into_iter()
        .enumerate()
        .map(|(index, s)| spline(s).map(Arc::new).map_err(|source| ExportError::Spline { index, source }))
        .collect::<Result<_, _>>()?;
    let pool = SplinePool::new(splines);
    let patches = file
        .patches
        .iter()
        .enumerate()
        .map(|(index, record)| {
            let loader = loaders.iter().find(|(kind, _)| *kind == record.kind);
            let unknown = || RecordError::UnknownKind { kind: record.kind.clone() };
            let patch = loader.ok_or_else(unknown).and_then(|(_, load)| load(record, &pool));
            patch.map_err(|source| ExportError::Patch { index, source })
        })
        .collect::<Result<_, _>>()?;
    Ok(Surface::new(patches, file.seams)?)
}

fn spline(s: SplineIn) -> Result<BSplineSurface<DVec3>, NetError> {
    let degree = s.degree.map(usize::from);
    // Before the constructor computes with it.
    if let Some(&degree) = degree.iter().find(|&&d| d > MAX_DEGREE) {
        return Err(NetError::Degree { degree });
    }
    BSplineSurface::new(degree, s.knots, s.net)
}
