"""Reads STEP files with OpenCASCADE and compares what it finds with what was reported (step_*.json, see README.md).

`check_step.py FOLDER` checks every step_*.json of a folder. `check_step.py FILE.step REPORT.json [MESH]` checks one file with the report
that `suture … -o FILE.step --json REPORT.json` wrote, and prints a row of a table.

Reading heals, so that "valid" alone proves little: gaps between the two parameter curves of an edge, tolerances, angles and curvatures
are measured on OpenCASCADE's own evaluation.
"""

import json
import sys
import time
from pathlib import Path

import numpy as np
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve, BRepAdaptor_Curve2d, BRepAdaptor_Surface
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.collections import (
    IndexedDataMap_TopoDS_Shape_List_TopoDS_Shape_TopTools_ShapeMapHasher as Ancestors,
)
from OCP.GProp import GProp_GProps
from OCP.gp import gp_Pnt, gp_Vec
from OCP.IFSelect import IFSelect_RetDone
from OCP.Message import Message
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import (
    TopAbs_EDGE,
    TopAbs_FACE,
    TopAbs_REVERSED,
    TopAbs_SHELL,
    TopAbs_SOLID,
    TopAbs_VERTEX,
)
from OCP.TopExp import TopExp, TopExp_Explorer
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS

from common import main

# Samples along an edge: kinks sit where knot lines end on it, between the nodes of a coarse sampling.
SAMPLES = 101
# Curvature below which a jump is not related to the curvature itself, times the diagonal.
FLAT = 0.1
# Relative difference of volume and area from a tessellation, which has an error of about half of this.
VOLUME = 2e-4
# Millimetres, in which OpenCASCADE reads everything, per unit of the file.
UNITS = {"um": 1e-3, "mm": 1.0, "cm": 10.0, "m": 1000.0}


def read(path):
    """The shape in a STEP file and the seconds that reading took."""
    # Its messages would go to standard output.
    messenger = Message.DefaultMessenger_s()
    messenger.ChangePrinters().Clear() if hasattr(messenger, "ChangePrinters") else None
    start = time.time()
    reader = STEPControl_Reader()
    if reader.ReadFile(str(path)) != IFSelect_RetDone:
        raise ValueError("OpenCASCADE does not read the file")
    reader.TransferRoots()
    return reader.OneShape(), time.time() - start


def of_kind(shape, kind):
    """Distinct parts of a kind."""
    parts = Ancestors()
    TopExp.MapShapesAndAncestors_s(shape, kind, TopAbs_SOLID, parts)
    return [parts.FindKey(i) for i in range(1, parts.Extent() + 1)]


class Jets:
    """Value and derivatives of a face, outward normal included."""

    def __init__(self, face):
        self.surface = BRepAdaptor_Surface(face, False)
        self.sign = -1.0 if face.Orientation() == TopAbs_REVERSED else 1.0
        self.parts = [gp_Pnt()] + [gp_Vec() for _ in range(5)]

    def __call__(self, u, v):
        self.surface.D2(u, v, *self.parts)
        return [(x.X(), x.Y(), x.Z()) for x in self.parts]


def shape_operators(jets, sign, x, y):
    """Normals, and shape operators in the tangent directions x and y, of an array of jets (n, 6, 3)."""
    p, du, dv, duu, dvv, duv = np.moveaxis(jets, 1, 0)
    n = np.cross(du, dv)
    n = sign * n / np.linalg.norm(n, axis=1, keepdims=True)
    dot = lambda a, b: np.einsum("ij,ij->i", a, b)
    second = np.array([[dot(duu, n), dot(duv, n)], [dot(duv, n), dot(dvv, n)]]).transpose(2, 0, 1)
    if x is None:
        x = du / np.linalg.norm(du, axis=1, keepdims=True)
        y = np.cross(n, x)
    first = np.array([[dot(du, x), dot(dv, x)], [dot(du, y), dot(dv, y)]]).transpose(2, 0, 1)
    inverse = np.linalg.inv(first)
    return n, inverse.transpose(0, 2, 1) @ second @ inverse, x, y


