//! The arguments, as documented by `--help`, the man page and the shell completions.

use std::path::PathBuf;

use clap::{Args as ClapArgs, Parser, Subcommand, ValueEnum};
use serde::Serialize;

/// Sew smooth surfaces over triangle meshes, with a measured certificate of every seam.
#[derive(Parser, Debug)]
#[command(
    version,
    about,
    after_help = "Exit codes: 0 good; 1 the result failed its own checks; 2 the arguments or the input are not usable; \
                  3 internal error; 130 interrupted.\nLengths given on the command line are relative to the diagonal of the \
                  mesh's bounding box."
)]
pub(crate) struct Args {
    #[command(subcommand)]
    pub(crate) command: Command,
    #[command(flatten)]
    pub(crate) common: Common,
}

#[derive(Subcommand, Debug)]
pub(crate) enum Command {
    /// Reconstruct a closed triangle mesh as a C² surface of few patches
    Reconstruct(Box<Reconstruct>),
    /// Lay a C¹ implicit surface over a mesh with normals: one A-patch per face and edge
    Apatch(Box<super::apatch::Apatch>),
    /// Lay a G⁰ to G⁴ surface over a mesh with normals: one bubble patch per face
    Bubble(Box<super::bubble::Bubble>),
    /// Fill the gaps and holes between surfaces, C⁰ to C³, G¹ or G²
    Fill(Box<super::fill::Fill>),
    /// Show a saved surface or a mesh: one page for any browser, or a picture
    View(Box<super::view::View>),
    /// Lay the three kinds of surfaces over one mesh and show them side by side with one report
    Compare(Box<super::compare::Compare>),
    /// Cut a closed triangle mesh into disc charts and write their labels
    Segment(super::segment::Segment),
    /// Report every defect of a mesh
    Check(Check),
    /// Measure the seams of a saved surface, and its distance from a mesh
    Certify(Certify),
    /// Write a saved surface in other formats
    Export(Box<Export>),
    /// Print a completion script for a shell
    #[command(hide = true)]
    Completions {
        /// The shell
        shell: clap_complete::Shell,
    },
    /// Print the manual page
    #[command(hide = true)]
    Man,
    /// Print the JSON schema of the report
    #[command(hide = true)]
    Schema,
}

#[derive(ClapArgs, Debug, Clone)]
pub(crate) struct Common {
    /// Print nothing but errors
    #[arg(long, short, global = true)]
    pub(crate) quiet: bool,
    /// Write a report of everything measured
    #[arg(long, global = true, value_name = "FILE")]
    pub(crate) json: Option<PathBuf>,
    /// Number of threads; the result does not depend on it
    #[arg(long, global = true, value_name = "N")]
    pub(crate) threads: Option<usize>,
}

#[derive(ClapArgs, Debug, Serialize)]
pub(crate) struct Reconstruct {
    /// The mesh: .obj, .stl, .ply or .off; without it a built-in shape is taken and everything is written to suture-out/
    #[serde(skip)]
    pub(crate) input: Option<PathBuf>,
    /// Where to write; the extension names the format: .step (CAD), .glb .obj .ply .stl, .json (lossless), .png (picture), .html (page for any browser); may be repeated
    #[arg(long, short, value_name = "FILE")]
    #[serde(skip)]
    pub(crate) output: Vec<PathBuf>,
    /// Repair first what can be repaired safely: weld equal vertices, orient faces, drop isolated vertices and degenerate or duplicate faces
    #[arg(long)]
    pub(crate) repair: bool,
    #[command(flatten)]
    #[serde(flatten)]
    pub(crate) segmentation: Segmentation,
    #[command(flatten)]
    #[serde(flatten)]
    pub(crate) shape: Shape,
    #[command(flatten)]
    #[serde(flatten)]
    pub(crate) cad: Cad,
    #[command(flatten)]
    #[serde(flatten)]
    pub(crate) picture: Picture,
}

