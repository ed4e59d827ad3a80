//! Numbering of the monomials in three variables, graded.

/// Largest degree of a vertex implicit: twice the largest order.
pub(crate) const MAX_DEGREE: usize = 8;

/// Number of monomials of degree at most `d`.
pub(crate) const fn count(d: usize) -> usize {
    (d + 1) * (d + 2) * (d + 3) / 6
}

/// Number of monomials of degree below `d`.
pub(crate) const fn first(d: usize) -> usize {
    if d == 0 { 0 } else { count(d - 1) }
}

/// Number of monomials up to [`MAX_DEGREE`].
pub(crate) const TOTAL: usize = count(MAX_DEGREE);

/// Number of `x^i y^j z^k`: by degree, then by falling `i`, then by falling `j`.
pub(crate) const fn index(i: usize, j: usize, k: usize) -> usize {
    let rest = j + k;
    first(i + rest) + rest * (rest + 1) / 2 + k
}

/// One monomial and how it is made from a lower one.
#[derive(Clone, Copy)]
pub(crate) struct Monomial {
    /// Exponents.
    pub(crate) exponents: [u8; 3],
    /// Number of the monomial of one degree less, itself for 1.
    pub(crate) parent: u16,
    /// The variable by which this one is the parent's product.
    pub(crate) variable: u8,
}

/// All monomials by number.
pub(crate) static TABLE: [Monomial; TOTAL] = {
    let mut table = [Monomial { exponents: [0; 3], parent: 0, variable: 0 }; TOTAL];
    let mut d = 1;
    while d <= MAX_DEGREE {
        let mut rest = 0;
        while rest <= d {
            let mut k = 0;
            while k <= rest {
                let (i, j) = (d - rest, rest - k);
                let (parent, variable) = if i > 0 {
                    (index(i - 1, j, k), 0)
                } else if j > 0 {
                    (index(i, j - 1, k), 1)
                } else {
                    (index(i, j, k - 1), 2)
                };
                table[index(i, j, k)] =
                    Monomial { exponents: [i as u8, j as u8, k as u8], parent: parent as u16, variable };
                k += 1;
            }
            rest += 1;
        }
        d += 1;
    }
    table
};

/// Number of the product of two monomials.
pub(crate) fn product(a: usize, b: usize) -> usize {
    let (a, b) = (TABLE[a].exponents, TABLE[b].exponents);
    let [i, j, k] = [0, 1, 2].map(|s| (a[s] + b[s]) as usize);
    index(i, j, k)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_exponents_agree() {
        assert_eq!((index(0, 0, 0), index(1, 0, 0), index(0, 0, 1), index(2, 0, 0)), (0, 1, 3, 4));
        for (number, m) in TABLE.iter().enumerate() {
            let [i, j, k] = m.exponents.map(usize::from);
            assert_eq!(index(i, j, k), number);
            if number > 0 {
                assert_eq!(product(m.parent as usize, 1 + m.variable as usize), number);
            }
        }
    }
}
