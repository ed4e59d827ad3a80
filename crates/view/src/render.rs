//! The picture, band by band.

use glam::{DVec2, DVec3};
use rayon::prelude::*;
use suture_surface::{Patch, PatchKind, Surface};
use suture_tessellate::Tessellation;

use crate::{
    Background, Image, Shade, ViewError, ViewOptions,
    camera::View,
    color,
    raster::{NOTHING, Piece, draw, pieces},
    shade::{Probe, Shader, curvature_range, deviation_range},
};

/// Rows of pixels that one task draws.
const BAND: usize = 16;

/// Draws a surface; `tessellation` must be one of this very surface.
///
/// Per pixel and visible patch one jet is evaluated; the other samples of the pixel extend its normal to first order.
///
/// # Errors
/// [`ViewError::Option`], [`ViewError::Empty`], [`ViewError::Extent`], [`ViewError::Mismatch`].
pub fn render(
    tessellation: &Tessellation,
    surface: &Surface,
    options: &ViewOptions,
) -> Result<Image, ViewError> {
    match options.shade {
        Shade::Deviation => Err(ViewError::NoDistances),
        _ => picture(tessellation, surface, &[], options),
    }
}

/// Draws a surface whose distances from a mesh are known: `distances` has one per vertex of the tessellation, relative to whatever the
/// caller likes. As [`render`] for all shades but [`Shade::Deviation`].
///
/// # Errors
/// As [`render`], and [`ViewError::Length`].
pub fn render_deviation(
    tessellation: &Tessellation,
    surface: &Surface,
    distances: &[f64],
    options: &ViewOptions,
) -> Result<Image, ViewError> {
    let (given, needed) = (distances.len(), tessellation.mesh.positions.len());
    if given != needed {
        return Err(ViewError::Length { name: "distances", given, needed });
    }
    picture(tessellation, surface, distances, options)
}

fn picture(
    tessellation: &Tessellation,
    surface: &Surface,
    distances: &[f64],
    options: &ViewOptions,
) -> Result<Image, ViewError> {
    options.check()?;
    check(tessellation, surface)?;
    let mesh = &tessellation.mesh;
    let view = View::new(mesh, options)?;
    let range = match options.shade {
        Shade::Curvature => options.curvature_range.unwrap_or_else(|| curvature_range(tessellation, surface)),
        Shade::Deviation => {
            options.deviation_range.unwrap_or_else(|| deviation_range(tessellation, distances))
        }
        _ => 0.0,
    };
    let samples = options.samples as usize;
    let (width, height) = (options.width as usize, options.height as usize);
    let pieces = pieces(mesh, &view, samples as f64);
    let mut order = vec![Vec::new(); height.div_ceil(BAND)];
    for (number, piece) in pieces.iter().enumerate() {
        let rows = piece.rows(height * samples);
        if !rows.is_empty() {
            for band in rows.start / (BAND * samples)..=(rows.end - 1) / (BAND * samples) {
                order[band].push(number as u32);
            }
        }
    }
    let scene = Scene {
        tessellation,
        surface,
        distances,
        kinds: surface.patches().iter().map(|p| p.kind()).collect(),
        pieces,
        shader: Shader::new(options, &view, range),
        samples,
        width,
        background: options.background,
    };
    let mut pixels = vec![0; width * height * 4];
    pixels.par_chunks_mut(width * BAND * 4).zip(&order).enumerate().for_each(|(band, (pixels, order))| {
        scene.band(band * BAND, pixels, order);
    });
    Ok(Image { width: options.width, height: options.height, pixels })
}

/// Whether `tessellation` can be one of `surface`.
pub(crate) fn check(tessellation: &Tessellation, surface: &Surface) -> Result<(), ViewError> {
    let mesh = &tessellation.mesh;
    if mesh.faces.is_empty() {
        return Err(ViewError::Empty);
    }
    let faces = mesh.faces.len();
    let listed = tessellation.triangle_patch.len().min(tessellation.corner_parameters.len());
    if listed < faces {
        return Err(ViewError::Mismatch { triangle: listed, reason: "it has no patch or no parameters" });
    }
    for (triangle, face) in mesh.faces.iter().enumerate() {
        if face.iter().any(|&v| v as usize >= mesh.positions.len()) {
            return Err(ViewError::Mismatch { triangle, reason: "it names a vertex that does not exist" });
        }
        if surface.patch(tessellation.triangle_patch[triangle]).is_none() {
            return Err(ViewError::Mismatch { triangle, reason: "it names a patch that does not exist" });
        }
    }
    Ok(())
}