def along_edges(shape, diagonal):
    """Worst gap, angle and relative jump of curvature over all edges, and edges without two faces."""
    uses = Ancestors()
    TopExp.MapShapesAndUniqueAncestors_s(shape, TopAbs_EDGE, TopAbs_FACE, uses)
    gap = angle = curvature = 0.0
    free = 0
    jets_of = {}
    for i in range(1, uses.Extent() + 1):
        edge = TopoDS.Edge(uses.FindKey(i))
        faces = [TopoDS.Face(f) for f in uses.FindFromIndex(i)]
        if BRep_Tool.Degenerated_s(edge):
            continue
        free += len(faces) != 2
        sides, curve = [], BRepAdaptor_Curve(edge)
        first, last = curve.FirstParameter(), curve.LastParameter()
        inner = (np.arange(SAMPLES) + 0.5) / SAMPLES
        ends = np.array([1e-6, 1e-4, 1e-3, 1e-2])
        t = first + (last - first) * np.concatenate([inner, ends, 1 - ends])
        space = np.array([(p.X(), p.Y(), p.Z()) for p in map(curve.Value, t)])
        for face in faces:
            key = face.HashCode(2**31 - 1) if hasattr(face, "HashCode") else hash(face)
            jet = jets_of.setdefault((key, face.Orientation()), Jets(face))
            plane = BRepAdaptor_Curve2d(edge, face)
            at = [plane.Value(s) for s in t]
            found = np.array([jet(p.X(), p.Y()) for p in at])
            sides.append((found, jet.sign))
            gap = max(gap, np.linalg.norm(found[:, 0] - space, axis=1).max())
        if len(sides) != 2:
            continue
        (a, sa), (b, sb) = sides
        gap = max(gap, np.linalg.norm(a[:, 0] - b[:, 0], axis=1).max())
        with np.errstate(all="ignore"):
            try:
                m, s, x, y = shape_operators(a, sa, None, None)
                n, r, _, _ = shape_operators(b, sb, x, y)
            except np.linalg.LinAlgError:
                continue
            cross = np.linalg.norm(np.cross(m, n), axis=1)
            angles = np.degrees(np.arctan2(cross, np.einsum("ij,ij->i", m, n)))
            norm = lambda w: np.abs(np.linalg.eigvalsh(0.5 * (w + w.transpose(0, 2, 1)))).max(axis=1)
            finite = np.isfinite(s).all(axis=(1, 2)) & np.isfinite(r).all(axis=(1, 2))
            s, r = s[finite], r[finite]
            jumps = norm(s - r) / np.maximum(np.maximum(norm(s), norm(r)), FLAT / diagonal)
        if len(jumps):
            angle, curvature = max(angle, np.nanmax(angles[finite])), max(curvature, jumps.max())
    return gap, angle, curvature, free


def properties(shape, deflection):
    """Exact volume and area, and those of OpenCASCADE's own tessellation with its triangles."""
    volume, area = GProp_GProps(), GProp_GProps()
    # Without a tolerance the integrals over trimmed faces are off by some 1e-4.
    BRepGProp.VolumeProperties_s(shape, volume, 1e-5, False, False)
    BRepGProp.SurfaceProperties_s(shape, area, 1e-5, False)
    BRepMesh_IncrementalMesh(shape, deflection, False, 0.3, True)
    points, triangles, base = [], [], 0
    parameters, jets, owner = [], [], []
    explorer = TopExp_Explorer(shape, TopAbs_FACE)
    while explorer.More():
        face = TopoDS.Face(explorer.Current())
        mesh = BRep_Tool.Triangulation_s(face, TopLoc_Location())
        if mesh is None:
            raise ValueError("OpenCASCADE does not tessellate a face")
        points += [(p.X(), p.Y(), p.Z()) for p in (mesh.Node(i) for i in range(1, mesh.NbNodes() + 1))]
        found = np.array([mesh.Triangle(i).Get() for i in range(1, mesh.NbTriangles() + 1)]).reshape(-1, 3) - 1
        if face.Orientation() == TopAbs_REVERSED:
            found = found[:, ::-1]
        triangles.append(found + base)
        parameters += [(p.X(), p.Y()) for p in (mesh.UVNode(i) for i in range(1, mesh.NbNodes() + 1))]
        owner += [len(jets)] * len(found)
        jets.append(Jets(face))
        base = len(points)
        explorer.Next()
    feet = (np.array(parameters), jets, owner)
    return volume.Mass(), area.Mass(), np.array(points), np.concatenate(triangles), feet


