//! `suture fill`.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::{Args as ClapArgs, ValueEnum};
use serde::Serialize;
use suture::coons::{self, Family, FillOptions, Gap, GapOptions, Order, scene};
use suture::surface::{EdgeRef, PatchId};
use suture::tessellate::TessellationOptions;
use suture::view::PageModel;
use suture::{Report, SutureError, Unfilled, degrees, fill_and_measure};

use super::commands::{settings, summary};
use super::progress::Progress;
use super::{args, output};

#[derive(ClapArgs, Debug, Serialize)]
pub(crate) struct Fill {
    /// A scene (surfaces and what to fill between them, docs/fill-scene.md), or a surface as written by `-o NAME.json`
    #[serde(skip)]
    pub(crate) input: PathBuf,
    /// Where to write; the extension names the format: .step (CAD), .glb .obj .ply .stl, .json (lossless), .png (picture), .html (page for any browser); may be repeated
    #[arg(long, short, value_name = "FILE", required = true)]
    #[serde(skip)]
    output: Vec<PathBuf>,
    /// How smoothly to join; for a scene in place of what its fills say (without it: what they say, else C2)
    #[arg(long, value_enum, value_name = "ORDER")]
    order: Option<Smoothness>,
    /// A gap to fill: two edges, each a surface of the scene (a patch number of the surface file) and the number of its edge, for example
    /// left:2,right:0; may be repeated. Without it: the fills of the scene, else all gaps that are found
    #[arg(long, value_name = "A:E,B:E")]
    gap: Vec<String>,
    /// Gaps are sought up to this width, relative to the length of the shorter edge
    #[arg(long, value_name = "RATIO", default_value_t = GapOptions::default().widest)]
    widest: f64,
    /// Move border curves that do not join as asked for, and say how far
    #[arg(long)]
    repair: bool,
    /// Largest difference at a corner that counts as none, relative to the diagonal of the gap
    #[arg(long, value_name = "LENGTH", default_value_t = FillOptions::default().tolerance)]
    tolerance: f64,
    /// Family of blend functions (without it: that of the scene, else polynomial)
    #[arg(long, value_enum)]
    blend: Option<Blend>,
    /// Largest distance of the tessellation's chords from the surface
    #[arg(long, value_name = "LENGTH", default_value_t = TessellationOptions::default().chord)]
    chord: f64,
    #[command(flatten)]
    #[serde(flatten)]
    cad: args::Cad,
    #[command(flatten)]
    #[serde(flatten)]
    picture: args::Picture,
}

#[derive(ValueEnum, Clone, Copy, Debug, Serialize)]
#[value(rename_all = "verbatim")]
enum Smoothness {
    /// Positions
    C0,
    /// First derivatives
    C1,
    /// Second derivatives
    C2,
    /// Third derivatives
    C3,
    /// Tangent planes
    G1,
    /// Curvatures
    G2,
}

#[derive(ValueEnum, Clone, Copy, Debug, Serialize)]
#[serde(rename_all = "snake_case")]
enum Blend {
    /// The smallest derivatives
    Polynomial,
    /// As the paper's Equation 1, with the correction of Theorem 3
    Trigonometric,
    /// As the paper's Equation 3, with a correction of its own
    Rational,
    /// Quotients of powers
    SymmetricRational,
}

/// Fills; whether everything that was asked for and claimed holds.
pub(crate) fn run(a: &Fill, common: &args::Common, report: &mut Report) -> Result<bool, SutureError> {
    let outputs: Vec<output::Output> =
        a.output.iter().map(|p| output::Output::parse(p)).collect::<Result<_, _>>()?;
    let view = output::view_options(&a.picture)?;
    report.settings = settings(a);
    let mut unfilled = read(&a.input)?;
    name_gaps(&mut unfilled, &a.gap)?;
    let mut options = FillOptions { repair: a.repair, tolerance: a.tolerance, ..FillOptions::default() };
    if !(a.tolerance >= 0.0 && a.tolerance.is_finite()) {
        let what = format!("--tolerance {}: must be a number that is not negative", a.tolerance);
        return Err(SutureError::Unsuitable { what });
    }
    options.order = a.order.map_or(options.order, Smoothness::order);
    options.family = a.blend.map_or(options.family, Blend::family);
    if let Unfilled::Scene(scene) = &mut unfilled {
        if let Some(order) = a.order {
            *scene = scene.clone().with_order(order.order());
        }
        scene.blend = a.blend.map(Blend::family).or(scene.blend);
    }
    let search = GapOptions { widest: a.widest };
    let tessellation = TessellationOptions { chord: a.chord, ..TessellationOptions::default() };
    let progress = Progress::new(common.quiet);
    let filled = fill_and_measure(unfilled, &options, &search, &tessellation, &progress)?;
    report.describe_filled(&filled);
    let made = output::Made {
        model: PageModel {
            certificate: Some(&filled.certificate),
            degrees: degrees(&filled.surface),
            ..PageModel::new("", &filled.surface, &filled.tessellation)
        },
        view: &view,
        cad: &a.cad,
        diagonal: filled.tessellation.mesh.diagonal(),
    };
    output::all(&outputs, &made, &progress, report)?;
    drop(progress);
    if !common.quiet {
        filled.report.fills.iter().enumerate().for_each(|(i, fill)| println!("{}", line(i, fill)));
        print!("{}", summary(report));
    }
    Ok(report.holds() && filled.complete())
}