struct Scene<'a> {
    tessellation: &'a Tessellation,
    surface: &'a Surface,
    /// One per vertex, or none at all.
    distances: &'a [f64],
    kinds: Vec<PatchKind>,
    pieces: Vec<Piece>,
    shader: Shader,
    samples: usize,
    width: usize,
    background: Background,
}

/// A probe, the triangle side and the patch it stands for.
struct Shared {
    patch: u32,
    front: bool,
    inverse: f64,
    probe: Probe,
}

impl Scene<'_> {
    /// Draws the rows of pixels from `first` into `pixels`.
    fn band(&self, first: usize, pixels: &mut [u8], order: &[u32]) {
        let s = self.samples;
        let wide = self.width * s;
        let rows = pixels.len() / (self.width * 4);
        let shown = draw(&self.pieces, order, wide, first * s..(first + rows) * s);
        let mut shared = Vec::with_capacity(s * s);
        for (i, pixel) in pixels.chunks_exact_mut(4).enumerate() {
            let (x, y) = (i % self.width, i / self.width);
            shared.clear();
            let mut sum = DVec3::ZERO;
            let mut covered = 0;
            for k in 0..s * s {
                let (sx, sy) = (x * s + k % s, y * s + k / s);
                let number = shown[sy * wide + sx];
                if number != NOTHING {
                    sum += self.sample(number, sx, first * s + sy, &mut shared);
                    covered += 1;
                }
            }
            let share = f64::from(covered) / (s * s) as f64;
            let (color, alpha) = match self.background {
                Background::White => (sum / (s * s) as f64 + DVec3::splat(1.0 - share), 1.0),
                Background::Transparent => (sum / f64::from(covered.max(1)), share),
            };
            pixel[..3].copy_from_slice(&color::encode(color));
            pixel[3] = (255.0 * alpha).round() as u8;
        }
    }

    /// The colour of one sample; `shared` are the probes that its pixel has so far.
    fn sample(&self, number: u32, x: usize, y: usize, shared: &mut Vec<Shared>) -> DVec3 {
        let piece = &self.pieces[number as usize];
        let triangle = piece.triangle as usize;
        let patch = self.tessellation.triangle_patch[triangle].0;
        let (b, inverse) = piece.at(x, y);
        let corners = self.tessellation.corner_parameters[triangle];
        let at: DVec2 = corners[0] * b.x + corners[1] * b.y + corners[2] * b.z;
        // The same patch may pass through the pixel twice, one sheet behind the other.
        let known = shared.iter().find_map(|s| {
            let same = s.patch == patch && s.front == piece.front && (s.inverse / inverse - 1.0).abs() < 0.05;
            if same { s.probe.near(at).map(|near| (s.probe, near)) } else { None }
        });
        let (probe, (p, n)) = known.unwrap_or_else(|| {
            let surface_patch: &dyn Patch = &*self.surface.patches()[patch as usize];
            let facet = self.tessellation.mesh.area_vector(triangle).normalize_or(DVec3::Z);
            let probe = Probe::new(&surface_patch.jet(at), at, facet);
            shared.push(Shared { patch, front: piece.front, inverse, probe });
            // A probe is near to itself, unless its derivatives are not finite.
            (probe, probe.near(at).unwrap_or((self.tessellation.mesh.corners(triangle)[0], facet)))
        });
        let distance = if self.distances.is_empty() {
            0.0
        } else {
            let [i, j, k] = self.tessellation.mesh.faces[triangle].map(|v| self.distances[v as usize]);
            i * b.x + j * b.y + k * b.z
        };
        self.shader.color(&probe, p, n, piece.front, self.kinds[patch as usize], distance)
    }
}
