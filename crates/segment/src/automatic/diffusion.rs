//! One implicit step of diffusion between neighbouring faces.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::cholesky::{LltRef, SymbolicCholesky, factorize_symbolic_cholesky};
use faer::sparse::{SparseColMat, Triplet};
use faer::{Conj, MatMut, Par, Side};
use suture_mesh::Topology;

use crate::SegmentError;

/// The factorised system (M + tL) u = M u₀ on the dual graph.
pub(super) struct Diffusion<'a> {
    masses: &'a [f64],
    symbolic: SymbolicCholesky<usize>,
    values: Vec<f64>,
}

impl<'a> Diffusion<'a> {
    /// Factorises for the time `t`; `masses` per face, `conductances` per half-edge.
    pub(super) fn new(
        topology: &Topology,
        masses: &'a [f64],
        conductances: &[f64],
        t: f64,
    ) -> Result<Self, SegmentError> {
        let faces = masses.len();
        let failed = |reason: String| SegmentError::Solve { faces, reason };
        let mut entries = Vec::with_capacity(faces * 4);
        for f in 0..faces {
            let mut diagonal = masses[f];
            for h in 3 * f..3 * f + 3 {
                let c = t * conductances[h];
                diagonal += c;
                if let Some(o) = topology.opposite(h as u32) {
                    let g = o as usize / 3;
                    if g < f {
                        entries.push(Triplet::new(f, g, -c));
                    }
                }
            }
            entries.push(Triplet::new(f, f, diagonal));
        }
        let matrix = SparseColMat::<usize, f64>::try_new_from_triplets(faces, faces, &entries)
            .map_err(|e| failed(format!("{e:?}")))?;
        let symbolic = factorize_symbolic_cholesky(
            matrix.symbolic(),
            Side::Lower,
            Default::default(),
            Default::default(),
        )
        .map_err(|e| failed(format!("{e:?}")))?;
        let mut values = vec![0.0; symbolic.len_val()];
        let scratch = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        let mut memory = MemBuffer::try_new(scratch).map_err(|e| failed(format!("{e:?}")))?;
        // One thread: other counts give other bits.
        symbolic
            .factorize_numeric_llt::<f64>(
                &mut values,
                matrix.as_ref(),
                Side::Lower,
                Default::default(),
                Par::Seq,
                MemStack::new(&mut memory),
                Default::default(),
            )
            .map_err(|e| failed(format!("{e:?}")))?;
        Ok(Self { masses, symbolic, values })
    }

    /// Diffuses one value per face.
    pub(super) fn smooth(&self, values: impl Iterator<Item = f64>) -> Vec<f64> {
        let mut u: Vec<f64> = values.zip(self.masses).map(|(u, m)| u * m).collect();
        let n = u.len();
        let mut memory = MemBuffer::new(self.symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
        LltRef::<'_, usize, f64>::new(&self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(&mut u, n, 1),
            Par::Seq,
            MemStack::new(&mut memory),
        );
        u
    }
}
