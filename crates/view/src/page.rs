//! One HTML page that shows surfaces: everything in one file, nothing from the network.

mod mesh;
mod payload;
mod seams;

use std::path::Path;

use glam::{DVec2, DVec3};
use serde::Serialize;
use suture_bernstein::BSplineSurface;
use suture_certify::{Certificate, Deviation};
use suture_mesh::TriMesh;
use suture_surface::{Continuity, Domain, PatchKind, SplinePool, Surface};
use suture_tessellate::Tessellation;

use self::mesh::Sorted;
use self::payload::{Payload, Section};
use crate::{Camera, Shade, ViewError, ViewOptions, color, image, render::check};

/// The share of the area whose values lie within the range of a colour map.
const ROBUST: f64 = 0.95;

const TEMPLATE: &str = include_str!("../assets/page.html");
const SCRIPT: &str = include_str!("../assets/viewer.js");
const STYLE: &str = include_str!("../assets/viewer.css");

/// What one page shows: one surface, or several side by side under one camera.
#[derive(Clone, Debug, Default)]
pub struct Page<'a> {
    /// The heading.
    pub title: String,
    /// The surfaces, from left to right.
    pub models: Vec<PageModel<'a>>,
    /// How the page opens: shade, bands, upward axis (the coordinate axis nearest to `up`) and orbit angles.
    pub view: ViewOptions,
}

/// A surface with everything that a page tells of it. Only surface and tessellation are needed.
#[derive(Clone, Debug)]
pub struct PageModel<'a> {
    /// Its name beside others, for example that of the method.
    pub name: String,
    /// The patches: their normals and curvatures are shown.
    pub surface: &'a Surface,
    /// A tessellation of this very surface.
    pub tessellation: &'a Tessellation,
    /// The jumps of every seam.
    pub certificate: Option<&'a Certificate>,
    /// The distances from `mesh`, one per vertex and triangle of the tessellation.
    pub deviation: Option<&'a Deviation>,
    /// The mesh that the surface was made from.
    pub mesh: Option<&'a TriMesh>,
    /// Segment of every face of `mesh`.
    pub labels: Option<&'a [u32]>,
    /// Tetrahedra within which an implicit surface lives, and whether each belongs to an edge rather than to a face.
    pub hull: Vec<([DVec3; 4], bool)>,
    /// Polynomial degree of every patch, in words; empty if nobody knows.
    pub degrees: Vec<String>,
    /// The report, as written by `--json`.
    pub report: serde_json::Value,
}

#[derive(Serialize)]
struct Head<'a> {
    title: &'a str,
    version: &'a str,
    kinds: Vec<Kind>,
    models: Vec<Model<'a>>,
    view: View,
}

#[derive(Serialize)]
struct Kind {
    name: &'static str,
    color: u32,
}

#[derive(Serialize)]
struct View {
    up: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    azimuth: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    elevation: Option<f64>,
    shade: &'static str,
    bands: u32,
}

#[derive(Serialize)]
struct Model<'a> {
    name: &'a str,
    patches: usize,
    diagonal: f64,
    sections: Sections,
    /// Ends of the colour maps, lengths relative to the diagonal.
    ranges: Ranges,
    degrees: Degrees,
    report: &'a serde_json::Value,
}

#[derive(Serialize)]
struct Ranges {
    mean: f64,
    gaussian: f64,
    largest: f64,
    smallest: f64,
    deviation: f64,
}

#[derive(Serialize, Default)]
struct Degrees {
    names: Vec<String>,
    /// Number of the name of every patch.
    of: Vec<u32>,
}

type Sections = std::collections::BTreeMap<&'static str, Section>;

