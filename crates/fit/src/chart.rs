//! One chart as plain data, checked and measured.

use glam::{DVec2, DVec3};
use nalgebra::Matrix6;

use crate::rectangle::{Frame, minimum_area_rectangle};
use crate::system::local;
use crate::{EnergyOrder, FitError};

/// One chart as plain data: an abstract disc (collar included) with a parameter per vertex.
#[derive(Clone, Copy, Debug)]
pub struct FitInput<'a> {
    /// Chart vertices in space.
    pub points: &'a [DVec3],
    /// Their parameters.
    pub params: &'a [DVec2],
    /// Triangles over them, consistently oriented.
    pub triangles: &'a [[u32; 3]],
    /// Per triangle: whether it belongs to the segment (otherwise to its collar).
    pub in_segment: &'a [bool],
    /// Diagonal of the bounding box of the whole mesh; tolerances and reports are relative to it.
    pub diagonal: f64,
    /// How far outside the chart the surface will be evaluated, in units of the parameters.
    pub reach: f64,
}

/// A checked chart in local units: points about the middle of their bounding box, parameters in the surface's frame.
#[derive(Clone, Debug)]
pub(crate) struct Chart<'a> {
    pub(crate) triangles: &'a [[u32; 3]],
    /// `x = centre + scale · points`.
    pub(crate) points: Vec<DVec3>,
    pub(crate) centre: DVec3,
    pub(crate) scale: f64,
    pub(crate) params: Vec<DVec2>,
    pub(crate) frame: Frame,
    /// Sides of the minimum-area rectangle.
    pub(crate) size: DVec2,
    /// One third of the area around every vertex, sum one.
    pub(crate) weights: Vec<f64>,
    /// Vertex normals (not unit), summed over three rings: on a noisy mesh single facets and even single fans turn over
    /// without any fault of the surface.
    pub(crate) normals: Vec<DVec3>,
    /// Vertices with positive weight.
    pub(crate) vertices: usize,
    /// Per vertex: belongs to a triangle of the segment.
    pub(crate) in_segment: Vec<bool>,
    /// Area in the parameter plane.
    pub(crate) area: f64,
    /// Median edge in the parameter plane.
    pub(crate) edge: f64,
    /// Local lengths in space per length in the parameter plane.
    pub(crate) stretch: f64,
    /// +1 where the parameter triangles run counter-clockwise, −1 for a mirrored chart.
    pub(crate) orientation: f64,
    /// Local lengths times this are relative to the diagonal.
    pub(crate) relative: f64,
    pub(crate) reach: f64,
}

/// Narrowest admissible rectangle of the parameters.
const NARROWEST: f64 = 1e-10;

impl<'a> Chart<'a> {
    pub(crate) fn new(input: &FitInput<'a>) -> Result<Self, FitError> {
        check(input)?;
        let (centre, scale) = local(input.points);
        let points: Vec<DVec3> = input.points.iter().map(|&x| (x - centre) / scale).collect();
        let (frame, size) = minimum_area_rectangle(input.params);
        let ratio = if size.x > 0.0 { size.y / size.x } else { 0.0 };
        if ratio.is_nan() || ratio < NARROWEST {
            return Err(FitError::Collinear { ratio, limit: NARROWEST });
        }
        let params: Vec<DVec2> = input.params.iter().map(|&p| frame.apply(p)).collect();

        // Sums run over sorted terms: they do not depend on the order of vertices and triangles.
        let n = points.len();
        let (mut around, mut normals) = (vec![Vec::new(); n], vec![Vec::new(); n]);
        let (mut flat, mut signed) = (Vec::new(), Vec::new());
        let mut in_segment = vec![false; n];
        for (t, &inside) in input.triangles.iter().zip(input.in_segment) {
            let [a, b, c] = t.map(|v| v as usize);
            let normal = (points[b] - points[a]).cross(points[c] - points[a]) * 0.5;
            let s = 0.5 * (params[b] - params[a]).perp_dot(params[c] - params[a]);
            flat.push(s.abs());
            signed.push(s);
            for v in [a, b, c] {
                around[v].push(normal.length() / 3.0);
                normals[v].push(normal);
                in_segment[v] |= inside;
            }
        }
        let mut weights: Vec<f64> = around.into_iter().map(sum).collect();
        let space = sum(weights.clone());
        let area = sum(flat);
        if space.is_nan() || space <= 0.0 {
            return Err(FitError::ZeroArea { place: "in space" });
        }
        if area.is_nan() || area <= 0.0 {
            return Err(FitError::ZeroArea { place: "in the parameter plane" });
        }
        weights.iter_mut().for_each(|w| *w /= space);
        let vertices = weights.iter().filter(|&&w| w > 0.0).count();
        if vertices < 3 {
            return Err(FitError::TooFew { vertices, needed: 3 });
        }
        if !in_segment.iter().any(|&s| s) {
            return Err(FitError::EmptySegment);
        }
        let mut normals: Vec<DVec3> = normals.into_iter().map(sum_vectors).collect();
        for _ in 0..2 {
            let mut wider = vec![DVec3::ZERO; n];
            for t in input.triangles {
                let sum: DVec3 = t.iter().map(|&v| normals[v as usize]).sum();
                t.iter().for_each(|&v| wider[v as usize] += sum);
            }
            normals = wider;
        }
        let orientation = 1.0_f64.copysign(sum(signed));
        Ok(Self {
            edge: median_edge(input.triangles, &params),
            triangles: input.triangles,
            relative: scale / input.diagonal,
            normals,
            stretch: (space / area).sqrt(),
            reach: input.reach,
            points,
            centre,
            scale,
            params,
            frame,
            size,
            weights,
            vertices,
            in_segment,
            area,
            orientation,
        })
    }

