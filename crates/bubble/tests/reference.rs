//! The reference numbers of the specification (50-digit arithmetic).

use glam::{DMat3, DVec2, DVec3};
use suture_bubble::{
    BubbleOptions, BubbleSurface, Face, Fit, Implicit, Pairing, PolyMesh, bubble, bubble_with,
};
use suture_surface::{Jet2, Patch};

/// Mean curvature with the sign of the second fundamental form: −1/R on a sphere with outward normal.
fn mean_curvature(j: &Jet2) -> f64 {
    let n = j.du.cross(j.dv).normalize();
    let (e, f, g) = (j.du.dot(j.du), j.du.dot(j.dv), j.dv.dot(j.dv));
    let (l, m, k) = (j.duu.dot(n), j.duv.dot(n), j.dvv.dot(n));
    0.5 * (e * k - 2.0 * f * m + g * l) / (e * g - f * f)
}

/// The cube [−1, 1]³ as the reference numbers its triangles' corners; the first triangle is (0, 1, 3).
fn cube() -> (PolyMesh, Vec<Implicit>) {
    let p = |i: u32| {
        let bit = |k: u32| if i >> k & 1 == 1 { 1.0 } else { -1.0 };
        DVec3::new(bit(2), bit(1), bit(0))
    };
    let positions: Vec<DVec3> = (0..8).map(p).collect();
    let faces = [
        [0, 1, 3],
        [0, 3, 2],
        [4, 6, 7],
        [4, 7, 5],
        [0, 4, 5],
        [0, 5, 1],
        [2, 3, 7],
        [2, 7, 6],
        [0, 2, 6],
        [0, 6, 4],
        [1, 5, 7],
        [1, 7, 3],
    ];
    let normals: Vec<DVec3> = positions.iter().map(|p| p.normalize()).collect();
    let h = DMat3::from_diagonal(DVec3::splat(1.0 / 3f64.sqrt()));
    let implicits = normals.iter().map(|&n| Implicit::quadric(n, h)).collect();
    let faces = faces.into_iter().map(Face::Triangle).collect();
    (PolyMesh { positions, normals, faces }, implicits)
}

#[track_caller]
fn check(surface: &BubbleSurface, uv: [f64; 2], h: f64, p: [f64; 3], n: [f64; 3], mean: f64) {
    let patch = &surface.patches()[0];
    let at = DVec2::from_array(uv);
    let jet = patch.jet(at);
    let near = |name: &str, got: f64, want: f64, tolerance: f64| {
        assert!((got - want).abs() < tolerance, "{name} at {uv:?}: {got} ≠ {want} ({:e})", got - want);
    };
    near("h", patch.height(at).p, h, 1e-13);
    for k in 0..3 {
        near("P", jet.p[k], p[k], 1e-13);
        near("normal", jet.normal().unwrap()[k], n[k], 1e-12);
    }
    near("mean curvature", mean_curvature(&jet), mean, 1e-11);
}

fn surface(order: usize, pairing: Pairing) -> BubbleSurface {
    let (mesh, implicits) = cube();
    bubble_with(&mesh, &implicits, &BubbleOptions { order, pairing, ..Default::default() }).unwrap()
}

const SINGLE: Pairing = Pairing::Single([0, 1, 2]);

#[rustfmt::skip]
#[test]
fn cube_of_order_0() {
    let s = surface(0, SINGLE);
    check(&s, [0.2, 0.3], 0.70621484927275, [-1.40773333333333, -0.563093333333333, 0.0], [-0.975719005920824, -0.218504669024581, 0.0151040093795793], -0.198538368783541);
    check(&s, [0.6, 0.1], 0.425391678338916, [-1.2456, -0.99648, 0.49824], [-0.90775210307541, -0.377657834108529, 0.182649061587034], -0.537657266360658);
    check(&s, [0.25, 0.0], 0.257101291748505, [-1.1484375, -1.1484375, -0.57421875], [-0.906773150557324, -0.321858046614204, -0.272341424058172], 0.105682105040638);
    let s = surface(0, Pairing::Mean);
    check(&s, [0.2, 0.3], 0.726999458963577, [-1.41973333333333, -0.567893333333333, 0.0], [-0.978394768287338, -0.204890303893252, 0.0276340507073523], -0.261094597037876);
    check(&s, [0.6, 0.1], 0.425391678338916, [-1.2456, -0.99648, 0.49824], [-0.903896731395197, -0.375533638214836, 0.204805238073169], -0.528694045275258);
    check(&s, [0.25, 0.0], 0.257101291748505, [-1.1484375, -1.1484375, -0.57421875], [-0.834204961108823, -0.469650824561267, -0.289015892037703], -0.411596438631526);
}