impl Page<'_> {
    /// The page as text.
    ///
    /// # Errors
    /// [`ViewError::Option`], [`ViewError::Empty`] without surfaces or triangles, [`ViewError::Extent`], [`ViewError::Mismatch`] when a
    /// tessellation, a certificate, distances or labels belong to something else.
    pub fn to_html(&self) -> Result<String, ViewError> {
        self.view.check()?;
        let first = self.models.first().ok_or(ViewError::Empty)?;
        for model in &self.models {
            check(model.tessellation, model.surface)?;
            model.check()?;
        }
        let frame = Frame::new(first)?;
        let kinds = kinds(&self.models);
        let mut payload = Payload::default();
        let models = self.models.iter().map(|m| m.write(&frame, &kinds, &mut payload)).collect();
        let head = Head {
            title: &self.title,
            version: env!("CARGO_PKG_VERSION"),
            kinds: kinds.iter().map(|&(name, color)| Kind { name, color }).collect(),
            models,
            view: view(&self.view),
        };
        let data = payload.pack(&head)?;
        let title = escape(&self.title);
        let class = if self.models.len() > 1 { " class=\"many\"" } else { "" };
        Ok(fill(TEMPLATE, |name| match name {
            "title" => &title,
            "class" => class,
            "style" => STYLE,
            "script" => SCRIPT,
            "data" => &data,
            _ => "",
        }))
    }

    /// Writes the page. The file appears complete or not at all.
    ///
    /// # Errors
    /// As [`to_html`](Self::to_html), and [`ViewError::Write`].
    pub fn write_html(&self, path: impl AsRef<Path>) -> Result<(), ViewError> {
        let path = path.as_ref();
        let html = self.to_html()?;
        image::replace(path, html.as_bytes())
            .map_err(|source| ViewError::Write { path: path.to_owned(), source })
    }
}

/// Puts values for names in double braces; they are not looked into again.
fn fill<'a>(template: &str, value: impl Fn(&str) -> &'a str) -> String {
    let mut parts = template.split("{{");
    let mut out = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (name, rest) = part.split_once("}}").unwrap_or(("", part));
        out.push_str(value(name));
        out.push_str(rest);
    }
    out
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// The middle and the size that all models of a page are shown relative to.
struct Frame {
    middle: DVec3,
    diagonal: f64,
}

impl Frame {
    fn new(model: &PageModel<'_>) -> Result<Self, ViewError> {
        let [lo, hi] = model.tessellation.mesh.bounding_box().ok_or(ViewError::Empty)?;
        let diagonal = model.mesh.unwrap_or(&model.tessellation.mesh).diagonal();
        let middle = lo + (hi - lo) * 0.5;
        if diagonal.is_finite() && diagonal > 0.0 && middle.is_finite() {
            Ok(Self { middle, diagonal })
        } else {
            Err(ViewError::Extent { diagonal })
        }
    }

    fn local<'a>(&self, points: impl IntoIterator<Item = &'a DVec3>) -> Vec<DVec3> {
        points.into_iter().map(|p| (*p - self.middle) / self.diagonal).collect()
    }
}

