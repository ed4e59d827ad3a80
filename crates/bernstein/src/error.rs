//! Why a control net is refused.

use crate::MAX_DEGREE;

/// Why a control net is refused.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum NetError {
    /// The degree exceeds [`MAX_DEGREE`].
    Degree {
        /// The degree asked for.
        degree: usize,
    },
    /// The net does not have the number of control points that its degrees and knots ask for.
    Count {
        /// How many control points (or knots) were given.
        given: usize,
        /// How many are needed.
        needed: usize,
    },
    /// A knot vector decreases, is not finite (or its length is not), or is too short for one polynomial piece.
    Knots {
        /// Index of the offending knot.
        index: usize,
    },
    /// A control point has a coordinate that is not finite: one that was given, or one that overflows in the result.
    NotFinite {
        /// Index of the control point in the net.
        index: usize,
    },
    /// A knot to insert lies outside the domain, or is there as often as any degree can use.
    Insertion {
        /// The knot asked for.
        knot: f64,
        /// The domain of the spline.
        domain: [f64; 2],
        /// How often the knot is there already.
        multiplicity: usize,
    },
}

impl std::fmt::Display for NetError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Degree { degree } => {
                write!(f, "degree {degree} exceeds {MAX_DEGREE}; split the net into pieces of lower degree")
            }
            Self::Count { given, needed } => {
                write!(
                    f,
                    "the net has {given} control points or knots, its degrees and knots ask for {needed}"
                )
            }
            Self::Knots { index } => {
                write!(
                    f,
                    "knot {index} is not finite, smaller than the knot before it, or spans no interval (or an infinite one)"
                )
            }
            Self::NotFinite { index } => {
                write!(f, "control point {index} is not finite; check the input for NaN, or scale it down")
            }
            Self::Insertion { knot, domain: [a, b], multiplicity } => write!(
                f,
                "knot {knot} cannot be inserted: it is there {multiplicity} times, the domain is [{a}, {b}]; insert knots \
                 of the domain, at most to multiplicity degree + 1"
            ),
        }
    }
}

impl std::error::Error for NetError {}
