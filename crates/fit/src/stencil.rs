//! Numbering of the unknowns and storage of a symmetric matrix over them.

use crate::Cells;

/// No unknown.
pub(crate) const NONE: u32 = u32::MAX;
/// Entries of one column of the lower triangle: coefficients at offsets (0, 0..=3) and (1..=3, −3..=3).
pub(crate) const WIDTH: usize = 25;

/// The coefficients that belong to an active cell, numbered in net order (second index fastest), and their neighbours.
#[derive(Debug)]
pub(crate) struct Pattern {
    count: [usize; 2],
    /// Unknown of every coefficient of the net.
    id: Vec<u32>,
    /// Coefficient of every unknown.
    net: Vec<usize>,
    /// Unknowns at the offsets of the stencil, ascending.
    neighbours: Vec<[u32; WIDTH]>,
}

impl Pattern {
    pub(crate) fn new(cells: &Cells) -> Self {
        let count = cells.grid().count();
        let [p, q] = count;
        let mut used = vec![false; p * q];
        for [i, j] in cells.iter() {
            for a in 0..4 {
                used[(i + a) * q + j..][..4].fill(true);
            }
        }
        let net: Vec<usize> = (0..p * q).filter(|&k| used[k]).collect();
        let mut id = vec![NONE; p * q];
        for (n, &k) in net.iter().enumerate() {
            id[k] = n as u32;
        }
        let neighbours = net
            .iter()
            .map(|&k| {
                let (i, j) = (k / q, k % q);
                let mut row = [NONE; WIDTH];
                for di in 0..4 {
                    for dj in -3_i32..4 {
                        if di == 0 && dj < 0 || i + di >= p {
                            continue;
                        }
                        let b = j as i64 + i64::from(dj);
                        if (0..q as i64).contains(&b) {
                            row[offset(di, dj)] = id[(i + di) * q + b as usize];
                        }
                    }
                }
                row
            })
            .collect();
        Self { count, id, net, neighbours }
    }

    /// Number of unknowns.
    pub(crate) fn len(&self) -> usize {
        self.net.len()
    }

    pub(crate) fn count(&self) -> [usize; 2] {
        self.count
    }

    pub(crate) fn neighbours(&self) -> &[[u32; WIDTH]] {
        &self.neighbours
    }

    /// Coefficient of the net behind every unknown.
    pub(crate) fn net(&self) -> &[usize] {
        &self.net
    }

    /// Unknown of coefficient `(i, j)`, or [`NONE`].
    pub(crate) fn unknown(&self, i: usize, j: usize) -> u32 {
        self.id[i * self.count[1] + j]
    }

    /// First of the four consecutive unknowns of each of the four rows of an active cell.
    pub(crate) fn rows(&self, [i, j]: [usize; 2]) -> [usize; 4] {
        [0, 1, 2, 3].map(|a| self.unknown(i + a, j) as usize)
    }
}

/// Position in the stencil of the coefficient `di` rows later and `dj` columns further.
fn offset(di: usize, dj: i32) -> usize {
    if di == 0 { dj as usize } else { (4 + (di - 1) * 7).wrapping_add_signed(dj as isize + 3) }
}

/// A symmetric matrix over the unknowns of a [`Pattern`]: the lower triangle, column by column.
#[derive(Clone, Debug)]
pub(crate) struct Stencil(pub(crate) Vec<[f64; WIDTH]>);

impl Stencil {
    pub(crate) fn zero(len: usize) -> Self {
        Self(vec![[0.0; WIDTH]; len])
    }

    /// Adds `block` (its upper triangle is read) on the sixteen coefficients of one cell.
    pub(crate) fn add(&mut self, rows: [usize; 4], block: &[[f64; 16]; 16]) {
        for r in 0..16 {
            let column = &mut self.0[rows[r / 4] + r % 4];
            for c in r..16 {
                column[offset(c / 4 - r / 4, (c % 4) as i32 - (r % 4) as i32)] += block[r][c];
            }
        }
    }

    /// Frobenius norm.
    pub(crate) fn frobenius(&self) -> f64 {
        let column = |c: &[f64; WIDTH]| c[0] * c[0] + 2.0 * c[1..].iter().map(|x| x * x).sum::<f64>();
        self.0.iter().map(column).sum::<f64>().sqrt()
    }

    /// `y −= factor · self · x` for three columns at once.
    pub(crate) fn subtract_product(
        &self,
        pattern: &Pattern,
        factor: f64,
        x: &[[f64; 3]],
        y: &mut [[f64; 3]],
    ) {
        for (i, (column, neighbours)) in self.0.iter().zip(pattern.neighbours()).enumerate() {
            for k in 0..WIDTH {
                let j = neighbours[k] as usize;
                if neighbours[k] == NONE {
                    continue;
                }
                let a = factor * column[k];
                for d in 0..3 {
                    y[j][d] -= a * x[i][d];
                    if k > 0 {
                        y[i][d] -= a * x[j][d];
                    }
                }
            }
        }
    }
}
