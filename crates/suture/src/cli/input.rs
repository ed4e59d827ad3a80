//! Files in: meshes, labels, way points.

use std::path::Path;

use suture::blend::{CornerMaps, Correspondence, PaperMaps};
use suture::fit::{EnergyOrder, FitOptions, Mode, PenalizedLeastSquares, Smoothing, Tolerance};
use suture::mesh::TriMesh;
use suture::param::{Lscm, Parameterize, Recommended, Spectral};
use suture::segment::{
    Automatic, AutomaticOptions, Labels, Segment, WaypointOptions, Waypoints, read_labels, read_paths,
};
use suture::{ByChart, SutureError, repair_all};

use super::args;

/// Reads a mesh; what the reader or a repair did goes to `notices`.
pub(crate) fn mesh(path: &Path, repairing: bool, notices: &mut Vec<String>) -> Result<TriMesh, SutureError> {
    let wrong = |source| SutureError::Mesh { path: path.to_owned(), source };
    let loaded = suture::mesh::io::read(path).map_err(wrong)?;
    notices.extend(loaded.notices.iter().map(ToString::to_string));
    let mut mesh = loaded.mesh;
    if repairing {
        notices.extend(repair_all(&mut mesh));
        if mesh.faces.is_empty() {
            let what = format!("{}: no face is left after the repairs", path.display());
            return Err(SutureError::Unsuitable { what });
        }
    }
    Ok(mesh)
}

/// Loads a surface that was saved as native JSON.
pub(crate) fn surface(path: &Path) -> Result<suture::surface::Surface, SutureError> {
    let bytes = std::fs::read(path).map_err(|source| SutureError::File { path: path.to_owned(), source })?;
    suture::load_surface(&bytes).map_err(|e| SutureError::Unsuitable {
        what: format!("{}: not a surface saved as native JSON by `-o NAME.json`: {e}", path.display()),
    })
}

pub(crate) fn text(path: &Path) -> Result<String, SutureError> {
    std::fs::read_to_string(path).map_err(|source| SutureError::File { path: path.to_owned(), source })
}

/// The segmentation asked for.
pub(crate) fn segmentation(args: &args::Segmentation) -> Result<Box<dyn Segment>, SutureError> {
    if let Some(path) = &args.labels {
        return Ok(Box::new(Labels(read_labels(&text(path)?)?)));
    }
    if let Some(path) = &args.waypoints {
        let options = WaypointOptions { exponent: args.crease_exponent, ..WaypointOptions::default() };
        return Ok(Box::new(Waypoints { paths: read_paths(&text(path)?)?, options }));
    }
    let options = AutomaticOptions { charts: args.charts, ..AutomaticOptions::default() };
    Ok(Box::new(Automatic { options, flatten: Box::new(ByChart::<Recommended>::default()) }))
}

pub(crate) fn parameterization(args: &args::Shape) -> Box<dyn Parameterize + Sync> {
    match args.parameterization {
        args::Parameterization::Recommended => Box::new(Recommended::default()),
        args::Parameterization::Lscm => Box::new(Lscm::default()),
        args::Parameterization::Spectral => Box::new(Spectral::default()),
    }
}

pub(crate) fn fit(args: &args::Shape) -> Result<PenalizedLeastSquares, SutureError> {
    let mut options = FitOptions::default();
    if let Some(rms) = args.tolerance {
        // Blends lie a little farther off than the fits they are made of.
        options.tolerance = Tolerance { rms: 0.2 * rms, max: rms };
        options.mode = Mode::Tolerance;
    }
    if args.energy == 2 {
        options.order = EnergyOrder::Second;
    }
    options.smoothing = match args.smoothing.as_str() {
        "gcv" => Smoothing::default(),
        "floor" => Smoothing::Floor,
        "floater" => Smoothing::Floater,
        number => number.parse().map(Smoothing::Fixed).map_err(|_| SutureError::Unsuitable {
            what: format!("--smoothing {number}: must be gcv, floor, floater or a number"),
        })?,
    };
    Ok(PenalizedLeastSquares { options })
}

pub(crate) fn maps(args: &args::Shape) -> Box<dyn CornerMaps> {
    let fillet = matches!(args.intent, args::Intent::Fillet);
    match args.maps {
        Some(args::Maps::Correspondence) => Box::new(Correspondence::default()),
        Some(args::Maps::Paper) => Box::new(PaperMaps),
        None if fillet => Box::new(PaperMaps),
        None => Box::new(Correspondence::default()),
    }
}
