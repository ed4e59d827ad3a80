//! A boundary representation as instances of AP214 (ISO 10303-214) and of the resources it is made of (ISO 10303-41, -42, -43, -46).

use glam::DVec3;
use suture_bernstein::{BSplineCurve, BSplineSurface, Vector};

use super::brep::{Brep, Face, Geometry, Pcurve};
use super::part21::{Id, Real, Section, Text, list};
use crate::group::GROUPS;

/// The schema that the file follows.
const SCHEMA: &str = "AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }";

/// What the file says beside the shape.
#[derive(Clone, Copy, Debug)]
pub(crate) struct About<'a> {
    pub(crate) name: &'a str,
    /// Prefix of the metre, as Part 41 names it, for example `MILLI`; none for the metre itself.
    pub(crate) prefix: Option<&'static str>,
    /// Largest distance at which what should be one point is one point, in the units of the file.
    pub(crate) uncertainty: f64,
    pub(crate) time: &'a str,
}

/// The text of the file.
pub(crate) fn file(brep: &Brep, about: &About<'_>) -> String {
    let mut s = Section::default();
    let plane = s.add(format_args!(
        "(GEOMETRIC_REPRESENTATION_CONTEXT(2)PARAMETRIC_REPRESENTATION_CONTEXT()REPRESENTATION_CONTEXT('2D SPACE',''))"
    ));
    let surfaces: Vec<Id> = brep.faces.iter().map(|f| geometry(&mut s, &f.geometry)).collect();
    let vertices: Vec<Id> = brep
        .vertices
        .iter()
        .map(|v| {
            let point = s.point(&v.to_array());
            s.add(format_args!("VERTEX_POINT('',{point})"))
        })
        .collect();
    // The uses of every edge, in the order of the faces.
    let mut uses: Vec<Vec<(usize, &Pcurve)>> = vec![Vec::new(); brep.edges.len()];
    for (f, face) in brep.faces.iter().enumerate() {
        for coedge in face.loops.iter().flatten() {
            if let Some(pcurve) = &coedge.pcurve {
                uses[coedge.edge].push((f, pcurve));
            }
        }
    }
    let edges: Vec<Id> = brep
        .edges
        .iter()
        .zip(&uses)
        .map(|(edge, uses)| {
            let mut geometry = match &edge.circle {
                Some((frame, radius)) => {
                    let at = placement(&mut s, frame);
                    s.add(format_args!("CIRCLE('',{at},{})", Real(*radius)))
                }
                None => curve(&mut s, &edge.curve),
            };
            if !uses.is_empty() {
                let pcurves: Vec<Id> = uses
                    .iter()
                    .map(|(f, p)| {
                        let line = pcurve(&mut s, p);
                        let whole = s.share(format!("DEFINITIONAL_REPRESENTATION('',({line}),{plane})"));
                        s.add(format_args!("PCURVE('',{},{whole})", surfaces[*f]))
                    })
                    .collect();
                let pcurves = list(&pcurves, |&p| p);
                geometry = s.add(format_args!("SURFACE_CURVE('',{geometry},{pcurves},.CURVE_3D.)"));
            }
            let [a, b] = edge.ends.map(|v| vertices[v]);
            s.add(format_args!("EDGE_CURVE('',{a},{b},{geometry},.T.)"))
        })
        .collect();
    let faces: Vec<Id> =
        brep.faces.iter().zip(&surfaces).map(|(f, &surface)| face(&mut s, f, surface, &edges)).collect();
    structure(&mut s, brep, &faces, about);
    s.finish(about.name, SCHEMA, about.time, concat!("suture ", env!("CARGO_PKG_VERSION")))
}

fn face(s: &mut Section, face: &Face, surface: Id, edges: &[Id]) -> Id {
    let bounds: Vec<Id> = face
        .loops
        .iter()
        .enumerate()
        .map(|(l, loop_)| {
            // An edge loop runs counter-clockwise as seen from the outside: the other way round where the patch is flipped.
            let mut coedges: Vec<_> =
                loop_.iter().map(|c| (edges[c.edge], c.forward != face.flipped)).collect();
            if face.flipped {
                coedges.reverse();
            }
            let coedges: Vec<Id> = coedges
                .into_iter()
                .map(|(edge, forward)| {
                    s.add(format_args!("ORIENTED_EDGE('',*,*,{edge},{})", logical(forward)))
                })
                .collect();
            let whole = list(&coedges, |&c| c);
            let whole = s.add(format_args!("EDGE_LOOP('',{whole})"));
            let keyword = if l == 0 { "FACE_OUTER_BOUND" } else { "FACE_BOUND" };
            s.add(format_args!("{keyword}('',{whole},.T.)"))
        })
        .collect();
    let bounds = list(&bounds, |&b| b);
    let name = Text(&face.name);
    s.add(format_args!("ADVANCED_FACE({name},{bounds},{surface},{})", logical(face.flipped == face.against)))
}

