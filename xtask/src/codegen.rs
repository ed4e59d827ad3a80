//! `cargo xtask codegen`: the generated sources.
//!
//! A generator is a pure function to a string; [`run`] is the one writer.

mod field;
mod linear;
mod n_blend;
mod net;
mod prove;

use std::fmt::Write;
use std::path::Path;

use n_blend::NBlend;

const SIZES: std::ops::RangeInclusive<usize> = 3..=8;

/// Writes the generated sources below `root`, or compares them and verifies what they claim.
///
/// # Errors
/// A stale or unwritable file, or a table that breaks one of its conditions.
pub(crate) fn run(root: &Path, check: bool) -> Result<(), String> {
    let tables = SIZES.map(NBlend::new).collect::<Result<Vec<_>, _>>()?;
    for h in &tables {
        if check {
            prove::prove(h)?;
        }
        println!(
            "N = {}: {} degrees of freedom, energy {:.7}{}",
            h.field.n(),
            h.freedom,
            h.energy(),
            if check { ", every condition holds exactly" } else { "" }
        );
    }
    let folder = root.join("crates/blend/src/tables");
    let files = [("n_blend.rs", n_blend_source(&tables)), ("mod.rs", MODULE.to_owned())];
    for (name, source) in files {
        let path = folder.join(name);
        if check {
            let found = std::fs::read_to_string(&path).unwrap_or_default();
            if found != source {
                return Err(format!(
                    "{} is stale: run `cargo xtask codegen` and commit the result",
                    path.display()
                ));
            }
        } else {
            std::fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
            std::fs::write(&path, source).map_err(|e| format!("{}: {e}", path.display()))?;
        }
    }
    Ok(())
}

const MODULE: &str = "\
//! Generated tables: written by `cargo xtask codegen`, do not edit.

pub(crate) mod n_blend;
";

fn n_blend_source(tables: &[NBlend]) -> String {
    let mut out = String::from(
        "\
//! The weights `H^{N,1}` of the N-blends. Written by `cargo xtask codegen`, do not edit.
//!
//! M. Wagner, K. Hormann, G. Greiner, \"C²-continuous surface reconstruction with piecewise polynomial patches\", 2003: the
//! coefficients of degree 7 that satisfy (H16)–(H18), (H23)–(H25) and C² across the inner edges and minimise
//! ∫ H_UU² + 2 H_UV² + H_VV² over the regular N-gon of edge length 1. They are computed in the number field Q(cos 2π/N), where
//! the conditions hold exactly, and rounded once; Appendix A.2 prints ten digits of N = 3 … 6.
//!
//! Row `α − 1` is the net of triangle `α`, whose corners `(R^α, R^{α+1}, O)` belong to the indices `(i, j, k)`, in the storage
//! order of `suture_bernstein::BezierTriangle`: a line below is a row of constant `k`, `j` rising.
//!
//! | N | energy | degrees of freedom minimised over | smallest coefficient |
//! |---|---|---|---|
",
    );
    let mut body = String::new();
    for h in tables {
        let (n, nets) = (h.field.n(), h.rounded());
        let smallest = nets.iter().flatten().copied().fold(f64::INFINITY, f64::min);
        let _ = writeln!(out, "//! | {n} | {:.7} | {} | {smallest:.4} |", h.energy(), h.freedom);
        let _ = writeln!(
            body,
            "\n/// `H^{{{n},1}}`.\n#[rustfmt::skip]\npub(crate) static N{n}: [[f64; {}]; {n}] = [",
            net::COUNT
        );
        for coefficients in nets {
            body.push_str("    [\n");
            let mut rest = coefficients.as_slice();
            for length in (1..=net::DEGREE + 1).rev() {
                let (row, tail) = rest.split_at(length);
                // `{:?}` is the shortest literal that reads back as the same number.
                let literals: Vec<String> = row.iter().map(|c| format!("{c:?}")).collect();
                let _ = writeln!(body, "        {},", literals.join(", "));
                rest = tail;
            }
            body.push_str("    ],\n");
        }
        body.push_str("];\n");
    }
    out.push_str("\n/// The nets of the triangles of `H^{n,1}`, `None` where no table was generated.\n");
    let _ = writeln!(
        out,
        "pub(crate) fn table(n: usize) -> Option<&'static [[f64; {}]]> {{\n    match n {{",
        net::COUNT
    );
    for h in tables {
        let n = h.field.n();
        let _ = writeln!(out, "        {n} => Some(&N{n}),");
    }
    out.push_str("        _ => None,\n    }\n}\n");
    out + &body
}

#[cfg(test)]
mod printed;

#[cfg(test)]
mod tests {
    use std::sync::OnceLock;

    use glam::DVec2;
    use suture_bernstein::BezierTriangle;

    use super::*;

