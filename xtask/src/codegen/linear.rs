//! Exact elimination of sparse linear conditions over a [`Field`].

use std::collections::BTreeMap;

use super::field::{Elem, Field};

/// `constant + Σ terms[v] · v` in unknowns `v`; no stored coefficient is zero.
#[derive(Clone, Debug)]
pub(crate) struct Affine {
    pub(crate) constant: Elem,
    pub(crate) terms: BTreeMap<usize, Elem>,
}

impl Affine {
    pub(crate) fn constant(constant: Elem) -> Self {
        Self { constant, terms: BTreeMap::new() }
    }

    /// Adds `factor · v`.
    pub(crate) fn add_term(&mut self, v: usize, factor: &Elem) {
        let sum = match self.terms.get(&v) {
            Some(old) => old + factor,
            None => factor.clone(),
        };
        if sum.is_zero() {
            self.terms.remove(&v);
        } else {
            self.terms.insert(v, sum);
        }
    }

    /// Replaces `v` by `value`.
    fn substitute(&mut self, v: usize, value: &Self) {
        if let Some(factor) = self.terms.remove(&v) {
            self.constant = &self.constant + &(&factor * &value.constant);
            for (&w, coefficient) in &value.terms {
                self.add_term(w, &(&factor * coefficient));
            }
        }
    }
}

/// The solutions of the conditions imposed so far: every unknown is free or an affine form of the free ones.
#[derive(Debug)]
pub(crate) struct Solutions {
    field: &'static Field,
    bound: BTreeMap<usize, Affine>,
}

impl Solutions {
    pub(crate) fn all(field: &'static Field) -> Self {
        Self { field, bound: BTreeMap::new() }
    }

    /// Imposes `form = 0`.
    ///
    /// # Errors
    /// When no unknown is left to satisfy it with; the solutions are then unchanged.
    pub(crate) fn impose(&mut self, mut form: Affine) -> Result<(), String> {
        let known: Vec<usize> = form.terms.keys().copied().filter(|v| self.bound.contains_key(v)).collect();
        for v in known {
            form.substitute(v, &self.bound[&v]);
        }
        let Some((v, factor)) = form.terms.pop_last() else {
            let residual = form.constant;
            return if residual.is_zero() {
                Ok(())
            } else {
                Err(format!("the conditions contradict each other by {}", residual.to_f64()))
            };
        };
        let Some(scale) = factor.inverse().map(|i| -&i) else {
            return Err(format!("unknown {v} has the coefficient zero"));
        };
        form.constant = &form.constant * &scale;
        form.terms.values_mut().for_each(|c| *c = &*c * &scale);
        self.bound.values_mut().for_each(|row| row.substitute(v, &form));
        self.bound.insert(v, form);
        Ok(())
    }

    /// The unknown `v` in terms of the free ones.
    pub(crate) fn value(&self, v: usize) -> Affine {
        self.bound.get(&v).cloned().unwrap_or_else(|| {
            let mut free = Affine::constant(self.field.int(0));
            free.add_term(v, &self.field.int(1));
            free
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plane_and_a_line_meet_and_a_parallel_plane_is_refused() {
        let field = Field::of(5).unwrap();
        let form = |terms: &[(usize, Elem)], constant: i64| {
            let mut form = Affine::constant(field.int(constant));
            terms.iter().for_each(|(v, c)| form.add_term(*v, c));
            form
        };
        let (one, c) = (field.int(1), field.c());
        let mut solutions = Solutions::all(field);
        solutions.impose(form(&[(0, one.clone()), (1, c.clone()), (2, one.clone())], -1)).unwrap();
        solutions.impose(form(&[(1, one.clone()), (2, -&one)], 0)).unwrap();
        solutions.impose(form(&[(0, c.clone())], 0)).unwrap();
        // x_1 (1 + c) = 1, and 1 + c = 1/c in this field (golden ratio).
        for v in [1, 2] {
            assert_eq!(solutions.value(v).constant, c);
            assert!(solutions.value(v).terms.is_empty());
        }
        assert!(solutions.impose(form(&[(1, one.clone()), (2, one.clone())], 0)).is_err());
    }
}
