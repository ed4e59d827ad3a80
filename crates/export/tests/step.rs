//! STEP files of surfaces whose every point is known.

mod common;

use std::collections::BTreeMap;

use common::*;
use glam::{DMat3, DVec2, DVec3};
use suture_export::{ExportError, Format, StepOptions, to_step, write};
use suture_surface::{
    Continuity, Domain, EdgeRef, Jet2, Patch, PatchId, PatchKind, Record, Seam, SplinePool, Surface,
};

/// The central projection of a plane domain onto the unit sphere.
#[derive(Clone, Debug)]
struct Ball {
    frame: DMat3,
    domain: Domain,
    centre: DVec3,
    radius: f64,
}

impl Patch for Ball {
    fn domain(&self) -> Domain {
        self.domain.clone()
    }

    fn jet(&self, at: DVec2) -> Jet2 {
        let (u, v) = (at.x, at.y);
        let q = DVec3::new(u, v, 1.0);
        // 1/|q| and its derivatives.
        let s = q.length_squared();
        let (a, b, c) = (s.powf(-0.5), s.powf(-1.5), 3.0 * s.powf(-2.5));
        let w = Jet2 { p: a, du: -u * b, dv: -v * b, duu: u * u * c - b, duv: u * v * c, dvv: v * v * c - b };
        let q = Jet2 { p: q, du: DVec3::X, dv: DVec3::Y, ..Jet2::default() };
        let mut jet = q.weighted(&w).map(|x| self.frame * x * self.radius);
        jet.p += self.centre;
        jet
    }

    fn kind(&self) -> PatchKind {
        PatchKind::Bubble { n: self.domain.edge_count() as u8 }
    }

    fn record(&self, _: &mut SplinePool) -> Record {
        Record { kind: "test.ball".into(), data: serde_json::Value::Null }
    }
}

/// Joins all edges that have the same ends.
fn sew(patches: Vec<Ball>) -> Surface {
    let ends = |p: &Ball, e: usize| [0.0, 1.0].map(|t| p.jet(p.domain.edge(e).unwrap().point(t)).p);
    let mut seams = Vec::new();
    let edges: Vec<(usize, usize)> = patches
        .iter()
        .enumerate()
        .flat_map(|(p, b)| (0..b.domain.edge_count()).map(move |e| (p, e)))
        .collect();
    for (i, &(p, e)) in edges.iter().enumerate() {
        for &(q, f) in &edges[i + 1..] {
            let ([a, b], [c, d]) = (ends(&patches[p], e), ends(&patches[q], f));
            if a.distance(d) + b.distance(c) < 1e-9 * (a.distance(b)) {
                let at = |p: usize, e: usize| EdgeRef { patch: PatchId(p as u32), edge: e as u32 };
                seams.push(Seam::new(at(p, e), at(q, f), Continuity::G2));
            }
        }
    }
    Surface::new(patches.into_iter().map(|p| Box::new(p) as Box<dyn Patch>).collect(), seams).unwrap()
}

/// A ball of six rectangles, the last ones left out.
fn cube(faces: usize, centre: DVec3, radius: f64) -> Surface {
    let frames = [
        [DVec3::X, DVec3::Y],
        [DVec3::Y, DVec3::X],
        [DVec3::Y, DVec3::Z],
        [DVec3::Z, DVec3::Y],
        [DVec3::Z, DVec3::X],
        [DVec3::X, DVec3::Z],
    ];
    let domain = Domain::Rectangle { min: -DVec2::ONE, max: DVec2::ONE };
    let ball = |[x, y]: [DVec3; 2]| Ball {
        frame: DMat3::from_cols(x, y, x.cross(y)),
        domain: domain.clone(),
        centre,
        radius,
    };
    sew(frames[..faces].iter().map(|&f| ball(f)).collect())
}