#[rustfmt::skip]
#[test]
fn cube_of_order_1() {
    for pairing in [SINGLE, Pairing::Mean] {
        let s = surface(1, pairing);
        check(&s, [0.2, 0.3], 0.803209694496607, [-1.46373333333333, -0.585493333333333, 0.0], [-0.987571184857422, -0.152338108302475, -0.0386814632366785], -0.377549349922146);
        check(&s, [0.6, 0.1], 0.4752747415969, [-1.2744, -1.01952, 0.50976], [-0.822719037485986, -0.514547536139255, 0.241607571096511], -0.834212972773882);
        check(&s, [0.25, 0.0], 0.257101291748505, [-1.1484375, -1.1484375, -0.57421875], [-0.674731115695567, -0.674731115695567, -0.299125129376372], -1.37963579336431);
    }
}

#[rustfmt::skip]
#[test]
fn cube_of_order_2() {
    let s = surface(2, SINGLE);
    check(&s, [0.2, 0.3], 0.972043767378629, [-1.56120973076015, -0.62448389230406, 0.0], [-0.9634859763551, -0.267343391214611, -0.0149092099365478], -0.474183401562561);
    check(&s, [0.6, 0.1], 0.502316141901239, [-1.29001235974497, -1.03200988779598, 0.51600494389799], [-0.754165171385973, -0.588300789690484, 0.291782581930311], -0.655789352968641);
    check(&s, [0.25, 0.0], 0.267408600936613, [-1.15438842773438, -1.15438842773438, -0.577194213867188], [-0.667357723055247, -0.667357723055247, -0.330556105611488], -0.581984214965752);
    let s = surface(2, Pairing::Mean);
    check(&s, [0.2, 0.3], 0.969546998227949, [-1.5597682204189, -0.62390728816756, 0.0], [-0.9623487996577, -0.271580765631038, -0.011343523995815], -0.467434533032361);
    check(&s, [0.6, 0.1], 0.501717739984429, [-1.28966687223722, -1.03173349778978, 0.515866748894888], [-0.757758684314442, -0.584167766162071, 0.290774478459272], -0.666997663957829);
    check(&s, [0.25, 0.0], 0.267408600936613, [-1.15438842773438, -1.15438842773438, -0.577194213867188], [-0.667357723055247, -0.667357723055247, -0.330556105611488], -0.581984214965752);
}

#[test]
fn boundary_curves_of_the_cube() {
    let wanted: [&[f64]; 3] = [
        &[0.0, 0.23094010767585, 0.461880215351701, 0.461880215351701, 0.23094010767585, 0.0],
        &[0.0, 0.23094010767585, 0.461880215351701, 0.461880215351701, 0.23094010767585, 0.0],
        &[
            0.0,
            0.128300059819917,
            0.256600119639834,
            0.372681126143568,
            0.454820317880128,
            0.454820317880128,
            0.372681126143568,
            0.256600119639834,
            0.128300059819917,
            0.0,
        ],
    ];
    for (order, wanted) in wanted.into_iter().enumerate() {
        let s = surface(order, Pairing::Mean);
        let n = s.network();
        let edge = n.edges().iter().position(|e| e.vertices == [0, 1]).unwrap();
        let got = n.strips()[edge].height_bernstein();
        assert_eq!(got.len(), wanted.len());
        for (g, w) in got.iter().zip(wanted) {
            assert!((g - w).abs() < 1e-14, "{got:?}");
        }
    }
}

/// A skew tetrahedron with normals that are not of unit length, implicits fitted: the heights that a second implementation,
/// without jets, reproduced.
#[test]
fn skew_tetrahedron_with_fitted_implicits() {
    let positions =
        vec![DVec3::ZERO, DVec3::new(2.0, 0.1, 0.2), DVec3::new(0.3, 1.8, -0.1), DVec3::new(0.6, 0.5, 1.7)];
    let normals: Vec<DVec3> = positions.iter().map(|&p| p - DVec3::new(0.7, 0.6, 0.4)).collect();
    let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]].map(Face::Triangle).to_vec();
    let mesh = PolyMesh { positions, normals, faces };
    let wanted = [
        (1, [0.950564539086232, 0.8066981330289332, 0.4081004628688837]),
        (2, [1.221152181406769, 1.05883873225459, 0.4954641725064132]),
    ];
    for (order, wanted) in wanted {
        let options =
            // The reference takes the normals as they are.
            BubbleOptions {
                order,
                fit: Fit::Quadric { lambda: 0.0 },
                pairing: SINGLE,
                steer: 0.0,
                ..Default::default()
            };
        let s = bubble(&mesh, &options).unwrap();
        for (uv, want) in [[0.2, 0.3], [0.6, 0.1], [0.25, 0.0]].into_iter().zip(wanted) {
            let got = s.patches()[2].height(DVec2::from_array(uv)).p;
            assert!((got - want).abs() < 1e-12, "order {order} at {uv:?}: {got} ≠ {want} ({:e})", got - want);
        }
    }
}
