//! Jets against the specification's numbers and against an evaluation in 80 digits (`tests/reference.py`).

mod common;

use common::{Case, blend_named, blends, case_a, entries};
use glam::{DVec2, DVec3};
use suture_coons::{BlendFunction::*, Constituent, ThreeSided};
use suture_surface::Patch;

#[track_caller]
fn near(got: DVec3, want: DVec3, tolerance: f64) {
    assert!(got.distance(want) <= tolerance * (1.0 + want.length()), "{got} ≠ {want}");
}

#[test]
fn four_sided_jets_and_third_derivatives() {
    let mut lines = 0;
    for line in include_str!("reference.txt").lines() {
        let w: Vec<&str> = line.split_whitespace().collect();
        let x = |i: usize| w[i].parse::<f64>().unwrap();
        let (at, i, j) = (DVec2::new(x(3), x(4)), x(5) as usize, x(6) as usize);
        let want = DVec3::new(x(7), x(8), x(9));
        let slot = [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)].iter().position(|&s| s == (i, j));
        let (a, b) = (blend_named(w[1]), blend_named(w[2]));
        let jet = if w[0] == "A" {
            let fill = case_a(a, b);
            // Two evaluations that share nothing but the constituents.
            near(fill.partials(at).unwrap()[i][j], want, 1e-12);
            fill.jet_at(at.x, at.y).unwrap()
        } else {
            ThreeSided::raw([Case::T1, Case::T2, Case::T3].map(Case::sheet), blends(a, b)).jet(at)
        };
        if let Some(slot) = slot {
            near(entries(&jet)[slot], want, 1e-13);
        }
        lines += 1;
    }
    assert_eq!(lines, 240);
}

/// Specification §6, printed digits.
#[test]
fn the_printed_jets() {
    let v = DVec3::new;
    let s1 = Case::S1.jet(DVec2::new(0.3, 0.4));
    near(s1.p, v(0.338941834230865, 0.4045, 0.232278605664912), 2e-15);
    near(s1.duv, v(0.0, 0.0, -0.136992487613479), 2e-15);
    let s2 = Case::S2.jet(DVec2::new(0.3, 0.4));
    near(s2.duu, v(0.0, -0.0990402737891614, -0.106507838936595), 2e-15);
    near(s2.dvv, v(-0.16, 0.0, 0.0543407341513242), 2e-15);
    let [c3, c4] = common::case_a_borders();
    let ([a, b, c], [d, e, f]) = (c3.jet(0.4), c4.jet(0.4));
    near(a, v(0.0395904, 0.3818752, 0.193577201415282), 1e-14);
    near(b, v(0.04624, 0.98272, 0.446119758554454), 1e-14);
    near(c, v(-0.5632, 0.6624, -0.607694278331975), 1e-14);
    near(d, v(1.0119424, 0.443988950446194, 0.249646276123951), 1e-14);
    near(e, v(-0.02288, 0.926586947993396, -0.695840792961668), 1e-14);
    near(f, v(0.0128, -0.467955086677673, -0.196531812640283), 1e-14);
    let a1 = case_a(Trigonometric(1), Trigonometric(1)).jet(DVec2::new(0.3, 0.4));
    near(a1.p, v(0.333891943327691, 0.392092531251099, 0.251873762302147), 2e-15);
    near(a1.duv, v(-0.0878377598032077, 8.81573758468023e-3, -1.38528174615839), 1e-14);
    near(a1.dvv, v(-0.444482152660232, 0.443640625337882, -0.647596061920264), 1e-14);
    let a2 = case_a(Trigonometric(1), Trigonometric(2)).jet(DVec2::new(0.75, 0.125));
    near(a2.p, v(0.760965051170551, 0.153643595632993, 0.362242616945206), 2e-15);
    near(a2.duu, v(9.13143318357901e-3, 0.0807562305485930, -0.582454952264882), 1e-14);
    near(a2.dvv, v(-0.410736342647758, 0.0783155993830761, -1.86584858194435), 1e-14);
}

/// min |f_u × f_v| of case A2 on a 41 × 41 grid.
#[test]
fn regularity_of_case_a2() {
    let fill = case_a(Trigonometric(1), Trigonometric(2));
    let mut smallest = f64::INFINITY;
    for i in 0..=40 {
        for j in 0..=40 {
            let jet = fill.jet(DVec2::new(f64::from(i), f64::from(j)) / 40.0);
            smallest = smallest.min(jet.du.cross(jet.dv).length());
        }
    }
    assert!((smallest - 0.94176156).abs() < 1e-8, "{smallest}");
}
