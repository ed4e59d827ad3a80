//! Pictures by coarse statistics, determinism, errors, files.

mod common;

use common::{piece, torus};
use glam::DVec3;
use suture_surface::{PatchKind, Surface};
use suture_tessellate::{Tessellation, TessellationOptions, tessellate};
use suture_view::{Background, Camera, Image, Shade, ViewError, ViewOptions, curvature_range, render};

fn options(shade: Shade) -> ViewOptions {
    ViewOptions { width: 160, height: 120, shade, background: Background::Transparent, ..Default::default() }
}

fn mesh(surface: &Surface) -> Tessellation {
    tessellate(surface, &TessellationOptions::default()).unwrap()
}

#[track_caller]
fn picture(surface: &Surface, options: &ViewOptions) -> Image {
    let image = render(&mesh(surface), surface, options).unwrap();
    assert_eq!(image.pixels.len(), 4 * (image.width * image.height) as usize);
    image
}

/// Share of pixels for which `f` holds.
fn share(image: &Image, f: impl Fn([u8; 4]) -> bool) -> f64 {
    let hits = image.pixels.chunks_exact(4).filter(|p| f([p[0], p[1], p[2], p[3]])).count();
    hits as f64 / (image.width * image.height) as f64
}

/// Mean brightness of the covered pixels, 0 to 1.
fn brightness(image: &Image) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for p in image.pixels.chunks_exact(4).filter(|p| p[3] == 255) {
        sum += (f64::from(p[0]) + f64::from(p[1]) + f64::from(p[2])) / 765.0;
        count += 1.0;
    }
    sum / count
}

/// First and last covered column and row.
fn extent(image: &Image) -> [u32; 4] {
    let mut e = [u32::MAX, 0, u32::MAX, 0];
    for y in 0..image.height {
        for x in 0..image.width {
            if image.pixel(x, y).unwrap()[3] > 0 {
                e = [e[0].min(x), e[1].max(x), e[2].min(y), e[3].max(y)];
            }
        }
    }
    e
}

#[test]
fn the_torus_fills_the_picture_and_keeps_its_hole() {
    let surface = torus(12, 6);
    for azimuth in [0.0, 1.0, 4.0] {
        let camera = Camera::Orbit { azimuth, elevation: 1.2, distance: 1.0 };
        let image = picture(&surface, &ViewOptions { camera, ..options(Shade::Lit) });
        let [x0, x1, y0, y1] = extent(&image);
        // One axis is filled to 94 %, nothing is cut off.
        assert!(x0 > 0 && x1 < 159 && y0 > 0 && y1 < 119);
        assert!(y1 - y0 > 105 || x1 - x0 > 140, "{:?}", [x0, x1, y0, y1]);
        assert_eq!(image.pixel(80, 60).unwrap()[3], 0);
        // From above, an annulus of radii 1.45 and 0.55.
        let covered = share(&image, |p| p[3] > 127);
        assert!((0.35..0.55).contains(&covered), "{covered}");
    }
}

#[test]
fn there_are_no_holes_between_triangles() {
    let surface = torus(12, 6);
    let t = mesh(&surface);
    // From inside the hole the torus is all around: one sample per pixel would show a crack as a background pixel.
    let camera = Camera::LookAt { eye: DVec3::new(0.0, 0.01, 0.02), target: DVec3::X };
    let image =
        render(&t, &surface, &ViewOptions { camera, samples: 1, field_of_view: 0.3, ..options(Shade::Lit) });
    assert_eq!(share(&image.unwrap(), |p| p[3] == 255), 1.0);
}

#[test]
fn patches_have_the_colours_of_the_paper() {
    let image = picture(&torus(12, 6), &options(Shade::Patches));
    let dominant = |r: bool, g: bool, b: bool| {
        share(&image, |p| {
            let m = p[0].max(p[1]).max(p[2]) / 4 * 3;
            p[3] == 255 && (p[0] > m) == r && (p[1] > m) == g && (p[2] > m) == b
        })
    };
    for (name, share) in [
        ("blue", dominant(false, false, true)),
        ("red", dominant(true, false, false)),
        ("green", dominant(false, true, false)),
        ("yellow", dominant(true, true, false)),
    ] {
        assert!(share > 0.03, "{name}: {share}");
    }
}

#[test]
fn curvature_is_red_outside_and_blue_in_the_hole() {
    let surface = torus(12, 6);
    let t = mesh(&surface);
    // H lies between (1/r − 1/(R − r))/2 and (1/r + 1/(R + r))/2.
    let range = curvature_range(&t, &surface);
    let (least, most) = ((1.0 / 0.45 - 1.0 / 0.55) / 2.0, (1.0 / 0.45 + 1.0 / 1.45) / 2.0);
    assert!(range > 0.9 * most && range < most && least > 0.0, "{range} {most}");
    let red = picture(&surface, &options(Shade::Curvature));
    assert!(share(&red, |p| p[3] == 255 && p[0] > p[2]) > 0.3);
    assert_eq!(share(&red, |p| p[3] == 255 && p[2] > p[0]), 0.0);
    // Seen from its back side, the same piece is hollow.
    let open = piece(PatchKind::Trimmed);
    let outside = Camera::LookAt { eye: DVec3::new(0.0, 6.0, 0.0), target: DVec3::new(0.0, 0.8, 0.0) };
    let blue = picture(&open, &ViewOptions { camera: outside, ..options(Shade::Curvature) });
    assert!(share(&blue, |p| p[3] == 255 && p[2] > p[0]) > 0.02);
}