/// A ball of eight triangles.
fn octahedron() -> Surface {
    let signs = [1.0, -1.0];
    let mut patches = Vec::new();
    for x in signs {
        for y in signs {
            for z in signs {
                let mut corners = [DVec3::X * x, DVec3::Y * y, DVec3::Z * z];
                if x * y * z < 0.0 {
                    corners.swap(1, 2);
                }
                let n = corners.iter().sum::<DVec3>().normalize();
                let u = (corners[0] - n * corners[0].dot(n)).normalize();
                let frame = DMat3::from_cols(u, n.cross(u), n);
                let plane = |c: DVec3| {
                    let q = frame.transpose() * c;
                    DVec2::new(q.x, q.y) / q.z
                };
                let domain = Domain::Polygon(corners.map(plane).to_vec());
                patches.push(Ball { frame, domain, centre: DVec3::ZERO, radius: 1.0 });
            }
        }
    }
    sew(patches)
}

/// The instances of a file by number: keyword and arguments.
fn instances(bytes: &[u8]) -> BTreeMap<u64, String> {
    let text = std::str::from_utf8(bytes).unwrap();
    assert!(text.is_ascii());
    text.lines()
        .filter_map(|l| l.strip_prefix('#'))
        .map(|l| l.split_once('=').unwrap())
        .map(|(n, rest)| (n.parse().unwrap(), rest.strip_suffix(';').unwrap().to_owned()))
        .collect()
}

fn count(instances: &BTreeMap<u64, String>, keyword: &str) -> usize {
    let start = format!("{keyword}(");
    instances.values().filter(|i| i.starts_with(&start)).count()
}

/// Every reference is to an instance, every edge is used once in either direction unless it is open, every edge has a curve in the
/// parameters of each of its faces.
fn check(bytes: &[u8], open: usize) {
    let all = instances(bytes);
    let mut uses: BTreeMap<u64, Vec<bool>> = BTreeMap::new();
    for text in all.values() {
        for part in text.split('#').skip(1) {
            let number: String = part.chars().take_while(char::is_ascii_digit).collect();
            assert!(all.contains_key(&number.parse().unwrap()), "{text}");
        }
        if let Some(rest) = text.strip_prefix("ORIENTED_EDGE('',*,*,#") {
            let (edge, sense) = rest.split_once(',').unwrap();
            uses.entry(edge.parse().unwrap()).or_default().push(sense == ".T.)");
        }
    }
    assert_eq!(uses.len(), count(&all, "EDGE_CURVE"));
    let once = uses.values().filter(|u| u.len() == 1).count();
    assert_eq!(once, open);
    assert!(uses.values().filter(|u| u.len() != 1).all(|u| u.len() == 2 && u[0] != u[1]));
    assert_eq!(count(&all, "PCURVE"), 2 * uses.len() - open);
}

#[test]
fn a_ball_of_rectangles_is_a_solid() {
    let (bytes, report) = to_step(&cube(6, DVec3::ZERO, 1.0), &StepOptions::default()).unwrap();
    assert_eq!([report.faces, report.edges, report.vertices], [6, 12, 8]);
    assert_eq!([report.shells, report.open_edges], [1, 0]);
    check(&bytes, 0);
    let all = instances(&bytes);
    assert_eq!(
        [count(&all, "ADVANCED_FACE"), count(&all, "CLOSED_SHELL"), count(&all, "MANIFOLD_SOLID_BREP")],
        [6, 1, 1]
    );
    assert!(report.position < 1e-6 && report.gap < 1e-12, "{report:?}");
    assert!(report.angle < 1e-4 && report.curvature < 0.01, "{report:?}");
    assert!((report.diagonal - 12f64.sqrt() / 3f64.sqrt()).abs() < 2.0);
}

#[test]
fn triangles_become_kites_that_join() {
    let (bytes, report) = to_step(&octahedron(), &StepOptions::default()).unwrap();
    assert_eq!([report.faces, report.edges, report.vertices], [24, 48, 26]);
    check(&bytes, 0);
    assert!(report.position < 1e-6 && report.gap < 1e-12, "{report:?}");
    assert!(report.angle < 1e-4 && report.curvature < 0.01, "{report:?}");
}

