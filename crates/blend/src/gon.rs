//! The regular N-gon: parameter domain of an N-blend.

use std::f64::consts::{PI, TAU};

use glam::DVec2;

/// Largest number of segments at a corner: tables exist for N = 3..8.
pub const MAX_VALENCE: usize = 8;

/// Corners `R_0 … R_{N−1}` of the regular N-gon with edge length 1 and centre at the origin, counter-clockwise, `R_0` on the
/// positive V axis (Wagner et al. 2003, Section 5.2).
pub fn corners(n: usize) -> Vec<DVec2> {
    (0..n).map(|i| rotation(n, i).rotate(DVec2::new(0.0, circumradius(n)))).collect()
}

/// `1 / (2 sin(π/N))`.
pub fn circumradius(n: usize) -> f64 {
    0.5 / (PI / n as f64).sin()
}

/// `1 / (2 tan(π/N))`: distance of the edges from the centre.
pub fn apothem(n: usize) -> f64 {
    0.5 / (PI / n as f64).tan()
}

/// The rotation by `2π i/N`, as the complex number that [`DVec2::rotate`] multiplies by.
pub fn rotation(n: usize, i: usize) -> DVec2 {
    DVec2::from_angle(TAU * i as f64 / n as f64)
}

/// The triangle `(R_α, R_{α+1}, O)` that contains `at`, by its `α`; points on a common side belong to either.
pub fn triangle(n: usize, at: DVec2) -> usize {
    // Angle from R_0, counter-clockwise, in turns.
    let turn = (at.to_angle() - 0.25 * TAU).rem_euclid(TAU) / TAU;
    ((turn * n as f64) as usize).min(n - 1)
}
