//! Pictures that were looked at: what is drawn now must look the same to the eye.
//!
//! `GOLDEN=write cargo test -p suture-view --test golden` writes them anew; look at every one before it is committed.

mod common;

use std::path::{Path, PathBuf};

use common::torus;
use suture_tessellate::{TessellationOptions, tessellate};
use suture_view::{Camera, Image, Shade, ViewOptions, render_deviation};

fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(format!("{name}.png"))
}

fn read(path: &Path) -> Option<Image> {
    let decoder = png::Decoder::new(std::io::BufReader::new(std::fs::File::open(path).ok()?));
    let mut reader = decoder.read_info().ok()?;
    let mut pixels = vec![0; reader.output_buffer_size()?];
    let info = reader.next_frame(&mut pixels).ok()?;
    Some(Image { width: info.width, height: info.height, pixels })
}

/// Mean difference of the channels after both pictures are blurred by 3 × 3 pixels, and the share of pixels that differ by more than 32: what
/// moves by less than a pixel is not seen.
fn difference(a: &Image, b: &Image) -> (f64, f64) {
    assert_eq!((a.width, a.height), (b.width, b.height));
    let (w, h) = (a.width as i64, a.height as i64);
    let blurred = |image: &Image, x: i64, y: i64, c: usize| {
        let mut sum = 0.0;
        for (dx, dy) in (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| (dx, dy))) {
            let (px, py) = ((x + dx).clamp(0, w - 1), (y + dy).clamp(0, h - 1));
            sum += f64::from(image.pixels[(4 * (py * w + px)) as usize + c]);
        }
        sum / 9.0
    };
    let (mut mean, mut far) = (0.0, 0.0);
    for (x, y) in (0..h).flat_map(|y| (0..w).map(move |x| (x, y))) {
        let d = [0, 1, 2].map(|c| (blurred(a, x, y, c) - blurred(b, x, y, c)).abs());
        mean += (d[0] + d[1] + d[2]) / 3.0;
        far += f64::from(u8::from(d.iter().any(|&d| d > 32.0)));
    }
    (mean / (w * h) as f64, far / (w * h) as f64)
}

fn draw(shade: Shade) -> Image {
    let surface = torus(12, 6);
    let t = tessellate(&surface, &TessellationOptions::default()).unwrap();
    // A distance with a maximum on one side.
    let distances: Vec<f64> = t.mesh.positions.iter().map(|p| (2.0 * p.x + p.y).exp()).collect();
    let camera = Camera::Orbit { azimuth: 0.5, elevation: 0.6, distance: 1.0 };
    let options = ViewOptions { width: 240, height: 180, shade, camera, bands: 12, ..Default::default() };
    render_deviation(&t, &surface, &distances, &options).unwrap()
}

#[test]
fn pictures_look_as_they_did() {
    let shades = [
        ("patches", Shade::Patches),
        ("lit", Shade::Lit),
        ("reflection", Shade::Reflection),
        ("isophotes", Shade::Isophotes),
        ("curvature", Shade::Curvature),
        ("deviation", Shade::Deviation),
    ];
    for (name, shade) in shades {
        let now = draw(shade);
        let path = path(name);
        if std::env::var_os("GOLDEN").is_some_and(|v| v == "write") {
            now.write_png(&path).unwrap();
        }
        let golden = read(&path).unwrap_or_else(|| panic!("{} is missing", path.display()));
        let (mean, far) = difference(&golden, &now);
        assert!(
            mean < 1.0 && far < 0.005,
            "{name}: mean difference {mean:.2}, {:.2} % of the pixels",
            100.0 * far
        );
    }
}

#[test]
fn the_tolerance_can_tell() {
    let [a, b] = [Shade::Reflection, Shade::Isophotes].map(draw);
    let (mean, far) = difference(&a, &b);
    assert!(mean > 5.0 && far > 0.05, "{mean} {far}");
    // One pixel to the side is seen on lines.
    let mut moved = a.clone();
    moved.pixels.rotate_right(4);
    let (mean, _) = difference(&a, &moved);
    assert!(mean > 1.0, "{mean}");
}