/// What CAD files (.step) are like.
#[derive(ClapArgs, Debug, Serialize)]
pub(crate) struct Cad {
    /// Largest distance of the faces of a CAD file from the surface and from each other along edges; knots are refined until it holds
    #[arg(long, value_name = "LENGTH", default_value_t = suture::export::StepOptions::default().tolerance)]
    pub(crate) cad_tolerance: f64,
    /// Unit of the coordinates, as CAD files state it
    #[arg(long, value_enum, default_value_t)]
    pub(crate) unit: Unit,
}

#[derive(ValueEnum, Clone, Copy, Debug, Default, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Unit {
    /// Micrometre
    Um,
    /// Millimetre
    #[default]
    Mm,
    /// Centimetre
    Cm,
    /// Metre
    M,
}

/// Where the segments come from.
#[derive(ClapArgs, Debug, Serialize)]
pub(crate) struct Segmentation {
    /// One label per face of the mesh, one per line
    #[arg(long, value_name = "FILE", conflicts_with_all = ["waypoints", "charts"])]
    pub(crate) labels: Option<PathBuf>,
    /// Paths through vertices, one path of vertex numbers (from 0) per line, joined by shortest paths that prefer creases
    #[arg(long, value_name = "FILE", conflicts_with = "charts")]
    pub(crate) waypoints: Option<PathBuf>,
    /// With --waypoints: exponent of the preference for creases (1 as the paper prints it)
    #[arg(long, value_name = "Q", default_value_t = 1.0, requires = "waypoints")]
    pub(crate) crease_exponent: f64,
    /// Aim for this number of segments
    #[arg(long, value_name = "N")]
    pub(crate) charts: Option<usize>,
}

/// What the surface is to be like.
#[derive(ClapArgs, Debug, Serialize)]
pub(crate) struct Shape {
    /// Lie where the mesh lies, or round its edges
    #[arg(long, value_enum, default_value_t)]
    pub(crate) intent: Intent,
    /// How far blends reach into a segment
    #[arg(long, value_name = "LENGTH")]
    pub(crate) d_in: Option<f64>,
    /// How far blends reach out of a segment
    #[arg(long, value_name = "LENGTH")]
    pub(crate) d_out: Option<f64>,
    /// Shortest strip
    #[arg(long, value_name = "LENGTH")]
    pub(crate) d_min: Option<f64>,
    /// Step along the second differences by which points of arcs are moved
    #[arg(long, value_name = "FACTOR")]
    pub(crate) d_curv: Option<f64>,
    /// How blends find the points that belong together; without it: correspondence for fidelity, paper for fillets
    #[arg(long, value_enum)]
    pub(crate) maps: Option<Maps>,
    /// Root mean square distance from the mesh: segments that miss it are split; given here it also wins against the judgement that the
    /// rest is noise (without it: 0.001)
    #[arg(long, value_name = "LENGTH")]
    pub(crate) tolerance: Option<f64>,
    /// How many times segments may be split that fold, miss the tolerance or cannot be blended; 0 keeps the segmentation as it is
    #[arg(long, value_name = "N", default_value_t = suture::Splits::default().rounds)]
    pub(crate) splits: usize,
    /// Order of the fairness energy: 3, or 2 as in the paper
    #[arg(long, value_name = "ORDER", default_value_t = 3, value_parser = clap::value_parser!(u8).range(2..=3))]
    pub(crate) energy: u8,
    /// Weight of the fairness energy: gcv, floor, floater (as in the paper), or a number
    #[arg(long, value_name = "RULE", default_value = "gcv")]
    pub(crate) smoothing: String,
    /// How segments are flattened
    #[arg(long, value_enum, default_value_t)]
    pub(crate) parameterization: Parameterization,
    /// Let arcs follow the mesh edges, as in the paper, instead of fair curves on the mesh
    #[arg(long)]
    pub(crate) edge_arcs: bool,
    /// Fit the triangles as they are, instead of ironing knife edges and splitting what is coarse for the blends with curved midpoints
    #[arg(long)]
    pub(crate) keep_mesh: bool,
    /// Largest distance of the tessellation's chords from the surface
    #[arg(long, value_name = "LENGTH")]
    pub(crate) chord: Option<f64>,
}

