//! Why a chart cannot be fitted.

use glam::DVec2;
use suture_bernstein::NetError;

/// Why a chart cannot be fitted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// Two arrays of the input do not belong together.
    #[error("{what} has {given} entries, {needed} are needed")]
    Length {
        /// Which array.
        what: &'static str,
        /// Its length.
        given: usize,
        /// The length it should have.
        needed: usize,
    },
    /// A number of the input is not finite.
    #[error("{what} {index} is not finite")]
    NotFinite {
        /// Which array.
        what: &'static str,
        /// Index of the offending entry.
        index: usize,
    },
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} names vertex {vertex}, but the chart has {vertices} vertices")]
    TriangleIndex {
        /// Index of the triangle.
        triangle: usize,
        /// The vertex it names.
        vertex: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// Too few vertices carry weight to determine even a plane.
    #[error(
        "the chart has {vertices} vertices with positive area around them, at least {needed} are needed; merge the segment with a neighbour"
    )]
    TooFew {
        /// Number of vertices with positive weight.
        vertices: usize,
        /// Smallest admissible number.
        needed: usize,
    },
    /// The parameters lie on a line.
    #[error(
        "the parameters lie on a line: width / length = {ratio:e} is below {limit:e}; compute the chart again or split the segment"
    )]
    Collinear {
        /// Shorter side over longer side of their minimum-area rectangle.
        ratio: f64,
        /// Smallest admissible ratio.
        limit: f64,
    },
    /// All triangles are degenerate in space or in the parameter plane.
    #[error("the chart has no area {place}; compute it again")]
    ZeroArea {
        /// `"in space"` or `"in the parameter plane"`.
        place: &'static str,
    },
    /// No triangle of the chart belongs to the segment.
    #[error("no triangle of the chart is marked as belonging to the segment")]
    EmptySegment,
    /// An option or scalar input has a value outside its range.
    #[error("{name} = {value}, but it must be {expected}")]
    Value {
        /// Name of the option.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The admissible range.
        expected: &'static str,
    },
    /// A parameter lies in a cell that carries no unknowns.
    #[error("parameter {index} at {at} lies outside the active cells; enlarge the reach or the grid")]
    Inactive {
        /// Index of the parameter.
        index: usize,
        /// The parameter.
        at: DVec2,
    },
    /// The normal matrix is not positive definite in floating point.
    #[error("the normal matrix lost definiteness at cell ({}, {}) with eta = {eta:e}; raise lambda or lower the order of the energy", .cell[0], .cell[1])]
    Breakdown {
        /// Cell of the offending coefficient.
        cell: [usize; 2],
        /// Stiffness relative to the knots.
        eta: f64,
    },
    /// The factorisation could not be set up.
    #[error("{coefficients} coefficients do not fit into memory; use fewer knots")]
    Memory {
        /// Number of unknowns.
        coefficients: usize,
    },
    /// The control net is refused: the result overflows.
    #[error("the fitted net is not a B-spline surface: {0}; scale the input to a sensible size")]
    Net(#[from] NetError),
}