#[test]
fn bands_are_half_light_and_half_dark() {
    for shade in [Shade::Reflection, Shade::Isophotes] {
        let image = picture(&torus(12, 6), &ViewOptions { bands: 6, samples: 1, ..options(shade) });
        let [light, dark] = [true, false].map(|l| share(&image, |p| p[3] == 255 && (p[1] > 130) == l));
        assert!(light > 0.4 * dark && dark > 0.4 * light, "{shade:?}: {light} {dark}");
    }
}

#[test]
fn exact_normals_hide_the_triangulation() {
    let surface = torus(4, 3);
    let o = TessellationOptions { chord: 1e-4, ..Default::default() };
    let fine = tessellate(&surface, &o).unwrap();
    let coarse = tessellate(&surface, &TessellationOptions { chord: 2e-3, angle: 0.6, ..o }).unwrap();
    assert!(coarse.mesh.faces.len() * 5 < fine.mesh.faces.len());
    let camera = Camera::Orbit { azimuth: 0.3, elevation: 0.6, distance: 1.0 };
    let o = ViewOptions { camera, ..options(Shade::Lit) };
    let [a, b] = [coarse, fine].map(|t| render(&t, &surface, &o).unwrap());
    let (mut sum, mut count) = (0.0, 0.0);
    for (p, q) in a.pixels.chunks_exact(4).zip(b.pixels.chunks_exact(4)) {
        if p[3] == 255 && q[3] == 255 {
            sum += f64::from(p[0].abs_diff(q[0]));
            count += 1.0;
        }
    }
    // Facets of this size would differ by 10 and more.
    assert!(sum / count < 1.5, "{}", sum / count);
}

#[test]
fn bytes_do_not_depend_on_threads() {
    let surface = torus(12, 6);
    let t = mesh(&surface);
    for shade in [Shade::Patches, Shade::Reflection, Shade::Isophotes, Shade::Curvature] {
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| render(&t, &surface, &options(shade)).unwrap())
        };
        assert_eq!(run(1), run(4));
    }
}

#[test]
fn lit_pictures_are_neither_dark_nor_burnt() {
    for shade in [Shade::Lit, Shade::Patches, Shade::Curvature] {
        let b = brightness(&picture(&torus(12, 6), &options(shade)));
        assert!((0.3..0.85).contains(&b), "{shade:?}: {b}");
    }
}

#[test]
fn white_is_the_default_background() {
    let image = picture(&torus(6, 3), &ViewOptions { width: 64, height: 48, ..Default::default() });
    assert_eq!(image.pixel(0, 0), Some([255; 4]));
    assert_eq!(image.pixel(64, 0), None);
    assert_eq!(share(&image, |p| p[3] == 255), 1.0);
}

#[test]
fn an_eye_inside_the_surface_clips() {
    let surface = torus(12, 6);
    let camera = Camera::LookAt { eye: DVec3::new(1.0, 0.0, 0.0), target: DVec3::new(1.0, 1.0, 0.0) };
    let image = picture(&surface, &ViewOptions { camera, field_of_view: 1.5, ..options(Shade::Lit) });
    assert_eq!(share(&image, |p| p[3] == 255), 1.0);
}

#[test]
fn defects_are_errors() {
    let surface = torus(6, 3);
    let t = mesh(&surface);
    let fails = |o: ViewOptions| matches!(render(&t, &surface, &o), Err(ViewError::Option { .. }));
    let base = || options(Shade::Lit);
    assert!(fails(ViewOptions { width: 0, ..base() }));
    assert!(fails(ViewOptions { height: 1 << 20, ..base() }));
    assert!(fails(ViewOptions { samples: 9, ..base() }));
    assert!(fails(ViewOptions { up: DVec3::ZERO, ..base() }));
    assert!(fails(ViewOptions { field_of_view: f64::NAN, ..base() }));
    assert!(fails(ViewOptions { camera: Camera::LookAt { eye: DVec3::ONE, target: DVec3::ONE }, ..base() }));
    let mut none = t.clone();
    none.mesh.faces.clear();
    assert!(matches!(render(&none, &surface, &base()), Err(ViewError::Empty)));
    let other = piece(PatchKind::Trimmed);
    assert!(matches!(render(&t, &other, &base()), Err(ViewError::Mismatch { .. })));
    let mut nan = t.clone();
    nan.mesh.positions[0].x = f64::INFINITY;
    assert!(matches!(render(&nan, &surface, &base()), Err(ViewError::Extent { .. })));
}

#[test]
fn files_appear_complete_or_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let image = picture(&torus(6, 3), &ViewOptions { width: 32, height: 24, ..options(Shade::Lit) });
    let path = folder.path().join("torus.png");
    std::fs::write(&path, "old").unwrap();
    image.write_png(&path).unwrap();
    let decoder = png::Decoder::new(std::io::Cursor::new(std::fs::read(&path).unwrap()));
    let mut reader = decoder.read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    assert_eq!(pixels, image.pixels);
    let names: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert_eq!(names, ["torus.png"]);
    assert!(matches!(image.write_png(folder.path().join("no/such.png")), Err(ViewError::Write { .. })));
    let torn = Image { pixels: vec![0; 5], ..image };
    assert!(matches!(torn.write_png(&path), Err(ViewError::Pixels { given: 5, .. })));
}