#[derive(ValueEnum, Clone, Copy, Debug, Default, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Intent {
    /// Blends as wide outside as inside a segment
    #[default]
    Fidelity,
    /// Blends twice as wide inside: edges become fillets
    Fillet,
}

#[derive(ValueEnum, Clone, Copy, Debug, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Maps {
    /// Points on one line across the shape
    Correspondence,
    /// Points at equal distances from the arcs in either chart, as in the paper
    Paper,
}

#[derive(ValueEnum, Clone, Copy, Debug, Default, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Parameterization {
    /// Conformal with boundary scale 1, then symmetric Dirichlet where the distortion asks for it
    #[default]
    Recommended,
    /// Least-squares conformal with two pins, as in the paper
    Lscm,
    /// Least-squares conformal without pins
    Spectral,
}

/// How pictures (.png) are drawn and pages (.html) open.
#[derive(ClapArgs, Debug, Serialize)]
pub(crate) struct Picture {
    /// What a picture shows
    #[arg(long, value_enum, default_value_t)]
    pub(crate) shade: Shade,
    /// Camera: degrees around the vertical axis
    #[arg(long, value_name = "DEGREES", allow_hyphen_values = true)]
    pub(crate) azimuth: Option<f64>,
    /// Camera: degrees above the horizon
    #[arg(long, value_name = "DEGREES", allow_hyphen_values = true)]
    pub(crate) elevation: Option<f64>,
    /// The axis that points upwards in pictures
    #[arg(long, value_enum, default_value_t)]
    pub(crate) up: Axis,
    /// Number of bands of light of reflection lines and isophotes
    #[arg(long, value_name = "N", default_value_t = 24)]
    pub(crate) bands: u32,
    /// Width and height of pictures in pixels
    #[arg(long, value_name = "WxH", default_value = "800x600")]
    pub(crate) size: String,
}

#[derive(ValueEnum, Clone, Copy, Debug, Default, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Axis {
    /// The first
    X,
    /// The second
    Y,
    /// The third
    #[default]
    Z,
}

#[derive(ValueEnum, Clone, Copy, Debug, Default, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Shade {
    /// Patches in the colours of the paper
    #[default]
    Patches,
    /// Reflection lines
    Reflection,
    /// Lines of equal angle to the light
    Isophotes,
    /// Mean curvature
    Curvature,
    /// Distance from the input mesh
    Deviation,
    /// One colour
    Lit,
}

#[derive(ClapArgs, Debug)]
pub(crate) struct Check {
    /// The mesh
    pub(crate) input: PathBuf,
    /// Write the mesh after all safe repairs to this file
    #[arg(long, short, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
}

#[derive(ClapArgs, Debug)]
pub(crate) struct Certify {
    /// The surface, as written by `-o NAME.json` of reconstruct, apatch, bubble or fill
    pub(crate) surface: PathBuf,
    /// Also measure the distance from this mesh
    #[arg(long, value_name = "FILE")]
    pub(crate) mesh: Option<PathBuf>,
}

#[derive(ClapArgs, Debug, Serialize)]
pub(crate) struct Export {
    /// The surface, as written by `-o NAME.json`
    #[serde(skip)]
    pub(crate) surface: PathBuf,
    /// Where to write; the extension names the format: .step (CAD), .glb .obj .ply .stl, .json (lossless), .png; may be repeated
    #[arg(long, short, value_name = "FILE", required = true)]
    #[serde(skip)]
    pub(crate) output: Vec<PathBuf>,
    /// Largest distance of the tessellation's chords from the surface
    #[arg(long, value_name = "LENGTH")]
    pub(crate) chord: Option<f64>,
    #[command(flatten)]
    #[serde(flatten)]
    pub(crate) cad: Cad,
    #[command(flatten)]
    #[serde(flatten)]
    pub(crate) picture: Picture,
}
