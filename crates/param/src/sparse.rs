//! Sparse Cholesky factorisation with a reusable pattern, one thread.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::prelude::Reborrow;
use faer::sparse::linalg::cholesky::{
    LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{Argsort, CreationError, FaerError, Pair, SparseColMat, SymbolicSparseColMat};
use faer::{Conj, MatMut, Par, Side};

use crate::ParamError;

/// Pattern of a symmetric matrix and its symbolic factorisation; only entries on and below the diagonal are given.
pub(crate) struct Pattern {
    method: &'static str,
    unknowns: usize,
    matrix: SymbolicSparseColMat<usize>,
    order: Argsort<usize>,
    symbolic: SymbolicCholesky<usize>,
}

/// A numeric factorisation.
pub(crate) struct Factor<'a> {
    pattern: &'a Pattern,
    values: Vec<f64>,
}

impl Pattern {
    /// `entries` are (row, column) with row ≥ column; an entry that occurs twice is summed. `unknowns` must be positive.
    pub(crate) fn new(
        method: &'static str,
        unknowns: usize,
        entries: &[(usize, usize)],
    ) -> Result<Self, ParamError> {
        let memory = |_: FaerError| ParamError::OutOfMemory { unknowns };
        let pairs: Vec<_> = entries.iter().map(|&(row, col)| Pair { row, col }).collect();
        let (matrix, order) = SymbolicSparseColMat::try_new_from_indices(unknowns, unknowns, &pairs)
            .map_err(|error| match error {
                CreationError::Generic(e) => memory(e),
                CreationError::OutOfBounds { .. } => ParamError::Singular { method, unknowns },
            })?;
        let symbolic =
            factorize_symbolic_cholesky(matrix.rb(), Side::Lower, SymmetricOrdering::Amd, Default::default())
                .map_err(memory)?;
        Ok(Self { method, unknowns, matrix, order, symbolic })
    }

    /// Factorises the matrix with these values, in the order of the entries.
    pub(crate) fn factor(&self, values: &[f64]) -> Result<Factor<'_>, ParamError> {
        let unknowns = self.unknowns;
        let singular = || ParamError::Singular { method: self.method, unknowns };
        let memory = || ParamError::OutOfMemory { unknowns };
        if values.iter().any(|v| !v.is_finite()) {
            return Err(singular());
        }
        let matrix =
            SparseColMat::new_from_argsort(self.matrix.clone(), &self.order, values).map_err(|_| memory())?;
        let mut factor = Vec::new();
        factor.try_reserve_exact(self.symbolic.len_val()).map_err(|_| memory())?;
        factor.resize(self.symbolic.len_val(), 0.0);
        // One thread, said explicitly: faer's threads give other bits and are slower on charts of this size.
        let scratch = self.symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        let mut buffer = MemBuffer::try_new(scratch).map_err(|_| memory())?;
        self.symbolic
            .factorize_numeric_llt::<f64>(
                &mut factor,
                matrix.rb(),
                Side::Lower,
                Default::default(),
                Par::Seq,
                MemStack::new(&mut buffer),
                Default::default(),
            )
            .map_err(|_| singular())?;
        Ok(Factor { pattern: self, values: factor })
    }
}

impl Factor<'_> {
    /// Solves for the right-hand sides stored one after another in `x`.
    pub(crate) fn solve(&self, x: &mut [f64]) -> Result<(), ParamError> {
        let unknowns = self.pattern.unknowns;
        let columns = x.len() / unknowns;
        let symbolic = &self.pattern.symbolic;
        let scratch = symbolic.solve_in_place_scratch::<f64>(columns, Par::Seq);
        let mut buffer = MemBuffer::try_new(scratch).map_err(|_| ParamError::OutOfMemory { unknowns })?;
        LltRef::<'_, usize, f64>::new(symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(&mut x[..columns * unknowns], unknowns, columns),
            Par::Seq,
            MemStack::new(&mut buffer),
        );
        if x.iter().all(|v| v.is_finite()) {
            Ok(())
        } else {
            Err(ParamError::Singular { method: self.pattern.method, unknowns })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_second_difference_is_inverted() {
        let n = 50;
        let mut entries = Vec::new();
        let mut values = Vec::new();
        for i in 0..n {
            // The diagonal in two parts: repeated entries are summed.
            entries.extend([(i, i), (i, i)]);
            values.extend([1.5, 0.5]);
            if i > 0 {
                entries.push((i, i - 1));
                values.push(-1.0);
            }
        }
        let pattern = Pattern::new("test", n, &entries).unwrap();
        let factor = pattern.factor(&values).unwrap();
        let mut x = vec![0.0; 2 * n];
        x[0] = 1.0;
        x[n + n - 1] = 1.0;
        factor.solve(&mut x).unwrap();
        for i in 0..n {
            let t = (i + 1) as f64 / (n + 1) as f64;
            assert!((x[i] - (1.0 - t)).abs() < 1e-12 && (x[n + i] - t).abs() < 1e-12);
        }
    }

    #[test]
    fn an_indefinite_matrix_is_refused() {
        let pattern = Pattern::new("test", 2, &[(0, 0), (1, 0), (1, 1)]).unwrap();
        let error = pattern.factor(&[1.0, 2.0, 1.0]).err();
        assert_eq!(error, Some(ParamError::Singular { method: "test", unknowns: 2 }));
        assert!(pattern.factor(&[1.0, f64::NAN, 1.0]).is_err());
    }
}
