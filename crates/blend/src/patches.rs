//! The three kinds of patches of a blended surface.

use std::sync::Arc;

use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize, de::DeserializeOwned};
use suture_bernstein::{BSplineSurface, BezierCurve, BezierPatch};
use suture_surface::{Domain, Jet2, Patch, PatchKind, Record, RecordError, SplinePool};

use crate::gon::{self, MAX_VALENCE};
use crate::polynomial::PlanePolynomial;
use crate::weights;

type Spline = Arc<BSplineSurface<DVec3>>;

/// A blending strip `H↓(V) F↓(G↓(U, V)) + H↑(V) F↑(G↑(U, V))` on `[0, 1]²` (Wagner et al. 2003, Equation 4).
#[derive(Clone, Debug)]
pub struct Strip {
    surfaces: [Spline; 2],
    maps: [BezierPatch<DVec2>; 2],
    kind: PatchKind,
}

impl Strip {
    /// A strip from its surfaces and maps, ↓ first.
    pub fn new(surfaces: [Spline; 2], maps: [BezierPatch<DVec2>; 2], kind: PatchKind) -> Self {
        Self { surfaces, maps, kind }
    }

    /// The surfaces ↓ and ↑.
    pub fn surfaces(&self) -> &[Spline; 2] {
        &self.surfaces
    }

    /// The maps ↓ and ↑.
    pub fn maps(&self) -> &[BezierPatch<DVec2>; 2] {
        &self.maps
    }

    /// The two points that are blended at `at`, ↓ first: their distance is the separation of the blend.
    pub fn constituents(&self, at: DVec2) -> [DVec3; 2] {
        [0, 1].map(|k| self.surfaces[k].jet(self.maps[k].jet(at).p).p)
    }

    /// What surface `k` contributes before it is weighted.
    pub(crate) fn part(&self, k: usize, at: DVec2) -> Jet2 {
        let map = self.maps[k].jet(at);
        self.surfaces[k].jet(map.p).compose(&map)
    }
}

impl Patch for Strip {
    fn domain(&self) -> Domain {
        Domain::Rectangle { min: DVec2::ZERO, max: DVec2::ONE }
    }

    fn jet(&self, at: DVec2) -> Jet2 {
        let weights = weights::strip(at.y);
        let mut sum = Jet2::default();
        for k in 0..2 {
            // Where a weight and its derivatives vanish, the surface may not even be defined.
            if weights[k] != Jet2::default() {
                sum = sum.add(self.part(k, at).weighted(&weights[k]));
            }
        }
        sum
    }

    fn kind(&self) -> PatchKind {
        self.kind
    }

    fn record(&self, pool: &mut SplinePool) -> Record {
        let surfaces = [pool.index(&self.surfaces[0]), pool.index(&self.surfaces[1])];
        let data = StripData { surfaces, maps: self.maps.clone(), kind: self.kind };
        record(STRIP, &data)
    }
}

/// An N-blend `Σ H^{N,i}(P) Fⁱ(Gⁱ(P))` on the regular N-gon (Wagner et al. 2003, Equation 3).
#[derive(Clone, Debug)]
pub struct NBlend {
    surfaces: Vec<Spline>,
    maps: Vec<PlanePolynomial>,
}

impl NBlend {
    /// An N-blend from its N surfaces and maps, counter-clockwise; `None` unless there are as many maps as surfaces, 3 to 8.
    pub fn new(surfaces: Vec<Spline>, maps: Vec<PlanePolynomial>) -> Option<Self> {
        ((3..=MAX_VALENCE).contains(&surfaces.len()) && maps.len() == surfaces.len())
            .then_some(Self { surfaces, maps })
    }

    /// The surfaces, counter-clockwise.
    pub fn surfaces(&self) -> &[Spline] {
        &self.surfaces
    }

    /// The maps of the surfaces.
    pub fn maps(&self) -> &[PlanePolynomial] {
        &self.maps
    }

    /// The N points that are blended at `at`.
    pub fn constituents(&self, at: DVec2) -> Vec<DVec3> {
        self.surfaces.iter().zip(&self.maps).map(|(f, g)| f.jet(g.jet(at).p).p).collect()
    }

    /// What surface `k` contributes before it is weighted.
    pub(crate) fn part(&self, k: usize, at: DVec2) -> Jet2 {
        let map = self.maps[k].jet(at);
        self.surfaces[k].jet(map.p).compose(&map)
    }
}

impl Patch for NBlend {
    fn domain(&self) -> Domain {
        Domain::Polygon(gon::corners(self.surfaces.len()))
    }

    fn jet(&self, at: DVec2) -> Jet2 {
        let weights = weights::n_blend(self.surfaces.len(), at);
        let mut sum = Jet2::default();
        for (k, weight) in (0..self.surfaces.len()).zip(&weights) {
            sum = sum.add(self.part(k, at).weighted(weight));
        }
        sum
    }

    fn kind(&self) -> PatchKind {
        PatchKind::NBlend { n: self.surfaces.len() as u8 }
    }

