//! Bubble splines: G⁰, G¹ and G² surfaces, one patch per triangle or quad.
#![forbid(unsafe_code)]