    /// The highest order not above `wanted` whose free polynomials the vertices determine.
    pub(crate) fn order(&self, wanted: EnergyOrder) -> EnergyOrder {
        let half = self.size / 2.0;
        let mut gram = Matrix6::<f64>::zeros();
        for (p, &w) in self.params.iter().zip(&self.weights) {
            let s = *p / half;
            let row = nalgebra::Vector6::new(1.0, s.x, s.y, s.x * s.x, s.x * s.y, s.y * s.y);
            gram += row * row.transpose() * w;
        }
        let values = gram.symmetric_eigenvalues();
        // Eigenvalues are squares of singular values: rounding leaves some 1e-16 of the largest.
        if values.min() > 1e-13 * values.max() { wanted } else { EnergyOrder::Second }
    }
}

/// Sum in ascending order of magnitude and sign: depends on the terms as a set only.
fn sum(mut terms: Vec<f64>) -> f64 {
    terms.sort_by(f64::total_cmp);
    terms.iter().sum()
}

fn sum_vectors(mut terms: Vec<DVec3>) -> DVec3 {
    terms.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z)));
    terms.iter().sum()
}

fn median_edge(triangles: &[[u32; 3]], params: &[DVec2]) -> f64 {
    let mut edges: Vec<(u32, u32)> = triangles
        .iter()
        .flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)])
        .map(|(a, b)| (a.min(b), a.max(b)))
        .collect();
    edges.sort_unstable();
    edges.dedup();
    let mut lengths: Vec<f64> =
        edges.iter().map(|&(a, b)| params[a as usize].distance(params[b as usize])).collect();
    lengths.sort_by(f64::total_cmp);
    lengths.get(lengths.len() / 2).copied().unwrap_or(0.0)
}

fn check(input: &FitInput<'_>) -> Result<(), FitError> {
    let n = input.points.len();
    let length = |what, given, needed| match given == needed {
        true => Ok(()),
        false => Err(FitError::Length { what, given, needed }),
    };
    length("params", input.params.len(), n)?;
    length("in_segment", input.in_segment.len(), input.triangles.len())?;
    if n < 3 {
        return Err(FitError::TooFew { vertices: n, needed: 3 });
    }
    if let Some(index) = input.points.iter().position(|x| !x.is_finite()) {
        return Err(FitError::NotFinite { what: "point", index });
    }
    if let Some(index) = input.params.iter().position(|p| !p.is_finite()) {
        return Err(FitError::NotFinite { what: "parameter", index });
    }
    for (triangle, t) in input.triangles.iter().enumerate() {
        if let Some(&vertex) = t.iter().find(|&&v| v as usize >= n) {
            return Err(FitError::TriangleIndex { triangle, vertex, vertices: n });
        }
    }
    if !(input.diagonal > 0.0 && input.diagonal.is_finite()) {
        return Err(FitError::Value {
            name: "diagonal",
            value: input.diagonal,
            expected: "positive and finite",
        });
    }
    if !(input.reach >= 0.0 && input.reach.is_finite()) {
        return Err(FitError::Value {
            name: "reach",
            value: input.reach,
            expected: "not negative and finite",
        });
    }
    Ok(())
}
