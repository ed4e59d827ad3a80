//! Counts that lie must not be believed by the allocator.
//!
//! In a binary of its own, for it looks at the address space of the whole process.
#![cfg(target_os = "linux")]

use std::fs;

use suture_mesh::io::{self, MeshFormat};

/// Largest address space so far, in bytes; counts what was reserved even if it was never touched.
fn peak() -> usize {
    let status = fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find(|line| line.starts_with("VmPeak:")).unwrap();
    line.split_whitespace().nth(1).unwrap().parse::<usize>().unwrap() * 1024
}

#[test]
fn lying_counts_reserve_nothing() {
    let mut stl = vec![0; 84 + 50];
    stl[80..84].fill(0xff);
    let ply = |encoding: &str| {
        let header = "element vertex 99999999999\nproperty float x\nproperty float y\nproperty float z\n\
                      element face 99999999999\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n";
        format!("ply\nformat {encoding} 1.0\n{header}").into_bytes()
    };
    let cases = [
        (MeshFormat::Stl, stl),
        (MeshFormat::Ply, ply("ascii")),
        (MeshFormat::Ply, ply("binary_little_endian")),
        (MeshFormat::Off, b"OFF\n4000000000 4000000000 0\n0 0 0\n".to_vec()),
        (MeshFormat::Off, b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n4000000000 0 1 2\n".to_vec()),
    ];
    let before = peak();
    for (format, bytes) in cases {
        assert!(io::read_from(&bytes, format).is_err());
    }
    let grown = peak() - before;
    assert!(grown < 64 << 20, "{grown} bytes");
}