/// What people read of one fill.
fn line(number: usize, fill: &coons::Join) -> String {
    let list = |x: &[f64]| x.iter().map(|x| format!("{x:.1e}")).collect::<Vec<_>>().join(", ");
    let reached = fill.reached().map_or("nothing".into(), |r| format!("{r:?}"));
    let detail = match &fill.certificate {
        coons::JoinCertificate::Corners(c) => match &c.proven_jumps {
            Some(proven) => format!("jumps of derivatives 0, 1, … proven below {}", list(proven)),
            None => format!("jumps of derivatives 0, 1, … {}", list(&c.jumps)),
        },
        coons::JoinCertificate::Hole(c) => {
            let worst = |j: usize| c.jumps.iter().map(|e| e[j]).fold(0.0, f64::max);
            let jumps: Vec<f64> = (0..c.jumps[0].len()).map(worst).collect();
            format!("three sides, jumps of derivatives 0, 1, … {}", list(&jumps))
        }
        coons::JoinCertificate::Split(c) => {
            let normal = c.sides.iter().chain(&c.spokes).copied().fold(0.0, f64::max);
            format!("{} sides, position {:.1e}, normal {normal:.1e} rad", c.sides.len(), c.position)
        }
    };
    format!("fill {number:<7} {:?} asked, {reached} reached: {detail}", fill.asked)
}

/// A scene or a saved surface: whichever the file is.
fn read(path: &Path) -> Result<Unfilled, SutureError> {
    let bytes = std::fs::read(path).map_err(|source| SutureError::File { path: path.to_owned(), source })?;
    let unsuitable = |what: String| SutureError::Unsuitable { what: format!("{}: {what}", path.display()) };
    #[derive(serde::Deserialize)]
    struct Head {
        surfaces: Option<serde::de::IgnoredAny>,
    }
    let head: Head = serde_json::from_slice(&bytes).map_err(|e| unsuitable(format!("not JSON: {e}")))?;
    if head.surfaces.is_some() {
        let text = std::str::from_utf8(&bytes).map_err(|e| unsuitable(format!("not text: {e}")))?;
        return Ok(Unfilled::Scene(scene::read(text).map_err(|e| unsuitable(e.to_string()))?));
    }
    let surface = suture::load_surface(&bytes).map_err(|e| {
        unsuitable(format!("neither a scene (docs/fill-scene.md) nor a surface saved by `-o NAME.json`: {e}"))
    })?;
    Ok(Unfilled::Surface { surface: Arc::new(surface), gaps: None })
}

/// Puts the gaps named by the arguments in place of those of the input.
fn name_gaps(unfilled: &mut Unfilled, named: &[String]) -> Result<(), SutureError> {
    if named.is_empty() {
        return Ok(());
    }
    let pairs = named.iter().map(|gap| {
        // From the right: names of surfaces may hold anything.
        let edge = |text: &str| {
            let (name, edge) = text.rsplit_once(':')?;
            Some((name.to_owned(), edge.parse::<u8>().ok()?))
        };
        let pair = gap.split_once(',').and_then(|(a, b)| Some([edge(a)?, edge(b)?]));
        pair.ok_or_else(|| SutureError::Unsuitable {
            what: format!("--gap {gap}: must be two edges, each SURFACE:EDGE, for example left:2,right:0"),
        })
    });
    let pairs: Vec<[(String, u8); 2]> = pairs.collect::<Result<_, _>>()?;
    match unfilled {
        Unfilled::Scene(scene) => {
            let fill = |[a, b]: [(String, u8); 2]| {
                scene::SceneFill::between(scene::SceneEdge::new(&a.0, a.1), scene::SceneEdge::new(&b.0, b.1))
            };
            scene.fills = pairs.into_iter().map(fill).collect();
        }
        Unfilled::Surface { surface, gaps } => {
            let gap = |[a, b]: [(String, u8); 2]| {
                let edge = |(name, edge): (String, u8)| {
                    let patch = name.parse().map_err(|_| SutureError::Unsuitable {
                        what: format!("--gap {name}:{edge}: patches of a surface file are named by number"),
                    })?;
                    Ok::<_, SutureError>(EdgeRef { patch: PatchId(patch), edge: edge.into() })
                };
                Ok::<_, SutureError>(Gap::between(surface, edge(a)?, edge(b)?)?)
            };
            *gaps = Some(pairs.into_iter().map(gap).collect::<Result<_, _>>()?);
        }
    }
    Ok(())
}

impl Smoothness {
    fn order(self) -> Order {
        match self {
            Self::C0 => Order::C0,
            Self::C1 => Order::C1,
            Self::C2 => Order::C2,
            Self::C3 => Order::C3,
            Self::G1 => Order::G1,
            Self::G2 => Order::G2,
        }
    }
}

impl Blend {
    fn family(self) -> Family {
        match self {
            Self::Polynomial => Family::Polynomial,
            Self::Trigonometric => Family::Trigonometric,
            Self::Rational => Family::Rational,
            Self::SymmetricRational => Family::SymmetricRational,
        }
    }
}
