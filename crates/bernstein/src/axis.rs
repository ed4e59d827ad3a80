//! The two parameter directions of a tensor-product net, and the lines of control points along them.

use crate::Vector;

/// A parameter direction of a tensor-product net.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Axis {
    /// The first index of the net.
    U,
    /// The second, fastest index of the net.
    V,
}

impl Axis {
    /// Both directions.
    pub const BOTH: [Self; 2] = [Self::U, Self::V];

    /// Position in pairs that belong to the two directions: 0 or 1.
    pub fn index(self) -> usize {
        match self {
            Self::U => 0,
            Self::V => 1,
        }
    }
}

/// Replaces every line of control points along `axis` by `f` of it; all results have the length of the first.
pub(crate) fn map_lines<T: Vector>(
    net: &[T],
    count: [usize; 2],
    axis: Axis,
    mut f: impl FnMut(&[T]) -> Vec<T>,
) -> Vec<T> {
    match axis {
        Axis::V => net.chunks_exact(count[1]).flat_map(f).collect(),
        Axis::U => {
            let mut line = Vec::with_capacity(count[0]);
            let columns: Vec<Vec<T>> = (0..count[1])
                .map(|j| {
                    line.clear();
                    line.extend(net[j..].iter().step_by(count[1]));
                    f(&line)
                })
                .collect();
            (0..columns[0].len()).flat_map(|i| columns.iter().map(move |c| c[i])).collect()
        }
    }
}
