//! Tensor-product nets: Bézier patches and B-spline surfaces.

use glam::DVec2;

use crate::curve::check_finite;
use crate::{Jet2, MAX_DEGREE, NetError, SMALL, Vector, bernstein, bspline};

/// A tensor-product Bézier patch on `[0, 1]²`.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(try_from = "RawPatch<T>", bound(deserialize = "T: Vector + serde::Deserialize<'de>"))
)]
pub struct BezierPatch<T> {
    degree: [usize; 2],
    net: Vec<T>,
}

impl<T: Vector> BezierPatch<T> {
    /// A patch of `degree` `[m, n]` from its `(m + 1)(n + 1)` control points, second index fastest.
    ///
    /// # Errors
    /// [`NetError::Degree`], [`NetError::Count`], [`NetError::NotFinite`].
    pub fn new(degree: [usize; 2], net: Vec<T>) -> Result<Self, NetError> {
        if let Some(&degree) = degree.iter().find(|&&d| d > MAX_DEGREE) {
            return Err(NetError::Degree { degree });
        }
        let needed = (degree[0] + 1) * (degree[1] + 1);
        if net.len() != needed {
            return Err(NetError::Count { given: net.len(), needed });
        }
        check_finite(&net)?;
        Ok(Self { degree, net })
    }

    /// A patch from a net that is known to be good: finite, of allowed degrees and the right size.
    pub(crate) fn from_checked(degree: [usize; 2], net: Vec<T>) -> Self {
        Self { degree, net }
    }

    /// Degrees in `u` and `v`.
    pub fn degree(&self) -> [usize; 2] {
        self.degree
    }

    /// Number of control points in `u` and `v`.
    pub fn count(&self) -> [usize; 2] {
        self.degree.map(|d| d + 1)
    }

    /// The control points, second index fastest.
    pub fn net(&self) -> &[T] {
        &self.net
    }

    /// Value and partials to second order. The corners of the net are interpolated to the bit.
    pub fn jet(&self, at: DVec2) -> Jet2<T> {
        // Constant degrees unroll; these are the ones that strips and bicubic pieces have.
        match self.degree {
            [3, 3] => self.jet_fixed::<4, 4>(at),
            [5, 1] => self.jet_fixed::<6, 2>(at),
            [5, 2] => self.jet_fixed::<6, 3>(at),
            [5, 3] => self.jet_fixed::<6, 4>(at),
            [p, q] if p.max(q) < SMALL => self.jet_sized::<SMALL>(at),
            _ => self.jet_sized::<LARGE>(at),
        }
    }

    /// Value, to the bit the one of [`jet`](Self::jet).
    pub fn point(&self, at: DVec2) -> T {
        let (mut bu, mut bv) = ([[0.0]; LARGE], [[0.0]; LARGE]);
        let [p, q] = self.degree;
        bernstein::jets(p, at.x, &mut bu);
        bernstein::jets(q, at.y, &mut bv);
        combine_values(&self.net, q + 1, &bu[..=p], &bv[..=q])
    }

    /// For `M × N` control points.
    #[inline(always)]
    fn jet_fixed<const M: usize, const N: usize>(&self, at: DVec2) -> Jet2<T> {
        let (mut bu, mut bv) = ([[0.0; 3]; M], [[0.0; 3]; N]);
        bernstein::unrolled(M - 1, at.x, &mut bu);
        bernstein::unrolled(N - 1, at.y, &mut bv);
        combine_fixed(&self.net, N, &bu, &bv)
    }

    /// For at most `N` control points in either direction.
    fn jet_sized<const N: usize>(&self, at: DVec2) -> Jet2<T> {
        let (mut bu, mut bv) = ([[0.0; 3]; N], [[0.0; 3]; N]);
        let [p, q] = self.degree;
        bernstein::jets(p, at.x, &mut bu);
        bernstein::jets(q, at.y, &mut bv);
        combine(&self.net, q + 1, &bu[..=p], &bv[..=q])
    }
}

/// A tensor-product B-spline surface.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(try_from = "RawSurface<T>", bound(deserialize = "T: Vector + serde::Deserialize<'de>"))
)]
pub struct BSplineSurface<T> {
    degree: [usize; 2],
    knots: [Vec<f64>; 2],
    net: Vec<T>,
}