def measure(path, unit=1.0, diagonal=None, fine=1e-4):
    """Everything about a file; lengths in its own units."""
    shape, seconds = read(path)
    counts = {name: len(of_kind(shape, kind)) for name, kind in [("faces", TopAbs_FACE), ("edges", TopAbs_EDGE), ("vertices", TopAbs_VERTEX), ("shells", TopAbs_SHELL), ("solids", TopAbs_SOLID)]}
    tolerance = max([BRep_Tool.Tolerance_s(TopoDS.Edge(e)) for e in of_kind(shape, TopAbs_EDGE)], default=0.0)
    valid = BRepCheck_Analyzer(shape).IsValid()
    gap, angle, curvature, free = along_edges(shape, diagonal * unit)
    volume, area, points, triangles, feet = properties(shape, fine * diagonal * unit)
    points = points / unit
    a, b, c = (points[triangles[:, k]] for k in range(3))
    return {
        **counts,
        "valid": bool(valid),
        "free": int(free),
        "euler": counts["vertices"] - counts["edges"] + counts["faces"],
        "read": seconds,
        "tolerance": tolerance / unit / diagonal,
        "gap": gap / unit / diagonal,
        "angle": angle,
        "curvature": curvature,
        "volume": volume / unit**3,
        "area": area / unit**2,
        "deflection": fine * diagonal,
        "mesh_volume": float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6),
        "points": points,
        "triangles": triangles,
        "feet": feet,
        "unit": unit,
    }


def distances(found, points):
    """Distances of points from OpenCASCADE's faces: nearest points of its tessellation, made exact by Newton's method."""
    import igl

    points = np.ascontiguousarray(points, dtype=float)
    triangles = found["triangles"].astype(np.int64)
    squared, nearest, foot = igl.point_mesh_squared_distance(points, found["points"], triangles)
    parameters, jets, owner = found["feet"]
    out = np.sqrt(squared)
    for i, (p, t, q) in enumerate(zip(points, nearest, foot)):
        corners = found["points"][triangles[t]]
        weights = np.linalg.lstsq(np.vstack([corners.T, np.ones(3)]), np.append(q, 1.0), rcond=None)[0]
        u, v = weights @ parameters[triangles[t]]
        jet = jets[owner[t]]
        for _ in range(4):
            x, du, dv, *_ = (np.array(d) / found["unit"] for d in jet(u, v))
            (a, b), *_ = np.linalg.lstsq(np.array([du, dv]).T, p - x, rcond=None)
            u, v = u + a, v + b
        # A foot beyond the border of its face is no nearer than the border, but for rounding.
        x = np.array(jet(u, v)[0]) / found["unit"]
        out[i] = min(out[i], np.linalg.norm(p - x))
    return out


def deviation(found, mesh):
    """Root mean square and largest distance of the vertices of a mesh from OpenCASCADE's faces."""
    import trimesh

    all = distances(found, trimesh.load(mesh, force="mesh", process=False).vertices)
    return float(np.sqrt((all**2).mean())), float(all.max())


