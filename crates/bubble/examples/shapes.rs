//! Writes the shapes of the gallery: bar, tube and twisted horseshoe, as coarse meshes with square sections.
//!
//! `cargo run -p suture-bubble --example shapes -- docs/gallery`

use std::{
    error::Error,
    f64::consts::{PI, TAU},
    fmt::Write,
    path::Path,
};

use glam::{DQuat, DVec3};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("name a folder")?;
    for (name, text) in [("bar", bar()), ("tube", tube()), ("horseshoe", horseshoe())] {
        std::fs::write(Path::new(&folder).join(format!("{name}.obj")), text)?;
    }
    Ok(())
}

/// Corners of the square of half width `r` across `along`; `up` is one of its axes.
fn section(centre: DVec3, along: DVec3, up: DVec3, r: f64) -> [DVec3; 4] {
    let side = along.cross(up).normalize() * r;
    let up = up * r;
    [centre - side - up, centre + side - up, centre + side + up, centre - side + up]
}

fn bar() -> String {
    let at = |k: u32| section(DVec3::X * (f64::from(k) - 2.0) * 1.5, DVec3::X, DVec3::Z, 1.0);
    sweep(&(0..5).map(at).collect::<Vec<_>>(), false)
}

/// A short thick pipe: nine sections around.
fn tube() -> String {
    let at = |k: u32| {
        let turn = DQuat::from_rotation_z(TAU * f64::from(k) / 9.0);
        section(turn * (DVec3::X * 1.6), turn * DVec3::Y, DVec3::Z, 0.6)
    };
    sweep(&(0..9).map(at).collect::<Vec<_>>(), true)
}

/// A bar bent to three quarters of a turn whose section makes half a turn.
fn horseshoe() -> String {
    let at = |k: u32| {
        let s = f64::from(k) / 11.0;
        let turn = DQuat::from_rotation_z(1.5 * PI * s);
        let along = turn * DVec3::Y;
        let up = DQuat::from_axis_angle(along, PI * s) * DVec3::Z;
        section(turn * (DVec3::X * 2.0), along, up, 0.5)
    };
    sweep(&(0..12).map(at).collect::<Vec<_>>(), false)
}

/// The hull of the sections; closed to a ring, or with lids.
fn sweep(sections: &[[DVec3; 4]], ring: bool) -> String {
    let mut out = String::new();
    // Writing to a string cannot fail.
    for p in sections.iter().flatten() {
        let _ = writeln!(out, "v {:.6} {:.6} {:.6}", p.x, p.y, p.z);
    }
    let mut quad = |a: usize, b: usize, c: usize, d: usize| {
        let _ = writeln!(out, "f {} {} {}\nf {} {} {}", a + 1, b + 1, c + 1, a + 1, c + 1, d + 1);
    };
    let n = sections.len();
    for k in 0..if ring { n } else { n - 1 } {
        let (a, b) = (4 * k, 4 * ((k + 1) % n));
        for i in 0..4 {
            let j = (i + 1) % 4;
            quad(a + i, b + i, b + j, a + j);
        }
    }
    if !ring {
        let last = 4 * (n - 1);
        quad(0, 1, 2, 3);
        quad(last + 3, last + 2, last + 1, last);
    }
    out
}