impl PageModel<'_> {
    /// A model of which nothing else is known.
    pub fn new<'a>(
        name: impl Into<String>,
        surface: &'a Surface,
        tessellation: &'a Tessellation,
    ) -> PageModel<'a> {
        PageModel {
            name: name.into(),
            surface,
            tessellation,
            certificate: None,
            deviation: None,
            mesh: None,
            labels: None,
            hull: Vec::new(),
            degrees: Vec::new(),
            report: serde_json::Value::Null,
        }
    }

    fn check(&self) -> Result<(), ViewError> {
        let t = &self.tessellation.mesh;
        let mut lengths = Vec::new();
        if let Some(c) = self.certificate {
            lengths.push(("certificate", c.seams.len(), self.surface.seams().len()));
        }
        if let Some(d) = self.deviation {
            lengths.push(("distances of vertices", d.vertex_distances.len(), t.positions.len()));
            lengths.push(("distances of triangles", d.centroid_distances.len(), t.faces.len()));
        }
        if let (Some(labels), Some(mesh)) = (self.labels, self.mesh) {
            lengths.push(("labels", labels.len(), mesh.faces.len()));
        }
        if !self.degrees.is_empty() {
            lengths.push(("degrees", self.degrees.len(), self.surface.patches().len()));
        }
        match lengths.into_iter().find(|(_, given, needed)| given != needed) {
            Some((name, given, needed)) => Err(ViewError::Length { name, given, needed }),
            None => Ok(()),
        }
    }

    fn write(&self, frame: &Frame, kinds: &[(&'static str, u32)], payload: &mut Payload) -> Model<'_> {
        let t = self.tessellation;
        let sorted = Sorted::new(self.surface, t);
        let mut sections = Sections::new();
        let points = frame.local(sorted.vertex.iter().map(|&v| &t.mesh.positions[v as usize]));
        sections.insert("position", payload.points(&points));
        sections.insert("normal", payload.normals(&sorted.normal));
        let d = frame.diagonal;
        let curvature = || sorted.curvature.iter().map(move |k| [k[0] * d, k[1] * d]);
        sections.insert("curvature", payload.floats(curvature().flatten()));
        let parameters = sorted.parameter.iter().flat_map(|p| p.to_array());
        sections.insert("parameter", payload.shares(parameters, [0.0, 1.0], 2));
        sections.insert("triangles", payload.integers(&sorted.local, 3));
        sections.insert("patch_vertices", payload.integers(&sorted.vertices, 0));
        sections.insert("patch_triangles", payload.integers(&sorted.triangles, 0));
        let number = |kind| kinds.iter().position(|k| k.0 == kind_name(kind)).unwrap_or_default() as u32;
        let patch_kinds: Vec<u32> = self.surface.patches().iter().map(|p| number(p.kind())).collect();
        sections.insert("patch_kind", payload.integers(&patch_kinds, 0));
        let mut deviation = 0.0;
        if let Some(d) = self.deviation {
            let at = || sorted.vertex.iter().map(|&v| d.vertex_distances[v as usize]);
            sections.insert("deviation", payload.floats(at()));
            sections.insert("patch_worst", payload.floats(self.worst(d).into_iter()));
            deviation = sorted.quantile(at(), 0.99);
        }
        self.write_seams(&sorted, payload, &mut sections);
        self.write_extras(frame, payload, &mut sections);
        let range = |f: fn([f64; 2]) -> f64| sorted.quantile(curvature().map(|k| f(k).abs()), ROBUST);
        Model {
            name: &self.name,
            patches: self.surface.patches().len(),
            diagonal: frame.diagonal,
            sections,
            ranges: Ranges {
                mean: range(|k| 0.5 * (k[0] + k[1])),
                gaussian: range(|k| k[0] * k[1]),
                largest: range(|k| k[0]),
                smallest: range(|k| k[1]),
                deviation,
            },
            degrees: degrees(&self.degrees),
            report: &self.report,
        }
    }

    /// The largest distance on every patch.
    fn worst(&self, d: &Deviation) -> Vec<f64> {
        let mut worst = vec![0.0_f64; self.surface.patches().len()];
        let t = self.tessellation;
        for (f, face) in t.mesh.faces.iter().enumerate() {
            let w = &mut worst[t.triangle_patch[f].0 as usize];
            *w = face
                .iter()
                .map(|&v| d.vertex_distances[v as usize])
                .fold(w.max(d.centroid_distances[f]), f64::max);
        }
        worst
    }

    fn write_seams(&self, sorted: &Sorted, payload: &mut Payload, sections: &mut Sections) {
        let found = seams::seam_edges(self.surface, self.tessellation);
        if found.edges.is_empty() {
            return;
        }
        // Where each triangle of the tessellation went, and the first vertex of its patch.
        let mut place = vec![0; sorted.order.len()];
        let mut base = vec![0; sorted.order.len()];
        let (mut next, mut first) = (0, 0);
        for (&triangles, &vertices) in sorted.triangles.iter().zip(&sorted.vertices) {
            for _ in 0..triangles {
                let triangle = sorted.order[next] as usize;
                (place[triangle], base[triangle]) = (next, first);
                next += 1;
            }
            first += vertices;
        }
        let vertex = |f: u32, k: u8| sorted.local[3 * place[f as usize] + k as usize] + base[f as usize];
        let ends: Vec<u32> =
            found.edges.iter().flat_map(|&(f, k)| [vertex(f, k), vertex(f, (k + 1) % 3)]).collect();
        sections.insert("seam_edges", payload.integers(&ends, 2));
        sections.insert("edge_seam", payload.integers(&found.seam, 1));
        let seams = self.surface.seams();
        let patches: Vec<u32> = seams.iter().flat_map(|s| [s.a.patch.0, s.b.patch.0]).collect();
        sections.insert("seam_patches", payload.integers(&patches, 2));
        let report = |i: usize| self.certificate.map(|c| &c.seams[i]);
        let orders: Vec<u32> = seams
            .iter()
            .enumerate()
            .flat_map(|(i, s)| {
                [rank(s.claimed), report(i).map_or(rank(s.claimed), |r| r.measured.map_or(0, rank))]
            })
            .collect();
        sections.insert("seam_orders", payload.integers(&orders, 0));
        let jumps = (0..seams.len()).flat_map(|i| {
            report(i).map_or([0.0; 3], |r| [r.position.value, r.normal.value, r.curvature.value])
        });
        sections.insert("seam_jumps", payload.floats(jumps));
    }

    fn write_extras(&self, frame: &Frame, payload: &mut Payload, sections: &mut Sections) {
        let nets = nets(self.surface);
        if !nets.is_empty() {
            sections.insert("nets", payload.points(&frame.local(&nets)));
        }
        if !self.hull.is_empty() {
            let points = frame.local(self.hull.iter().flat_map(|(corners, _)| corners));
            sections.insert("hull", payload.points(&points));
            let kinds: Vec<u32> = self.hull.iter().map(|h| u32::from(h.1)).collect();
            sections.insert("hull_kind", payload.integers(&kinds, 0));
        }
        let Some(mesh) = self.mesh else { return };
        sections.insert("mesh_position", payload.points(&frame.local(&mesh.positions)));
        sections.insert("mesh_faces", payload.integers(mesh.faces.as_flattened(), 3));
        if let Some(labels) = self.labels {
            sections.insert("mesh_labels", payload.integers(labels, 0));
        }
    }
}

/// Lines of the control nets of all B-splines that patches are made of, as pairs of points.
fn nets(surface: &Surface) -> Vec<DVec3> {
    let mut pool = SplinePool::default();
    let mut lines = Vec::new();
    for patch in surface.patches() {
        if matches!(patch.kind(), PatchKind::Trimmed | PatchKind::Given | PatchKind::Fill { .. }) {
            let known = pool.splines().len();
            // Enters its B-splines; the rest of the record is not needed.
            let _ = patch.record(&mut pool);
            // Control points that act only beyond the trimming curves wander far off and would hide those that matter.
            let trimmed = (patch.kind() == PatchKind::Trimmed).then(|| extent(&patch.domain()));
            pool.splines()[known..].iter().for_each(|s| net(s, trimmed, &mut lines));
        }
    }
    lines
}

/// Lines between neighbouring control points that act within `region` (all without one).
fn net(spline: &BSplineSurface<DVec3>, region: Option<[DVec2; 2]>, lines: &mut Vec<DVec3>) {
    let degree = spline.degree();
    let [m, n] = [0, 1].map(|k| spline.knots()[k].len() - degree[k] - 1);
    let acts = |k: usize, i: usize| {
        let knots = spline.knots()[k];
        region.is_none_or(|[lo, hi]| knots[i] < hi[k] && knots[i + degree[k] + 1] > lo[k])
    };
    let at = |i: usize, j: usize| (acts(0, i) && acts(1, j)).then(|| spline.net()[i * n + j]);
    for i in 0..m {
        for j in 0..n {
            for (k, l) in [(i + 1, j), (i, j + 1)] {
                if k < m && l < n {
                    lines.extend(at(i, j).zip(at(k, l)).into_iter().flat_map(|(a, b)| [a, b]));
                }
            }
        }
    }
}

/// The box around a domain. Control points of its edges bound them.
fn extent(domain: &Domain) -> [DVec2; 2] {
    let around = |points: &mut dyn Iterator<Item = DVec2>| {
        points.fold([DVec2::INFINITY, DVec2::NEG_INFINITY], |[lo, hi], p| [lo.min(p), hi.max(p)])
    };
    match domain {
        Domain::Rectangle { min, max } => [*min, *max],
        Domain::Polygon(corners) => around(&mut corners.iter().copied()),
        Domain::Trimmed(loops) => around(&mut loops.iter().flatten().flat_map(|c| c.net().iter().copied())),
    }
}

fn degrees(of: &[String]) -> Degrees {
    let mut all = Degrees::default();
    for name in of {
        let known = all.names.iter().position(|n| n == name);
        let number = known.unwrap_or_else(|| {
            all.names.push(name.clone());
            all.names.len() - 1
        });
        all.of.push(number as u32);
    }
    all
}

/// 1 to 5 from `C0` to `C2`.
fn rank(order: Continuity) -> u32 {
    match order {
        Continuity::C0 => 1,
        Continuity::G1 => 2,
        Continuity::C1 => 3,
        Continuity::G2 => 4,
        _ => 5,
    }
}

fn kind_name(kind: PatchKind) -> &'static str {
    match kind {
        PatchKind::Trimmed => "trimmed B-spline",
        PatchKind::Strip { odd: false } => "strip",
        PatchKind::Strip { odd: true } => "strip, odd",
        PatchKind::AdjacentStrip => "strip at N-blend",
        PatchKind::NBlend { .. } => "N-blend",
        PatchKind::Bubble { .. } => "bubble",
        PatchKind::Face => "face",
        PatchKind::Edge => "edge",
        PatchKind::Planar => "plane face",
        PatchKind::Fill { .. } => "fill",
        PatchKind::Given => "given",
        _ => "other",
    }
}

/// The kinds of patches in all models, with their colours; in the order of `PatchKind`.
fn kinds(models: &[PageModel<'_>]) -> Vec<(&'static str, u32)> {
    let mut all: Vec<PatchKind> = models.iter().flat_map(|m| m.surface.patches()).map(|p| p.kind()).collect();
    all.sort_unstable();
    let mut named: Vec<(&'static str, u32)> = all
        .into_iter()
        .map(|kind| {
            let [r, g, b] = color::encode(color::of_kind(kind)).map(u32::from);
            (kind_name(kind), r << 16 | g << 8 | b)
        })
        .collect();
    named.dedup_by_key(|k| k.0);
    named
}

fn view(options: &ViewOptions) -> View {
    let a = options.up.abs();
    let up = if a.x > a.y && a.x > a.z {
        0
    } else if a.y > a.z {
        1
    } else {
        2
    };
    let (azimuth, elevation) = match options.camera {
        Camera::Orbit { azimuth, elevation, .. } => (Some(azimuth), Some(elevation)),
        _ => (None, None),
    };
    let shade = match options.shade {
        Shade::Patches => "patches",
        Shade::Lit => "plain",
        Shade::Reflection => "reflection",
        Shade::Isophotes => "isophotes",
        Shade::Curvature => "mean",
        Shade::Deviation => "deviation",
    };
    View { up, azimuth, elevation, shade, bands: options.bands }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_program_ends_no_script_of_the_page() {
        for text in [SCRIPT, STYLE] {
            assert!(
                !text.to_lowercase().contains("</script")
                    && !text.contains("</style")
                    && !text.contains("<!--")
            );
        }
        // Its licence goes with it.
        assert!(SCRIPT.contains("@license"));
    }

    #[test]
    fn names_are_filled_in_once() {
        let value = |name: &str| match name {
            "a" => "{{b}}",
            "b" => "no",
            _ => "",
        };
        assert_eq!(fill("x {{a}} y {{c}}{{a}}", value), "x {{b}} y {{b}}");
        assert_eq!(escape("<a & \"b\">"), "&lt;a &amp; &quot;b&quot;&gt;");
    }
}