fn logical(yes: bool) -> &'static str {
    if yes { ".T." } else { ".F." }
}

fn direction(s: &mut Section, d: &[f64]) -> Id {
    let d = list(d, |&x| Real(x));
    s.add(format_args!("DIRECTION('',{d})"))
}

fn placement(s: &mut Section, [origin, axis, zero]: &[DVec3; 3]) -> Id {
    let origin = s.point(&origin.to_array());
    let (axis, zero) = (direction(s, &axis.to_array()), direction(s, &zero.to_array()));
    s.add(format_args!("AXIS2_PLACEMENT_3D('',{origin},{axis},{zero})"))
}

fn geometry(s: &mut Section, geometry: &Geometry) -> Id {
    match geometry {
        Geometry::Spline(surface) => spline(s, surface),
        Geometry::Plane { frame } => {
            let at = placement(s, frame);
            s.add(format_args!("PLANE('',{at})"))
        }
        Geometry::Sphere { frame, radius } => {
            let at = placement(s, frame);
            s.add(format_args!("SPHERICAL_SURFACE('',{at},{})", Real(*radius)))
        }
        Geometry::Cylinder { frame, radius } => {
            let at = placement(s, frame);
            s.add(format_args!("CYLINDRICAL_SURFACE('',{at},{})", Real(*radius)))
        }
        Geometry::Cone { frame, radius, angle } => {
            let at = placement(s, frame);
            s.add(format_args!("CONICAL_SURFACE('',{at},{},{})", Real(*radius), Real(*angle)))
        }
    }
}

/// Distinct knots and their multiplicities, as lists.
fn knots(knots: &[f64]) -> [String; 2] {
    let mut distinct: Vec<(f64, usize)> = Vec::new();
    for &t in knots {
        match distinct.last_mut() {
            Some((last, count)) if *last == t => *count += 1,
            _ => distinct.push((t, 1)),
        }
    }
    [list(&distinct, |&(_, n)| n), list(&distinct, |&(t, _)| Real(t))]
}

fn spline(s: &mut Section, surface: &BSplineSurface<DVec3>) -> Id {
    let columns = surface.count()[1];
    let points: Vec<Id> = surface.net().iter().map(|p| s.point(&p.to_array())).collect();
    let rows: Vec<&[Id]> = points.chunks(columns).collect();
    let net = list(&rows, |row| list(row, |&p| p));
    let [p, q] = surface.degree();
    let [ku, kv] = surface.knots();
    let ([mu, tu], [mv, tv]) = (knots(ku), knots(kv));
    s.add(format_args!(
        "B_SPLINE_SURFACE_WITH_KNOTS('',{p},{q},{net},.UNSPECIFIED.,.F.,.F.,.F.,{mu},{mv},{tu},{tv},.UNSPECIFIED.)"
    ))
}

fn curve(s: &mut Section, curve: &BSplineCurve<DVec3>) -> Id {
    let net: Vec<Id> = curve.net().iter().map(|p| s.point(&p.to_array())).collect();
    b_spline(s, curve, &net)
}

fn b_spline<T: Vector>(s: &mut Section, curve: &BSplineCurve<T>, net: &[Id]) -> Id {
    let (degree, net) = (curve.degree(), list(net, |&p| p));
    let [m, t] = knots(curve.knots());
    s.add(format_args!(
        "B_SPLINE_CURVE_WITH_KNOTS('',{degree},{net},.UNSPECIFIED.,.F.,.F.,{m},{t},.UNSPECIFIED.)"
    ))
}

fn pcurve(s: &mut Section, pcurve: &Pcurve) -> Id {
    match pcurve {
        Pcurve::Line { origin, direction: d } => {
            // The sides of blocks lie on few lines.
            let [origin, d] = [origin, d].map(|x| list(&x.to_array(), |&x| Real(x)));
            let origin = s.share(format!("CARTESIAN_POINT('',{origin})"));
            let d = s.share(format!("DIRECTION('',{d})"));
            let d = s.share(format!("VECTOR('',{d},1.)"));
            s.share(format!("LINE('',{origin},{d})"))
        }
        Pcurve::Spline(curve) => {
            let net: Vec<Id> = curve.net().iter().map(|p| s.point(&p.to_array())).collect();
            b_spline(s, curve, &net)
        }
    }
}