    fn record(&self, pool: &mut SplinePool) -> Record {
        let surfaces = self.surfaces.iter().map(|s| pool.index(s)).collect();
        record(N_BLEND, &NBlendData { surfaces, maps: self.maps.clone() })
    }
}

/// A B-spline surface trimmed by the inner sides of the strips around it.
#[derive(Clone, Debug)]
pub struct Trimmed {
    surface: Spline,
    loops: Vec<Vec<BezierCurve<DVec2>>>,
}

impl Trimmed {
    /// A trimmed surface from its boundary loops, the outer one first and counter-clockwise.
    pub fn new(surface: Spline, loops: Vec<Vec<BezierCurve<DVec2>>>) -> Self {
        Self { surface, loops }
    }

    /// The surface without its trimming.
    pub fn surface(&self) -> &Spline {
        &self.surface
    }

    /// The trimming loops.
    pub fn loops(&self) -> &[Vec<BezierCurve<DVec2>>] {
        &self.loops
    }
}

impl Patch for Trimmed {
    fn domain(&self) -> Domain {
        Domain::Trimmed(self.loops.clone())
    }

    fn jet(&self, at: DVec2) -> Jet2 {
        self.surface.jet(at)
    }

    fn kind(&self) -> PatchKind {
        PatchKind::Trimmed
    }

    fn record(&self, pool: &mut SplinePool) -> Record {
        record(TRIMMED, &TrimmedData { surface: pool.index(&self.surface), loops: self.loops.clone() })
    }
}

/// Names under which records of these patches are stored: what [`load`] reads.
pub const RECORDS: [&str; 3] = [STRIP, N_BLEND, TRIMMED];
const STRIP: &str = "blend.strip";
const N_BLEND: &str = "blend.n_blend";
const TRIMMED: &str = "blend.trimmed";

#[derive(Serialize, Deserialize)]
struct StripData {
    surfaces: [usize; 2],
    maps: [BezierPatch<DVec2>; 2],
    kind: PatchKind,
}

#[derive(Serialize, Deserialize)]
struct NBlendData {
    surfaces: Vec<usize>,
    maps: Vec<PlanePolynomial>,
}

#[derive(Serialize, Deserialize)]
struct TrimmedData {
    surface: usize,
    loops: Vec<Vec<BezierCurve<DVec2>>>,
}

fn record(kind: &str, data: &impl Serialize) -> Record {
    // Serialising numbers, strings and arrays into a value cannot fail; a null would be refused when loading.
    Record { kind: kind.into(), data: serde_json::to_value(data).unwrap_or_default() }
}

/// Loads a patch that this crate recorded.
///
/// # Errors
/// [`RecordError::UnknownKind`] for records of other methods, [`RecordError::Malformed`].
pub fn load(record: &Record, pool: &SplinePool) -> Result<Box<dyn Patch>, RecordError> {
    let bad = |reason: String| RecordError::Malformed { kind: record.kind.clone(), reason };
    let spline = |i: usize| pool.get(i).cloned().ok_or_else(|| bad(format!("there is no B-spline {i}")));
    // Nets pass through their constructors again: a file is not to be trusted with their invariants.
    let patch = |p: &BezierPatch<DVec2>| {
        BezierPatch::new(p.degree(), p.net().to_vec()).map_err(|e| bad(e.to_string()))
    };
    match record.kind.as_str() {
        STRIP => {
            let data: StripData = parse(record)?;
            let maps = [patch(&data.maps[0])?, patch(&data.maps[1])?];
            Ok(Box::new(Strip::new([spline(data.surfaces[0])?, spline(data.surfaces[1])?], maps, data.kind)))
        }
        N_BLEND => {
            let data: NBlendData = parse(record)?;
            let surfaces = data.surfaces.into_iter().map(spline).collect::<Result<_, _>>()?;
            let maps = data
                .maps
                .iter()
                .map(|m| PlanePolynomial::new(m.degree(), m.coefficients().to_vec()))
                .collect::<Option<_>>()
                .ok_or_else(|| bad("a map has the wrong number of coefficients".into()))?;
            let blend = NBlend::new(surfaces, maps);
            Ok(Box::new(blend.ok_or_else(|| bad("surfaces and maps do not match".into()))?))
        }
        TRIMMED => {
            let data: TrimmedData = parse(record)?;
            let curve =
                |c: BezierCurve<DVec2>| BezierCurve::new(c.net().to_vec()).map_err(|e| bad(e.to_string()));
            let loops = data
                .loops
                .into_iter()
                .map(|l| l.into_iter().map(curve).collect::<Result<Vec<_>, _>>())
                .collect::<Result<Vec<_>, _>>()?;
            if loops.is_empty() || loops.iter().any(Vec::is_empty) {
                return Err(bad("a trimming loop is empty".into()));
            }
            Ok(Box::new(Trimmed::new(spline(data.surface)?, loops)))
        }
        other => Err(RecordError::UnknownKind { kind: other.into() }),
    }
}

fn parse<T: DeserializeOwned>(record: &Record) -> Result<T, RecordError> {
    T::deserialize(&record.data)
        .map_err(|e| RecordError::Malformed { kind: record.kind.clone(), reason: e.to_string() })
}