def check(path, data):
    """One step_*.json: the file, the counts, the limits."""
    diagonal = data["diagonal"]
    found = measure(path.parent / data["file"], UNITS[data.get("unit", "mm")], diagonal)
    yield "valid: misses", 0 if found["valid"] else 1, 0
    for what in ["faces", "edges", "vertices", "solids", "euler"]:
        yield f"{what} {data[what]}, found {found[what]}: difference", abs(data[what] - found[what]), 0
    yield "edges without two faces", abs(found["free"] - data.get("open_edges", 0)), 0
    # Edges that OpenCASCADE found no better than this it was told; its own floor is 1e-7 mm.
    floor = 1e-7 / UNITS[data.get("unit", "mm")] / diagonal
    yield "tolerance / diagonal", found["tolerance"], max(data["limit"], floor * 1.01)
    yield "gap / diagonal", found["gap"], data["limit"]
    if "angle_limit" in data:
        yield "angle in degrees", found["angle"], data["angle_limit"]
        yield "curvature jump", found["curvature"], data["curvature_limit"]
    if data.get("points"):
        worst = distances(found, data["points"]).max() / diagonal
        yield f"{len(data['points'])} points of the surface / diagonal", worst, data["limit"]
    if data.get("volume") is not None:
        yield "volume, relative", abs(found["volume"] / data["volume"] - 1), data.get("volume_limit", VOLUME)
    yield "area, relative", abs(found["area"] / data["area"] - 1), data.get("volume_limit", VOLUME)


# What a row must keep where nothing else was asked for: degrees, jump of curvature (rough fits), relative difference of deviations.
ANGLE, CURVATURE, DEVIATION = 0.01, 0.02, 0.02


def beyond(found, told, report, diagonal):
    """What is not as it must be."""
    unit, limit = found["unit"], report.get("settings", {}).get("cad_tolerance", 1e-6)
    genus = (report.get("tessellation") or {}).get("genus")
    closed = told["open_edges"] == 0
    if not found["valid"]:
        yield "invalid"
    if any(found[k] != told[k] for k in ["faces", "edges", "vertices"]):
        yield "counts"
    if closed and (found["solids"] != told["shells"] or found["free"] != 0):
        yield "open"
    if closed and genus is not None and found["euler"] != 2 - 2 * genus:
        yield "genus"
    # Its own floor is 1e-7 mm.
    if found["tolerance"] > max(limit, 1.01e-7 / unit / diagonal):
        yield "tolerance"
    if not found["gap"] <= limit:
        yield "gap"
    if not found["angle"] <= ANGLE:
        yield "angle"
    if not found["curvature"] <= CURVATURE:
        yield "curvature"
    # A tessellation lies within its deflection of the faces.
    if closed and abs(found["volume"] - found["mesh_volume"]) > found["area"] * found["deflection"]:
        yield "volume"


def one(step, report, mesh=None):
    """Checks one file against the report of the command that wrote it; prints a row."""
    report = json.loads(Path(report).read_text(encoding="utf-8"))
    told, unit = report["step"], UNITS[report.get("settings", {}).get("unit", "mm")]
    diagonal = told["diagonal"]
    found = measure(step, unit, diagonal, fine=2e-5 if mesh else 1e-4)
    bad = list(beyond(found, told, report, diagonal))
    last = []
    if mesh:
        mine = deviation(found, mesh)
        last = [f"{100 * x / diagonal:.4f}" for x in mine]
        if report.get("deviation"):
            there = report["deviation"]["mesh_to_surface"]
            theirs = [there["rms"], there["max"]]
            last += [f"{100 * x:.4f}" for x in theirs]
            if any(abs(x / diagonal - y) > DEVIATION * y + 1e-6 for x, y in zip(mine, theirs)):
                bad.append("deviation")
    row = [
        Path(step).stem,
        "BAD: " + ", ".join(bad) if bad else "ok",
        f"{found['faces']}/{found['edges']}/{found['vertices']}",
        f"{found['solids']}",
        f"{Path(step).stat().st_size / 1e6:.2f}",
        f"{found['read']:.2f}",
        f"{found['tolerance']:.1e}",
        f"{found['gap']:.1e}",
        f"{found['angle']:.4f}",
        f"{100 * found['curvature']:.2f}",
        f"{found['volume']:.6g}",
        f"{found['volume'] / found['mesh_volume'] - 1:.1e}",
        f"{found['area']:.6g}",
    ]
    print(" | ".join(row + last), flush=True)
    return not bad


if __name__ == "__main__":
    if len(sys.argv) > 2:
        sys.exit(not one(*sys.argv[1:]))
    main("step_*.json", check)
