"""Compares meshes, as written to files, with what trimesh reads in them (mesh_*.json, see README.md)."""

import numpy as np
import trimesh

from common import main

# Formats that hold 32-bit floats.
SINGLE = {".stl", ".glb", ".gltf"}


def check(path, data):
    file = path.parent / data["file"]
    # An STL has no shared vertices: there, and only there, trimesh joins equal ones.
    mesh = trimesh.load(file, force="mesh", process=file.suffix == ".stl")
    for what, found in [
        ("vertices", len(mesh.vertices)),
        ("faces", len(mesh.faces)),
        ("euler", mesh.euler_number),
    ]:
        yield f"{what} {data[what]}, found {found}: difference", abs(data[what] - found), 0
    limit = 1e-5 if file.suffix in SINGLE else 1e-12
    scale = np.linalg.norm(mesh.extents)
    yield "area / diagonal^2", abs(mesh.area - data["area"]) / scale**2, limit
    if mesh.is_watertight:
        yield "volume / diagonal^3", abs(mesh.volume - data["volume"]) / scale**3, limit
    elif data.get("volume") is not None:
        raise ValueError("a volume is given, but the mesh is not watertight for trimesh")


if __name__ == "__main__":
    main("mesh_*.json", check)
