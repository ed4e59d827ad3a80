//! The conditions on a computed N-blend, verified exactly and in another form than the one it was computed from: derivatives
//! are taken as polynomials and compared on the edges.

use super::field::{Elem, Field};
use super::n_blend::NBlend;
use super::net::{DEGREE, at, derivative, edge, indices};

/// Verifies every condition on `h`, without rounding.
///
/// # Errors
/// The first condition that fails, with the triangle.
pub(crate) fn prove(h: &NBlend) -> Result<(), String> {
    let (field, n) = (h.field, h.field.n());
    let fail =
        |condition: &str, triangle: usize| Err(format!("N = {n}, triangle {}: {condition}", triangle + 1));
    let step = [1, 1, 1, 1, 0, 0, 0, 0];
    for t in 0..n {
        let inward = [field.ratio(-1, 2), field.ratio(-1, 2), field.int(1)];
        let [value, first, second] = jets_on_edge(field, &h.nets[t], &inward, 2);
        let matches = (0..=DEGREE).all(|j| {
            let mut want = 0;
            if t == 0 {
                want += step[j];
            }
            if t == n - 1 {
                want += step[DEGREE - j];
            }
            value[j] == field.int(want)
        });
        if !matches {
            return fail("(H16) boundary values", t);
        }
        if !first.iter().all(Elem::is_zero) {
            return fail("(H17) first normal derivative", t);
        }
        if !second.iter().all(Elem::is_zero) {
            return fail("(H18) second normal derivative", t);
        }

        // The vector O R^{α+2}, seen from both sides of the edge O R^{α+1}; it is transversal to the edge, so that equal
        // derivatives along it, as polynomials on the edge, are C².
        let here = [field.int(-1), field.c(), &field.int(1) - &field.c()];
        let there = [field.int(0), field.int(1), field.int(-1)];
        let this = jets_on_edge(field, &h.nets[t], &here, 0);
        let next = jets_on_edge(field, &h.nets[(t + 1) % n], &there, 1);
        for order in 0..3 {
            // Both edges are stored by rising k.
            if this[order] != next[order] {
                return fail(&format!("derivative {order} across the inner edge"), t);
            }
        }
        if indices(DEGREE).any(|q| h.nets[t][at(q)] != h.nets[n - 1 - t][at([q[1], q[0], q[2]])]) {
            return fail("(H25) reflection", t);
        }
    }
    // Copy i takes on triangle β the values of triangle β − i + 1 of the first copy (H24): each sum runs over all triangles.
    for q in indices(DEGREE) {
        let sum = h.nets.iter().fold(field.int(0), |sum, net| &sum + &net[at(q)]);
        if sum != field.int(1) {
            return fail("(H23) partition of unity", 0);
        }
    }
    Ok(())
}

/// Value, first and second derivative along a vector, on the edge opposite of a corner.
fn jets_on_edge(field: &'static Field, net: &[Elem], along: &[Elem; 3], opposite: usize) -> [Vec<Elem>; 3] {
    let first = derivative(field, DEGREE, net, along);
    let second = derivative(field, DEGREE - 1, &first, along);
    [edge(DEGREE, net, opposite), edge(DEGREE - 1, &first, opposite), edge(DEGREE - 2, &second, opposite)]
}
