//! C¹ implicit surfaces over triangle meshes with normals.
#![forbid(unsafe_code)]
