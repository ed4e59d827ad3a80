//! What a control point may be.

use std::ops::{Add, Mul, Sub};

use glam::{DVec2, DVec3};

/// A control point: anything that can be added and scaled. Implemented for `f64`, `DVec2` and `DVec3`.
pub trait Vector:
    Copy
    + Default
    + PartialEq
    + Send
    + Sync
    + std::fmt::Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<f64, Output = Self>
{
    /// Whether every coordinate is finite.
    fn finite(self) -> bool;
}

impl Vector for f64 {
    fn finite(self) -> bool {
        self.is_finite()
    }
}

impl Vector for DVec2 {
    fn finite(self) -> bool {
        self.is_finite()
    }
}

impl Vector for DVec3 {
    fn finite(self) -> bool {
        self.is_finite()
    }
}
