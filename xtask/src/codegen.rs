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
