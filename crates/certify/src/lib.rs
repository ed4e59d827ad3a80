//! certify

#![forbid(unsafe_code)]

mod certificate;
mod deviation;
mod error;
mod foot;
mod nearest;
mod options;
mod region;
mod samples;
mod seam;
mod shape;

pub use certificate::{Certificate, PatchReport, Worst, certify};
pub use deviation::{Deviation, KindDeviation, Place, Stats, deviation};
pub use error::CertifyError;
pub use options::{CertifyOptions, Limits};
pub use samples::SurfaceSamples;
pub use seam::{BlindSpot, Jump, SeamReport, Unmeasured};