impl<T: Vector> BSplineSurface<T> {
    /// A surface of `degree` over two knot vectors; `net` holds `count_u × count_v` control points, second index fastest,
    /// with `count = knots.len() − degree − 1` in either direction.
    ///
    /// # Errors
    /// [`NetError::Degree`], [`NetError::Count`], [`NetError::Knots`], [`NetError::NotFinite`].
    pub fn new(degree: [usize; 2], knots: [Vec<f64>; 2], net: Vec<T>) -> Result<Self, NetError> {
        let count = |d: usize| knots[d].len().saturating_sub(degree[d]).saturating_sub(1);
        for d in 0..2 {
            bspline::check(degree[d], count(d), &knots[d])?;
        }
        let needed = count(0).saturating_mul(count(1));
        if net.len() != needed {
            return Err(NetError::Count { given: net.len(), needed });
        }
        check_finite(&net)?;
        Ok(Self { degree, knots, net })
    }

    /// A surface over uniform knots, not clamped: its domain is `cells[0] × cells[1]` cells of size `cell` with the lower corner
    /// at `origin`; `net` holds `(cells[0] + degree[0]) × (cells[1] + degree[1])` control points, second index fastest.
    ///
    /// Knot `i` is `origin + (i − degree) cell`, one product and one sum: equal input gives equal bits.
    ///
    /// # Errors
    /// [`NetError::Degree`], [`NetError::Count`], [`NetError::NotFinite`]; [`NetError::Knots`] when `cells` has a zero, when
    /// `cell` is not positive, or when it is lost in the rounding of `origin`.
    pub fn uniform(
        degree: [usize; 2],
        origin: DVec2,
        cell: DVec2,
        cells: [usize; 2],
        net: Vec<T>,
    ) -> Result<Self, NetError> {
        if let Some(&degree) = degree.iter().find(|&&d| d > MAX_DEGREE) {
            return Err(NetError::Degree { degree });
        }
        // Counted before the knots are made: a number of cells that memory cannot hold must fail here.
        let count = [0, 1].map(|d| cells[d].saturating_add(degree[d]));
        let needed = count[0].saturating_mul(count[1]);
        if net.len() != needed {
            return Err(NetError::Count { given: net.len(), needed });
        }
        if let Some(d) = (0..2).find(|&d| cells[d] == 0) {
            return Err(NetError::Knots { index: degree[d] });
        }
        let knots = [0, 1].map(|d| {
            let knot = |i: usize| origin[d] + (i as f64 - degree[d] as f64) * cell[d];
            (0..=count[d] + degree[d]).map(knot).collect()
        });
        Self::new(degree, knots, net)
    }

    /// Degrees in `u` and `v`.
    pub fn degree(&self) -> [usize; 2] {
        self.degree
    }

    /// Knot vectors in `u` and `v`.
    pub fn knots(&self) -> [&[f64]; 2] {
        [&self.knots[0], &self.knots[1]]
    }

    /// Number of control points in `u` and `v`.
    pub fn count(&self) -> [usize; 2] {
        [0, 1].map(|d| self.knots[d].len() - self.degree[d] - 1)
    }

    /// The control points, second index fastest.
    pub fn net(&self) -> &[T] {
        &self.net
    }

    /// Lower and upper corner of the parameter rectangle.
    pub fn domain(&self) -> [DVec2; 2] {
        let count = self.count();
        let end = |d: usize, i: usize| self.knots[d][i];
        [
            DVec2::new(end(0, self.degree[0]), end(1, self.degree[1])),
            DVec2::new(end(0, count[0]), end(1, count[1])),
        ]
    }

    /// Value and partials to second order; on a knot line those of the piece above it, at the upper end of the domain of the
    /// piece below. Clamped corners are interpolated to the bit.
    pub fn jet(&self, at: DVec2) -> Jet2<T> {
        match self.degree {
            // Constant degrees unroll.
            [3, 3] => self.jet_fixed::<4, 4>(at),
            [p, q] if p.max(q) < SMALL => self.jet_sized::<SMALL>(at),
            _ => self.jet_sized::<LARGE>(at),
        }
    }

    /// Value, to the bit the one of [`jet`](Self::jet).
    pub fn point(&self, at: DVec2) -> T {
        let (mut bu, mut bv) = ([[0.0]; LARGE], [[0.0]; LARGE]);
        let [p, q] = self.degree;
        let i = bspline::span(p, &self.knots[0], at.x);
        let j = bspline::span(q, &self.knots[1], at.y);
        bspline::jets(p, &self.knots[0], i, at.x, &mut bu);
        bspline::jets(q, &self.knots[1], j, at.y, &mut bv);
        let columns = self.count()[1];
        combine_values(&self.net[(i - p) * columns + j - q..], columns, &bu[..=p], &bv[..=q])
    }

