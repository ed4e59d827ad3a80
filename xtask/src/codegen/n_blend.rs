//! The weights of the N-blends (Wagner, Hormann, Greiner, "C²-continuous surface reconstruction with piecewise polynomial
//! patches", 2003, Sections 5.2 and 6.1), computed exactly.
//!
//! `H^{N,1}` consists of `N` Bézier triangles of degree 7; triangle `α` has the corners `(R^α, R^{α+1}, O)` for the indices
//! `(i, j, k)`, `R^1 … R^N` being the corners of the regular N-gon of edge length 1 around `O`. All coefficients are unknowns
//! of the conditions (H16)–(H18), (H23)–(H25) and C² across the inner edges; what they leave free minimises the thin plate
//! energy.

use super::field::{Elem, Field};
use super::linear::{Affine, Solutions};
use super::net::{COUNT, DEGREE, at, indices, raise};

/// The blending function `H^{N,1}`.
#[derive(Debug)]
pub(crate) struct NBlend {
    pub(crate) field: &'static Field,
    /// Net of triangle `α` at `α − 1`.
    pub(crate) nets: Vec<Vec<Elem>>,
    /// Degrees of freedom that the conditions leave.
    pub(crate) freedom: usize,
    /// Thin plate energy over the N-gon divided by the area of one triangle, which need not lie in the field.
    energy: Elem,
}

impl NBlend {
    /// Computes `H^{N,1}`.
    ///
    /// # Errors
    /// For `n` outside `3..=8`.
    pub(crate) fn new(n: usize) -> Result<Self, String> {
        let field = Field::of(n).ok_or_else(|| format!("no number field for N = {n}"))?;
        let mut solutions = Solutions::all(field);
        for form in conditions(field) {
            solutions.impose(form)?;
        }
        minimise(field, &solutions)
    }

    /// `∫ H_UU² + 2 H_UV² + H_VV²` over the N-gon of edge length 1.
    pub(crate) fn energy(&self) -> f64 {
        self.energy.to_f64() * apothem_squared(self.field).to_f64().sqrt() / 2.0
    }

    /// The nets, every coefficient rounded once.
    pub(crate) fn rounded(&self) -> Vec<Vec<f64>> {
        self.nets.iter().map(|net| net.iter().map(Elem::to_f64).collect()).collect()
    }
}

/// The linear conditions, each a form that is to vanish.
fn conditions(field: &'static Field) -> Vec<Affine> {
    let n = field.n();
    let one = field.int(1);
    let unknown = |triangle: usize, q: [usize; 3]| (triangle % n) * COUNT + at(q);
    let form = |terms: &[(usize, Elem)]| {
        let mut form = Affine::constant(field.int(0));
        terms.iter().for_each(|(v, factor)| form.add_term(*v, factor));
        form
    };
    let mut all = Vec::new();
    for t in 0..n {
        // (H16): on the edge R^α R^{α+1}, the step h↓ = (1, 1, 1, 1, 0, 0, 0, 0) towards R^1, zero elsewhere.
        for q in indices(DEGREE).filter(|q| q[2] == 0) {
            let value = (t == 0 && q[0] >= 4) || (t == n - 1 && q[1] >= 4);
            let mut condition = form(&[(unknown(t, q), one.clone())]);
            condition.constant = field.int(-i64::from(value));
            all.push(condition);
        }
        // (H17), (H18): first and second derivative along the inward normal, which is (−½, −½, 1) in barycentric coordinates.
        let inward = [field.ratio(-1, 2), field.ratio(-1, 2), one.clone()];
        for q in indices(DEGREE - 1).filter(|q| q[2] == 0) {
            let terms: Vec<_> = (0..3).map(|d| (unknown(t, raise(q, d)), inward[d].clone())).collect();
            all.push(form(&terms));
        }
        for q in indices(DEGREE - 2).filter(|q| q[2] == 0) {
            let terms: Vec<_> =
                pairs().map(|(d, e)| (unknown(t, raise(raise(q, d), e)), &inward[d] * &inward[e])).collect();
            all.push(form(&terms));
        }
    }
    // (H25): symmetric to the axis through R^1.
    for t in 0..n {
        for q in indices(DEGREE) {
            let mirrored = unknown(n - 1 - t, [q[1], q[0], q[2]]);
            all.push(form(&[(unknown(t, q), one.clone()), (mirrored, -&one)]));
        }
    }
    // (H23) with (H24): the rotated copies sum to one.
    for q in indices(DEGREE) {
        let terms: Vec<_> = (0..n).map(|t| (unknown(t, q), one.clone())).collect();
        let mut condition = form(&terms);
        condition.constant = field.int(-1);
        all.push(condition);
    }
    // C² across O R^{α+1}: the polar forms of both triangles agree at 0, 1 and 2 copies of R^{α+2}, which has the barycentric
    // coordinates (−1, c, 2 − c) in triangle α.
    let beta = [field.int(-1), field.c(), &field.int(2) - &field.c()];
    for t in 0..n {
        for q in indices(DEGREE).filter(|q| q[0] == 0) {
            let next = unknown(t + 1, [q[1], 0, q[2]]);
            all.push(form(&[(unknown(t, q), one.clone()), (next, -&one)]));
        }
        for q in indices(DEGREE - 1).filter(|q| q[0] == 0) {
            let next = unknown(t + 1, [q[1], 1, q[2]]);
            let terms = (0..3).map(|d| (unknown(t, raise(q, d)), beta[d].clone())).chain([(next, -&one)]);
            all.push(form(&terms.collect::<Vec<_>>()));
        }
        for q in indices(DEGREE - 2).filter(|q| q[0] == 0) {
            let next = unknown(t + 1, [q[1], 2, q[2]]);
            let terms = pairs()
                .map(|(d, e)| (unknown(t, raise(raise(q, d), e)), &beta[d] * &beta[e]))
                .chain([(next, -&one)]);
            all.push(form(&terms.collect::<Vec<_>>()));
        }
    }
    all
}

