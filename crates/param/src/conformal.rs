//! The discrete conformal energy: Dirichlet energy minus area.

use crate::sheet::Sheet;

/// Entries (row ≥ column) and values of the Hessian of `½ (uᵀ L u + vᵀ L v) − area`, unknowns `u_0 … u_{n−1}, v_0 … v_{n−1}`.
///
/// The area of the image is a sum over boundary edges i → j of ½ (u_i v_j − u_j v_i), so that only boundary vertices couple
/// u with v.
pub(crate) fn hessian(sheet: &Sheet<'_>) -> (Vec<(usize, usize)>, Vec<f64>) {
    let n = sheet.x.len();
    let capacity = 12 * sheet.faces.len() + 2 * sheet.boundary.len();
    let (mut entries, mut values) = (Vec::with_capacity(capacity), Vec::with_capacity(capacity));
    for (face, flat) in sheet.faces.iter().zip(&sheet.flats) {
        for i in 0..3 {
            for j in 0..3 {
                let (a, b) = (face[i] as usize, face[j] as usize);
                if a >= b {
                    let s = flat.stiffness(i, j);
                    entries.extend([(a, b), (n + a, n + b)]);
                    values.extend([s, s]);
                }
            }
        }
    }
    let b = &sheet.boundary;
    for (i, &v) in b.iter().enumerate() {
        let (v, w) = (v as usize, b[(i + 1) % b.len()] as usize);
        entries.extend([(n + w, v), (n + v, w)]);
        values.extend([-0.5, 0.5]);
    }
    (entries, values)
}