    /// For `M × N` control points on every piece.
    #[inline(always)]
    fn jet_fixed<const M: usize, const N: usize>(&self, at: DVec2) -> Jet2<T> {
        let (mut bu, mut bv) = ([[0.0; 3]; M], [[0.0; 3]; N]);
        let [p, q] = [M - 1, N - 1];
        let i = bspline::span(p, &self.knots[0], at.x);
        let j = bspline::span(q, &self.knots[1], at.y);
        bspline::unrolled(p, &self.knots[0], i, at.x, &mut bu);
        bspline::unrolled(q, &self.knots[1], j, at.y, &mut bv);
        let columns = self.knots[1].len() - N;
        combine_fixed(&self.net[(i - p) * columns + j - q..], columns, &bu, &bv)
    }

    /// For at most `N` control points in either direction on every piece.
    fn jet_sized<const N: usize>(&self, at: DVec2) -> Jet2<T> {
        let (mut bu, mut bv) = ([[0.0; 3]; N], [[0.0; 3]; N]);
        let [p, q] = self.degree;
        let i = bspline::span(p, &self.knots[0], at.x);
        let j = bspline::span(q, &self.knots[1], at.y);
        bspline::jets(p, &self.knots[0], i, at.x, &mut bu);
        bspline::jets(q, &self.knots[1], j, at.y, &mut bv);
        let columns = self.knots[1].len() - q - 1;
        combine(&self.net[(i - p) * columns + j - q..], columns, &bu[..=p], &bv[..=q])
    }
}

const LARGE: usize = MAX_DEGREE + 1;

/// Sums the net (rows `columns` apart) against both bases, along `u` first.
fn combine<T: Vector>(net: &[T], columns: usize, bu: &[[f64; 3]], bv: &[[f64; 3]]) -> Jet2<T> {
    let mut jet = Jet2::default();
    for (j, v) in bv.iter().enumerate() {
        let mut c = [T::default(); 3];
        for (i, u) in bu.iter().enumerate() {
            let p = net[i * columns + j];
            for d in 0..3 {
                c[d] = c[d] + p * u[d];
            }
        }
        add_column(&mut jet, c, v);
    }
    jet
}

/// [`combine`] to the bit, row by row: a row of constant length is one run of numbers to the vector unit.
#[inline(always)]
fn combine_fixed<T: Vector, const M: usize, const N: usize>(
    net: &[T],
    columns: usize,
    bu: &[[f64; 3]; M],
    bv: &[[f64; 3]; N],
) -> Jet2<T> {
    let mut c = [[T::default(); 3]; N];
    for i in 0..M {
        let row = &net[i * columns..i * columns + N];
        for d in 0..3 {
            for j in 0..N {
                c[j][d] = c[j][d] + row[j] * bu[i][d];
            }
        }
    }
    let mut jet = Jet2::default();
    for j in 0..N {
        add_column(&mut jet, c[j], &bv[j]);
    }
    jet
}

/// Adds a column, summed along `u` for every derivative in `u`, with the basis function of its `v`.
#[inline(always)]
fn add_column<T: Vector>(jet: &mut Jet2<T>, c: [T; 3], v: &[f64; 3]) {
    jet.p = jet.p + c[0] * v[0];
    jet.du = jet.du + c[1] * v[0];
    jet.dv = jet.dv + c[0] * v[1];
    jet.duu = jet.duu + c[2] * v[0];
    jet.duv = jet.duv + c[1] * v[1];
    jet.dvv = jet.dvv + c[0] * v[2];
}

/// [`combine`] to the bit, for the value alone.
fn combine_values<T: Vector>(net: &[T], columns: usize, bu: &[[f64; 1]], bv: &[[f64; 1]]) -> T {
    bv.iter().enumerate().fold(T::default(), |p, (j, v)| {
        let column = bu.iter().enumerate();
        p + column.fold(T::default(), |c, (i, u)| c + net[i * columns + j] * u[0]) * v[0]
    })
}

/// What is read before it is checked.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct RawPatch<T> {
    degree: [usize; 2],
    net: Vec<T>,
}

#[cfg(feature = "serde")]
impl<T: Vector> TryFrom<RawPatch<T>> for BezierPatch<T> {
    type Error = NetError;

    fn try_from(raw: RawPatch<T>) -> Result<Self, NetError> {
        Self::new(raw.degree, raw.net)
    }
}

/// What is read before it is checked.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct RawSurface<T> {
    degree: [usize; 2],
    knots: [Vec<f64>; 2],
    net: Vec<T>,
}

#[cfg(feature = "serde")]
impl<T: Vector> TryFrom<RawSurface<T>> for BSplineSurface<T> {
    type Error = NetError;

    fn try_from(raw: RawSurface<T>) -> Result<Self, NetError> {
        Self::new(raw.degree, raw.knots, raw.net)
    }
}
