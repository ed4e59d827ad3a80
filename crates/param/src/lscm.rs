//! Least squares conformal maps with two pinned vertices.

use glam::{DVec2, DVec3};

use crate::conformal::hessian;
use crate::frame::farthest;
use crate::sheet::Sheet;
use crate::sparse::Pattern;
use crate::{ParamError, Parameterize};

/// Least squares conformal map: the minimiser of the conformal energy with two pinned vertices.
///
/// The choice of the source paper, and the one to compare with other programs: the minimiser is unique given the pins. Area
/// ratios of 10² … 10³ and flips are normal on charts that are far from developable; use
/// [`Recommended`](crate::Recommended) to fit on.
///
/// # References
/// B. Lévy, S. Petitjean, N. Ray, J. Maillot, *Least squares conformal maps for automatic texture atlas generation* (2002);
/// the energy in the form "Dirichlet minus area" of P. Mullen et al., *Spectral conformal parameterization* (2008), eq. (4).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lscm {
    /// The two pinned vertices. Default: the two boundary vertices farthest apart in space.
    pub pins: Option<[usize; 2]>,
    /// Where they go. Default: (0, 0) and (d, 0) with d their distance in space.
    pub pin_uv: Option<[DVec2; 2]>,
}

impl Parameterize for Lscm {
    fn parameterize(&self, positions: &[DVec3], faces: &[[u32; 3]]) -> Result<Vec<DVec2>, ParamError> {
        let sheet = Sheet::new(positions, faces)?;
        let n = sheet.x.len();
        let pins = self.pins.unwrap_or_else(|| farthest(&sheet));
        let refused = ParamError::Pins { pins, vertices: n };
        if pins[0] == pins[1] || pins.iter().any(|&p| p >= n) {
            return Err(refused);
        }
        let d = sheet.x[pins[0]].distance(sheet.x[pins[1]]) * sheet.scale;
        let [from, to] = self.pin_uv.unwrap_or([DVec2::ZERO, DVec2::new(d, 0.0)]);
        let axis = to - from;
        if !(axis.length() > 0.0 && axis.is_finite() && from.is_finite()) {
            return Err(refused);
        }
        // Pinned to 0 and 1: the energy is invariant under similarities, which are applied afterwards.
        let unknown = {
            let mut count = 0;
            let mut next = |v: usize| {
                let free = !pins.contains(&v);
                count += usize::from(free);
                free.then(|| count - 1)
            };
            (0..n).map(&mut next).collect::<Vec<_>>()
        };
        let m = n - 2;
        let (all, all_values) = hessian(&sheet);
        let value = |i: usize| if i == pins[1] { 1.0 } else { 0.0 };
        let at = |i: usize| unknown[i % n].map(|k| if i < n { k } else { m + k });
        let (mut entries, mut values, mut rhs) = (Vec::new(), Vec::new(), vec![0.0; 2 * m]);
        for (&(a, b), &s) in all.iter().zip(&all_values) {
            match (at(a), at(b)) {
                (Some(i), Some(j)) => {
                    entries.push((i.max(j), i.min(j)));
                    values.push(s);
                }
                (Some(i), None) => rhs[i] -= s * value(b),
                (None, Some(j)) => rhs[j] -= s * value(a),
                (None, None) => {}
            }
        }
        // A disc has at least three vertices, hence one unknown pair.
        Pattern::new("Lscm", 2 * m, &entries)?.factor(&values)?.solve(&mut rhs)?;
        let place = |z: DVec2| from + axis.rotate(z);
        Ok((0..n)
            .map(|v| match unknown[v] {
                Some(k) => place(DVec2::new(rhs[k], rhs[m + k])),
                None if v == pins[0] => from,
                None => to,
            })
            .collect())
    }
}