/// Shells, units, product and colours.
fn structure(s: &mut Section, brep: &Brep, faces: &[Id], about: &About<'_>) {
    let name = Text(about.name);
    let prefix = about.prefix.map_or("$".into(), |p| format!(".{p}."));
    let length = s.add(format_args!("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT({prefix},.METRE.))"));
    let angle = s.add(format_args!("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))"));
    let solid_angle = s.add(format_args!("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())"));
    let uncertainty = s.add(format_args!(
        "UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE({}),{length},'distance_accuracy_value','confusion accuracy')",
        Real(about.uncertainty)
    ));
    let context = s.add(format_args!(
        "(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT(({uncertainty}))\
         GLOBAL_UNIT_ASSIGNED_CONTEXT(({length},{angle},{solid_angle}))REPRESENTATION_CONTEXT('Context #1','3D'))"
    ));
    let at = placement(s, &[DVec3::ZERO, DVec3::Z, DVec3::X]);

    // One solid per component that is closed, one shell in a surface model per component that is open.
    let shells = brep.faces.iter().map(|f| f.shell + 1).max().unwrap_or(0);
    let mut uses = vec![0usize; brep.edges.len()];
    for coedge in brep.faces.iter().flat_map(|f| f.loops.iter().flatten()) {
        uses[coedge.edge] += 1;
    }
    let (mut solids, mut open) = (Vec::new(), Vec::new());
    for shell in 0..shells {
        let members: Vec<usize> = (0..faces.len()).filter(|&f| brep.faces[f].shell == shell).collect();
        let closed = members
            .iter()
            .flat_map(|&f| brep.faces[f].loops.iter().flatten())
            .all(|coedge| uses[coedge.edge] == 2);
        let of = list(&members, |&f| faces[f]);
        if closed {
            let of = s.add(format_args!("CLOSED_SHELL('',{of})"));
            solids.push(s.add(format_args!("MANIFOLD_SOLID_BREP({name},{of})")));
        } else {
            open.push(s.add(format_args!("OPEN_SHELL('',{of})")));
        }
    }

    let application =
        s.add(format_args!("APPLICATION_CONTEXT('core data for automotive mechanical design processes')"));
    s.add(format_args!(
        "APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,{application})"
    ));
    let product = s.add(format_args!("PRODUCT_CONTEXT('',{application},'mechanical')"));
    let product = s.add(format_args!("PRODUCT({name},{name},'',({product}))"));
    s.add(format_args!("PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,({product}))"));
    let formation = s.add(format_args!("PRODUCT_DEFINITION_FORMATION('','',{product})"));
    let definition =
        s.add(format_args!("PRODUCT_DEFINITION_CONTEXT('part definition',{application},'design')"));
    let definition = s.add(format_args!("PRODUCT_DEFINITION('design','',{formation},{definition})"));
    let shape = s.add(format_args!("PRODUCT_DEFINITION_SHAPE('','',{definition})"));
    let representation = if open.is_empty() {
        let items = list(&[&[at][..], &solids].concat(), |&i| i);
        s.add(format_args!("ADVANCED_BREP_SHAPE_REPRESENTATION({name},{items},{context})"))
    } else {
        // Closed components beside open ones are shells of the same surface model: a representation is of one sort.
        let mut models = vec![at];
        let closed: Vec<Id> = Vec::new();
        for shell in open.iter().chain(&closed) {
            models.push(s.add(format_args!("SHELL_BASED_SURFACE_MODEL({name},({shell}))")));
        }
        models.extend(&solids);
        let items = list(&models, |&i| i);
        let sort =
            if solids.is_empty() { "MANIFOLD_SURFACE_SHAPE_REPRESENTATION" } else { "SHAPE_REPRESENTATION" };
        s.add(format_args!("{sort}({name},{items},{context})"))
    };
    s.add(format_args!("SHAPE_DEFINITION_REPRESENTATION({shape},{representation})"));
    colours(s, brep, faces, context);
}

fn colours(s: &mut Section, brep: &Brep, faces: &[Id], context: Id) {
    let mut items = Vec::with_capacity(faces.len());
    for (number, group) in GROUPS.iter().enumerate() {
        let members: Vec<usize> = (0..faces.len()).filter(|&f| brep.faces[f].colour == number).collect();
        if members.is_empty() {
            continue;
        }
        let [r, g, b] = group.colour.map(|c| Real((f64::from(c) / 255.0 * 1e4).round() / 1e4));
        let colour = s.add(format_args!("COLOUR_RGB('{}',{r},{g},{b})", group.name));
        let colour = s.add(format_args!("FILL_AREA_STYLE_COLOUR('',{colour})"));
        let style = s.add(format_args!("FILL_AREA_STYLE('',({colour}))"));
        let style = s.add(format_args!("SURFACE_STYLE_FILL_AREA({style})"));
        let style = s.add(format_args!("SURFACE_SIDE_STYLE('',({style}))"));
        let style = s.add(format_args!("SURFACE_STYLE_USAGE(.BOTH.,{style})"));
        let style = s.add(format_args!("PRESENTATION_STYLE_ASSIGNMENT(({style}))"));
        for f in members {
            items.push(s.add(format_args!("STYLED_ITEM('color',({style}),{})", faces[f])));
        }
    }
    if !items.is_empty() {
        let items = list(&items, |&i| i);
        s.add(format_args!("MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION('',{items},{context})"));
    }
}