#[test]
fn an_open_surface_is_a_shell() {
    let (bytes, report) = to_step(&cube(5, DVec3::ZERO, 1.0), &StepOptions::default()).unwrap();
    assert_eq!([report.faces, report.edges, report.vertices, report.open_edges], [5, 12, 8, 4]);
    check(&bytes, 4);
    let all = instances(&bytes);
    assert_eq!([count(&all, "OPEN_SHELL"), count(&all, "MANIFOLD_SOLID_BREP")], [1, 0]);
    let (bytes, report) = to_step(&two(1.0, DVec3::ZERO), &StepOptions::default()).unwrap();
    assert_eq!([report.faces, report.edges, report.vertices, report.open_edges], [2, 7, 6, 6]);
    check(&bytes, 6);
    assert!(report.position < 1e-6, "{report:?}");
    // The trimmed one leaves as it is, the other one is refitted.
    let text = String::from_utf8(bytes).unwrap();
    assert!(
        text.contains("=B_SPLINE_SURFACE_WITH_KNOTS('',2,2,")
            && text.contains("=B_SPLINE_SURFACE_WITH_KNOTS('',5,5,")
    );
}

#[test]
fn a_finer_tolerance_holds_and_costs_points() {
    let solid = cube(6, DVec3::ZERO, 1.0);
    let with = |tolerance| to_step(&solid, &StepOptions { tolerance, ..StepOptions::default() }).unwrap().1;
    let (coarse, fine) = (with(1e-4), with(1e-9));
    assert!(coarse.position < 1e-4 && fine.position < 1e-9);
    assert!(fine.control_points > 2 * coarse.control_points, "{coarse:?} {fine:?}");
    let impossible = to_step(&solid, &StepOptions { tolerance: 1e-30, ..StepOptions::default() });
    assert!(matches!(impossible, Err(ExportError::StepTolerance { .. })));
}

#[test]
fn units_of_length_change_nothing_but_the_numbers() {
    let (_, one) = to_step(&cube(6, DVec3::ZERO, 1.0), &StepOptions::default()).unwrap();
    for scale in [2f64.powi(20), 2f64.powi(-20)] {
        let (bytes, other) = to_step(&cube(6, DVec3::ZERO, scale), &StepOptions::default()).unwrap();
        check(&bytes, 0);
        assert_eq!([one.faces, one.control_points], [other.faces, other.control_points]);
        assert!(
            (one.position - other.position).abs() < 1e-12
                && (other.diagonal / one.diagonal - scale).abs() < 1e-9 * scale
        );
        assert!(other.uncertainty >= 1e-7);
    }
}

#[test]
fn names_units_and_bytes() {
    let solid = cube(6, DVec3::ZERO, 1.0);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("Flügel's 翼.STP");
    assert_eq!(Format::from_path(&path).unwrap(), Format::Step);
    write(&path, Format::Step, &solid, None).unwrap();
    let first = std::fs::read(&path).unwrap();
    let text = String::from_utf8(first.clone()).unwrap();
    assert!(text.contains("PRODUCT('Fl\\X2\\00FC\\X0\\gel''s \\X2\\7FFC\\X0\\',"), "{text}");
    assert!(text.contains("SI_UNIT(.MILLI.,.METRE.)"));
    write(&path, Format::Step, &solid, None).unwrap();
    assert_eq!(first, std::fs::read(&path).unwrap());
    let unknown = Format::from_path("part.stpz").unwrap_err().to_string();
    assert!(unknown.contains(".step"), "{unknown}");
}

#[test]
fn what_has_no_form_is_named() {
    let curve = |a: DVec2, b: DVec2, c: DVec2| suture_bernstein::BezierCurve::new(vec![a, b, c]).unwrap();
    let (a, b) = (DVec2::ZERO, DVec2::X);
    let lens = vec![vec![curve(a, DVec2::new(0.5, -0.5), b), curve(b, DVec2::new(0.5, 0.5), a)]];
    let patch =
        Ball { frame: DMat3::IDENTITY, domain: Domain::Trimmed(lens), centre: DVec3::ZERO, radius: 1.0 };
    let error = to_step(&sew(vec![patch]), &StepOptions::default()).unwrap_err();
    assert!(matches!(error, ExportError::StepPatch { patch: 0, .. }), "{error}");
    let mut broken = cube(6, DVec3::ZERO, f64::NAN);
    assert!(to_step(&broken, &StepOptions::default()).is_err());
    broken = cube(0, DVec3::ZERO, 1.0);
    assert_eq!(to_step(&broken, &StepOptions::default()).unwrap().1.faces, 0);
}
