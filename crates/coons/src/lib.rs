//! Fills of gaps between surfaces.
#![forbid(unsafe_code)]