/// The member of `solutions` with the least energy.
fn minimise(field: &'static Field, solutions: &Solutions) -> Result<NBlend, String> {
    let n = field.n();
    let forms: Vec<Affine> = (0..n * COUNT).map(|v| solutions.value(v)).collect();
    let mut free: Vec<usize> = forms.iter().flat_map(|f| f.terms.keys().copied()).collect();
    free.sort_unstable();
    free.dedup();

    // Columns: the particular solution, then one direction per degree of freedom.
    let zero = field.int(0);
    let mut columns = vec![forms.iter().map(|f| f.constant.clone()).collect::<Vec<_>>()];
    for v in &free {
        columns.push(forms.iter().map(|f| f.terms.get(v).unwrap_or(&zero).clone()).collect());
    }
    let matrix = energy_matrix(field);
    let images: Vec<Vec<Elem>> = columns.iter().map(|column| apply(&matrix, column)).collect();
    let linear: Vec<Elem> = images.iter().map(|image| dot(image, &columns[0])).collect();
    let mut stationary = Solutions::all(field);
    for row in 1..columns.len() {
        let mut form = Affine::constant(linear[row].clone());
        for col in 1..columns.len() {
            form.add_term(col, &dot(&images[row], &columns[col]));
        }
        stationary.impose(form).map_err(|e| format!("degree of freedom {row}: {e}"))?;
    }

    let mut h = columns[0].clone();
    // Where the energy is stationary, the quadratic part is minus half the linear one.
    let mut energy = linear[0].clone();
    for (col, column) in columns.iter().enumerate().skip(1) {
        let amount = stationary.value(col);
        if !amount.terms.is_empty() {
            return Err(format!("the energy does not determine degree of freedom {col} of N = {n}"));
        }
        h.iter_mut().zip(column).for_each(|(h, d)| *h = &*h + &(&amount.constant * d));
        energy = &energy + &(&amount.constant * &linear[col]);
    }
    let energy = &energy * &energy_scale(field);
    let nets = h.chunks(COUNT).map(<[Elem]>::to_vec).collect();
    Ok(NBlend { field, nets, freedom: free.len(), energy })
}