    fn tables() -> &'static [NBlend] {
        static TABLES: OnceLock<Vec<NBlend>> = OnceLock::new();
        TABLES.get_or_init(|| SIZES.map(|n| NBlend::new(n).unwrap()).collect())
    }

    fn table(n: usize) -> &'static NBlend {
        &tables()[n - SIZES.start()]
    }

    #[test]
    fn the_printed_coefficients_are_met() {
        let mut compared = 0;
        for (n, triangle, coefficients) in printed::PRINTED {
            let nets = table(n).rounded();
            for &([i, j, k], want) in coefficients {
                let q = net::at([i, j, k]);
                let got = nets[triangle - 1][q];
                assert!((got - want).abs() < 5e-10, "h^{{{n},{triangle}}}_{i}{j}{k} = {got}, printed {want}");
                // The rest of the appendix says which triangles mirror which; A.2.2 misprints the second line, whose left side
                // is h^{4,4}.
                assert_eq!(nets[n - triangle][net::at([j, i, k])], got);
                compared += 1;
            }
        }
        assert_eq!(compared, 142);
    }

    #[test]
    fn the_energies_are_those_of_the_paper_s_minimum() {
        for (n, want) in [(3, 18.8474234), (4, 20.7703816), (5, 23.8869567), (6, 26.9265741)] {
            let got = table(n).energy();
            assert!((got - want).abs() < 1e-7 * want, "N = {n}: {got} ≠ {want}");
        }
        let freedom: Vec<usize> = tables().iter().map(|h| h.freedom).collect();
        assert_eq!(freedom, [3, 5, 4, 5, 5, 6]);
    }

    #[test]
    fn every_condition_holds_exactly_and_a_changed_coefficient_is_noticed() {
        for h in tables() {
            prove::prove(h).unwrap();
        }
        for (q, condition) in [
            ([7, 0, 0], "(H16)"),
            ([3, 3, 1], "(H17)"),
            ([3, 2, 2], "(H18)"),
            ([1, 1, 5], "across the inner edge"),
            ([3, 1, 3], "(H25)"),
        ] {
            let mut h = NBlend::new(3).unwrap();
            let entry = &mut h.nets[0][net::at(q)];
            *entry = &*entry + &h.field.ratio(1, i64::MAX);
            let message = prove::prove(&h).unwrap_err();
            assert!(message.contains(condition), "{q:?}: {message}");
        }
    }

    /// The rounded nets, evaluated in the plane by the library that will evaluate them.
    #[test]
    fn the_evaluated_blend_is_c2_and_one_with_its_copies() {
        for h in tables() {
            let n = h.field.n();
            let angle = |corner: usize| std::f64::consts::TAU * corner as f64 / n as f64;
            let radius = 0.5 / (std::f64::consts::PI / n as f64).sin();
            let corner = |a: usize| radius * DVec2::new(-angle(a).sin(), angle(a).cos());
            let triangles: Vec<_> =
                h.rounded().into_iter().map(|net| BezierTriangle::new(net::DEGREE, net).unwrap()).collect();
            let jet = |t: usize, at: DVec2| triangles[t % n].jet([corner(t), corner(t + 1), DVec2::ZERO], at);
            for step in 0..=10 {
                let along = f64::from(step) / 10.0;
                for t in 0..n {
                    let at = corner(t + 1) * along;
                    let jump = jet(t, at).add(jet(t + 1, at).map(|x| -x));
                    for x in [jump.p, jump.du, jump.dv, jump.duu, jump.duv, jump.dvv] {
                        assert!(x.abs() < 1e-11, "N = {n}, edge {t}, {along}: {jump:?}");
                    }
                }
                let at = corner(0).lerp(corner(1), along) * 0.8;
                let sum: f64 = (0..n).map(|i| jet(n - i, DVec2::from_angle(-angle(i)).rotate(at)).p).sum();
                assert!((sum - 1.0).abs() < 1e-14, "N = {n}: {sum}");
            }
        }
    }

    /// The energy again, from the evaluated Hessians.
    #[test]
    fn the_energy_is_the_integral_of_the_evaluated_hessians() {
        let h = table(5);
        let n = h.field.n();
        let apothem = 0.5 / (std::f64::consts::PI / n as f64).tan();
        let corners = [DVec2::new(-0.5, apothem), DVec2::new(0.5, apothem), DVec2::ZERO];
        let triangles: Vec<_> =
            h.rounded().into_iter().map(|net| BezierTriangle::new(net::DEGREE, net).unwrap()).collect();
        // The energy does not notice that the triangles are evaluated in the place of the first one.
        let density = |at: DVec2| -> f64 {
            let jets = triangles.iter().map(|t| t.jet(corners, at));
            jets.map(|j| j.duu * j.duu + 2.0 * j.duv * j.duv + j.dvv * j.dvv).sum()
        };
        // Midpoints of the edges of each of the m² congruent triangles: error O(m⁻⁴) for a smooth integrand.
        let integral = |m: usize| {
            let point = |a: f64, b: f64| {
                corners[2] + ((corners[0] - corners[2]) * a + (corners[1] - corners[2]) * b) / m as f64
            };
            let mut sum = 0.0;
            for a in 0..m {
                for b in 0..m - a {
                    let (a, b) = (a as f64, b as f64);
                    for (x, y) in [(0.5, 0.0), (0.0, 0.5), (0.5, 0.5)] {
                        sum += density(point(a + x, b + y));
                    }
                    if a + b + 2.0 <= m as f64 {
                        for (x, y) in [(0.5, 1.0), (1.0, 0.5), (0.5, 0.5)] {
                            sum += density(point(a + x, b + y));
                        }
                    }
                }
            }
            sum * apothem / 2.0 / (3 * m * m) as f64
        };
        let (coarse, fine) = (integral(16), integral(32));
        let extrapolated = fine + (fine - coarse) / 15.0;
        assert!((extrapolated - h.energy()).abs() < 1e-5 * h.energy(), "{extrapolated} ≠ {}", h.energy());
    }
}
