//! Headless pictures of surfaces (a software rasteriser, no graphics hardware, no window) and HTML pages that show them in any browser.
//!
//! Triangles decide what is visible; normals and curvatures come from the patches, evaluated at the parameters of the pixel, so that
//! reflection lines show the surface and not its triangulation.
//!
//! ```
//! # use glam::{DVec2, DVec3};
//! # use suture_bernstein::{BezierPatch, Jet2};
//! # use suture_surface::{Domain, Patch, PatchKind, Record, SplinePool};
//! # #[derive(Debug)]
//! # struct Bezier(BezierPatch<DVec3>);
//! # impl Patch for Bezier {
//! #     fn domain(&self) -> Domain { Domain::Rectangle { min: DVec2::ZERO, max: DVec2::ONE } }
//! #     fn jet(&self, at: DVec2) -> Jet2 { self.0.jet(at) }
//! #     fn kind(&self) -> PatchKind { PatchKind::Trimmed }
//! #     fn record(&self, _: &mut SplinePool) -> Record { Record { kind: "bezier".into(), data: Default::default() } }
//! # }
//! use suture_surface::Surface;
//! use suture_view::{Shade, ViewOptions, render};
//!
//! let saddle = [DVec3::ZERO, DVec3::Y, DVec3::X, DVec3::new(1.0, 1.0, 1.0)];
//! let surface = Surface::new(vec![Box::new(Bezier(BezierPatch::new([1, 1], saddle.to_vec())?))], vec![])?;
//! let tessellation = suture_tessellate::tessellate(&surface, &Default::default())?;
//! let options = ViewOptions { width: 160, height: 120, shade: Shade::Reflection, ..Default::default() };
//! let image = render(&tessellation, &surface, &options)?;
//! assert_eq!(image.pixels.len(), 160 * 120 * 4);
//!
//! let models = vec![suture_view::PageModel::new("saddle", &surface, &tessellation)];
//! let page = suture_view::Page { title: "A saddle".into(), models, view: options };
//! assert!(page.to_html()?.starts_with("<!doctype html>"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Conventions: angles in radians; right-handed coordinates; the first row of an image is its upper one; colours are sRGB with straight
//! (not premultiplied) alpha, averaged in linear light. The same input gives the same bytes for any number of threads.
//!
//! When not to use it: for shadows, transparency or textures.

#![forbid(unsafe_code)]

mod camera;
mod color;
mod error;
mod image;
mod options;
mod page;
mod raster;
mod render;
mod shade;

pub use error::ViewError;
pub use image::Image;
pub use options::{Background, Camera, Shade, ViewOptions};
pub use page::{Page, PageModel};
pub use render::{render, render_deviation};
pub use shade::curvature_range;