/// The energy of one triangle as a quadratic form in its coefficients, divided by its area and by [`energy_scale`], which
/// leaves algebraic integers: the exact products with it stay short.
///
/// With `g_d` the gradients of the barycentric coordinates the Hessian is `Σ n(n−1) B_q b(q + e_d + e_e) g_d g_eᵀ`, and the
/// energy the integral of its squared Frobenius norm.
fn energy_matrix(field: &'static Field) -> Vec<Vec<Elem>> {
    let gradients = gradient_products(field);
    let hessians: Vec<_> = pairs()
        .flat_map(|(d, e)| pairs().map(move |(f, g)| [d, e, f, g]))
        .map(|[d, e, f, g]| ([d, e], [f, g], &gradients[d][f] * &gradients[e][g]))
        .collect();
    let mut matrix = vec![vec![field.int(0); COUNT]; COUNT];
    for q in indices(DEGREE - 2) {
        for p in indices(DEGREE - 2) {
            // ∫ B_q B_p is proportional to Π (q_d + p_d)! / (q_d! p_d!).
            let numer: i64 = (0..3).map(|d| factorial(q[d] + p[d])).product();
            let denom: i64 = (0..3).map(|d| factorial(q[d]) * factorial(p[d])).product();
            let product = field.int(numer / denom);
            for ([d, e], [f, g], hessian) in &hessians {
                let entry = &mut matrix[at(raise(raise(q, *d), *e))][at(raise(raise(p, *f), *g))];
                *entry = &*entry + &(&product * hessian);
            }
        }
    }
    matrix
}

/// What [`energy_matrix`] leaves out: `(n(n−1))² · 2 m!² / (2m + 2)!`, `m = n − 2`, from the integrals of the products of
/// Bernstein polynomials over a triangle of area 1, and the square of the factor of [`gradient_products`].
fn energy_scale(field: &'static Field) -> Elem {
    let (n, m) = (DEGREE, DEGREE - 2);
    let integrals =
        field.ratio(2 * factorial(m) * factorial(m) * ((n * (n - 1)) as i64).pow(2), factorial(2 * m + 2));
    // A gradient is the opposite edge, turned by a right angle, over twice the area; twice the area is the apothem.
    let gradients = &(&circumradius_squared(field) * &field.ratio(1, 2)) * &inverse(&apothem_squared(field));
    &integrals * &(&gradients * &gradients)
}

/// The products `g_d · g_e` of the gradients of the barycentric coordinates of a triangle `(R^α, R^{α+1}, O)`, times
/// `2 apothem² / circumradius²`.
fn gradient_products(field: &'static Field) -> [[Elem; 3]; 3] {
    // Edges OR^{α+1}, R^αO and R^{α+1}R^α as combinations of OR^α and OR^{α+1}, whose products are to (2, c, 2).
    let edges = [[0, 1], [-1, 0], [1, -1]];
    std::array::from_fn(|d| {
        std::array::from_fn(|e| {
            let (a, b) = (edges[d], edges[e]);
            let cross = &field.int(a[0] * b[1] + a[1] * b[0]) * &field.c();
            &field.int(2 * (a[0] * b[0] + a[1] * b[1])) + &cross
        })
    })
}

/// `1 / (4 sin²(π/N)) = 1 / (2 − c)`.
fn circumradius_squared(field: &'static Field) -> Elem {
    inverse(&(&field.int(2) - &field.c()))
}

/// The reciprocal of a number of which the geometry says that it is not zero.
fn inverse(x: &Elem) -> Elem {
    x.inverse().expect("lengths of a regular polygon are positive")
}

fn factorial(m: usize) -> i64 {
    (1..=m as i64).product()
}

fn apothem_squared(field: &'static Field) -> Elem {
    &circumradius_squared(field) - &field.ratio(1, 4)
}

/// The block diagonal matrix with `matrix` for every triangle, times `h`.
fn apply(matrix: &[Vec<Elem>], h: &[Elem]) -> Vec<Elem> {
    h.chunks(COUNT).flat_map(|net| matrix.iter().map(|row| dot(row, net))).collect()
}

fn dot(a: &[Elem], b: &[Elem]) -> Elem {
    let zero = a[0].field().int(0);
    a.iter().zip(b).filter(|(a, b)| !a.is_zero() && !b.is_zero()).fold(zero, |sum, (a, b)| &sum + &(a * b))
}

fn pairs() -> impl Iterator<Item = (usize, usize)> {
    (0..3).flat_map(|d| (0..3).map(move |e| (d, e)))
}
