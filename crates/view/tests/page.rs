//! Pages by their content: what is in them, what is not, how large they are.

mod common;

use std::io::Read;
use std::time::Instant;

use base64::{Engine, engine::general_purpose::STANDARD};
use common::torus;
use suture_certify::{CertifyOptions, SurfaceSamples, certify, deviation};
use suture_tessellate::{Tessellation, TessellationOptions, tessellate};
use suture_view::{Page, PageModel, Shade, ViewError, ViewOptions};

fn samples(t: &Tessellation) -> SurfaceSamples<'_> {
    SurfaceSamples {
        positions: &t.mesh.positions,
        triangles: &t.mesh.faces,
        triangle_patch: &t.triangle_patch,
        corner_parameters: &t.corner_parameters,
    }
}

/// Head and body of the data of a page.
fn unpack(html: &str) -> (serde_json::Value, Vec<u8>) {
    let start = html.find("id=\"suture-data\">").unwrap() + 17;
    let text = &html[start..start + html[start..].find('<').unwrap()];
    let mut all = Vec::new();
    flate2::read::GzDecoder::new(&STANDARD.decode(text).unwrap()[..]).read_to_end(&mut all).unwrap();
    let length = u32::from_le_bytes(all[..4].try_into().unwrap()) as usize;
    (serde_json::from_slice(&all[4..4 + length]).unwrap(), all[4 + length..].to_vec())
}

#[test]
fn a_page_holds_everything_and_asks_for_nothing() {
    let surface = torus(12, 6);
    let t = tessellate(&surface, &TessellationOptions::default()).unwrap();
    let coarse =
        tessellate(&surface, &TessellationOptions { chord: 5e-3, ..Default::default() }).unwrap().mesh;
    let certificate = certify(&surface, coarse.diagonal(), &CertifyOptions::default()).unwrap();
    let distances = deviation(&coarse, &surface, &samples(&t)).unwrap();
    let labels: Vec<u32> = (0..coarse.faces.len() as u32).map(|f| f % 5).collect();
    let model = PageModel {
        certificate: Some(&certificate),
        deviation: Some(&distances),
        mesh: Some(&coarse),
        labels: Some(&labels),
        degrees: vec!["3 × 3".into(); 72],
        hull: vec![([glam::DVec3::ZERO; 4], true)],
        report: serde_json::json!({ "certificate": { "claimed": "C2" }, "note": "</script><b>" }),
        ..PageModel::new("one", &surface, &t)
    };
    let view = ViewOptions { shade: Shade::Reflection, bands: 7, ..Default::default() };
    let page = Page { title: "a <b> & c".into(), models: vec![model], view };
    let html = page.to_html().unwrap();
    assert!(html.contains("<title>a &lt;b&gt; &amp; c</title>"));
    // Two scripts, one of them the data; nothing that the network would be asked for.
    assert_eq!((html.matches("<script").count(), html.matches("</script").count()), (2, 2));
    assert!(
        !html.contains(" src=")
            && !html.contains("<link")
            && !html.contains("@import")
            && !html.contains("{{")
    );

    let (head, body) = unpack(&html);
    assert_eq!((head["title"].as_str(), head["view"]["bands"].as_u64()), (Some("a <b> & c"), Some(7)));
    assert_eq!((head["view"]["shade"].as_str(), head["view"]["up"].as_u64()), (Some("reflection"), Some(2)));
    assert_eq!(head["kinds"].as_array().unwrap().len(), 5);
    let model = &head["models"][0];
    assert_eq!(model["patches"], 72);
    let count = |name: &str| model["sections"][name]["count"].as_u64().unwrap() as usize;
    assert_eq!(count("triangles"), 3 * t.mesh.faces.len());
    assert_eq!(count("seam_patches"), 2 * surface.seams().len());
    assert_eq!((count("mesh_labels"), count("hull"), count("patch_worst")), (labels.len(), 12, 72));
    let end = model["sections"].as_object().unwrap().values().map(|s| {
        (s["offset"].as_u64().unwrap() + s["count"].as_u64().unwrap() * s["width"].as_u64().unwrap()) as usize
    });
    assert_eq!(end.max(), Some(body.len()));
    // Principal curvatures of a torus of tube 0.45 around a circle of radius 1 lie between −1/0.55 and 1/0.45.
    let largest = model["ranges"]["largest"].as_f64().unwrap();
    assert!((largest / coarse.diagonal() - 1.0 / 0.45).abs() < 1e-9, "{largest}");
}

#[test]
fn pages_do_not_depend_on_threads() {
    let surface = torus(12, 6);
    let t = tessellate(&surface, &TessellationOptions::default()).unwrap();
    let page = Page { models: vec![PageModel::new("", &surface, &t); 2], ..Default::default() };
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| page.to_html().unwrap())
    };
    assert!(run(1) == run(4));
}

#[test]
fn a_hundred_thousand_triangles_fit_into_fifteen_megabytes() {
    let surface = torus(24, 12);
    let options = TessellationOptions { chord: 2e-6, angle: 0.05, ..Default::default() };
    let t = tessellate(&surface, &options).unwrap();
    let triangles = t.mesh.faces.len();
    assert!(triangles > 100_000, "{triangles}");
    let start = Instant::now();
    let html =
        Page { models: vec![PageModel::new("", &surface, &t)], ..Default::default() }.to_html().unwrap();
    println!(
        "{triangles} triangles: {:.2} MB in {:.2} s",
        html.len() as f64 / 1e6,
        start.elapsed().as_secs_f64()
    );
    assert!(html.len() < 150 * triangles, "{}", html.len());
}

#[test]
fn defects_are_errors() {
    let surface = torus(6, 3);
    let t = tessellate(&surface, &TessellationOptions::default()).unwrap();
    assert!(matches!(Page::default().to_html(), Err(ViewError::Empty)));
    let degrees = PageModel { degrees: vec![String::new()], ..PageModel::new("", &surface, &t) };
    let page = Page { models: vec![degrees], ..Default::default() };
    assert!(matches!(page.to_html(), Err(ViewError::Length { name: "degrees", given: 1, needed: 18 })));
    let other = torus(3, 3);
    let page = Page { models: vec![PageModel::new("", &other, &t)], ..Default::default() };
    assert!(matches!(page.to_html(), Err(ViewError::Mismatch { .. })));
    let folder = tempfile::tempdir().unwrap();
    let page = Page { models: vec![PageModel::new("", &surface, &t)], ..Default::default() };
    assert!(matches!(page.write_html(folder.path().join("no/such.html")), Err(ViewError::Write { .. })));
    page.write_html(folder.path().join("such.html")).unwrap();
}
