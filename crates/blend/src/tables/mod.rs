//! Generated tables: written by `cargo xtask codegen`, do not edit.

pub(crate) mod n_blend;
