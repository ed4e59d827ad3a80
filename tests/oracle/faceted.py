"""Writes a mesh as it is commonly brought to CAD, one plane face per triangle, and reads it with OpenCASCADE.

`faceted.py MESH [OUT.step]` prints triangles, MB and seconds to read, to be put beside what `suture` writes for the same mesh.
"""

import sys
import tempfile
from pathlib import Path

import numpy as np
import trimesh

from check_step import of_kind, read
from OCP.TopAbs import TopAbs_FACE

HEAD = """ISO-10303-21;
HEADER;
FILE_DESCRIPTION(('faceted'),'2;1');
FILE_NAME('faceted','1970-01-01T00:00:00',(''),(''),'','','');
FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));
ENDSEC;
DATA;
"""


def faceted(mesh):
    """The text of a STEP file with a plane face for every triangle, edges and vertices shared."""
    lines = []

    def add(text):
        lines.append(f"#{len(lines) + 1}={text};")
        return f"#{len(lines)}"

    triple = lambda p: "({})".format(",".join(f"{x!r}".upper() if "e" not in f"{x!r}" or "." in f"{x!r}" else f"{x!r}".upper().replace("E", ".E") for x in map(float, p)))
    points = [add(f"CARTESIAN_POINT('',{triple(p)})") for p in mesh.vertices]
    vertices = [add(f"VERTEX_POINT('',{p})") for p in points]
    edges, faces = {}, []
    for triangle in mesh.faces:
        corners = mesh.vertices[triangle]
        normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        if not np.linalg.norm(normal) > 0:
            continue
        oriented = []
        for a, b in zip(triangle, np.roll(triangle, -1)):
            key = (min(a, b), max(a, b))
            if key not in edges:
                d = mesh.vertices[key[1]] - mesh.vertices[key[0]]
                length = float(np.linalg.norm(d))
                direction = add(f"DIRECTION('',{triple(d / length)})")
                line = add(f"LINE('',{points[key[0]]},{add(f'VECTOR({chr(39) * 2},{direction},1.)')})")
                edges[key] = add(f"EDGE_CURVE('',{vertices[key[0]]},{vertices[key[1]]},{line},.T.)")
            oriented.append(add(f"ORIENTED_EDGE('',*,*,{edges[key]},{'.T.' if a < b else '.F.'})"))
        axis = add(f"DIRECTION('',{triple(normal / np.linalg.norm(normal))})")
        side = corners[1] - corners[0]
        side = add(f"DIRECTION('',{triple(side / np.linalg.norm(side))})")
        plane = add(f"PLANE('',{add(f'AXIS2_PLACEMENT_3D({chr(39) * 2},{points[triangle[0]]},{axis},{side})')})")
        loop = add(f"EDGE_LOOP('',({','.join(oriented)}))")
        faces.append(add(f"ADVANCED_FACE('',({add(f'FACE_OUTER_BOUND({chr(39) * 2},{loop},.T.)')}),{plane},.T.)"))
    shell = add(f"CLOSED_SHELL('',({','.join(faces)}))")
    solid = add(f"MANIFOLD_SOLID_BREP('',{shell})")
    length = add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))")
    angle = add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))")
    solid_angle = add("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())")
    uncertainty = add(f"UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-7),{length},'distance_accuracy_value','')")
    context = add(
        f"(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT(({uncertainty}))"
        f"GLOBAL_UNIT_ASSIGNED_CONTEXT(({length},{angle},{solid_angle}))REPRESENTATION_CONTEXT('',''))"
    )
    shape = add(f"ADVANCED_BREP_SHAPE_REPRESENTATION('',({solid}),{context})")
    application = add("APPLICATION_CONTEXT('')")
    product = add(f"PRODUCT('','','',({add(f'PRODUCT_CONTEXT({chr(39) * 2},{application},{chr(39) * 2})')}))")
    formation = add(f"PRODUCT_DEFINITION_FORMATION('','',{product})")
    context = add(f"PRODUCT_DEFINITION_CONTEXT('part definition',{application},'design')")
    definition = add(f"PRODUCT_DEFINITION('design','',{formation},{context})")
    add(f"SHAPE_DEFINITION_REPRESENTATION({add(f'PRODUCT_DEFINITION_SHAPE({chr(39) * 2},{chr(39) * 2},{definition})')},{shape})")
    return HEAD + "\n".join(lines) + "\nENDSEC;\nEND-ISO-10303-21;\n"


def main(path, out=None):
    mesh = trimesh.load(path, force="mesh", process=False)
    with tempfile.TemporaryDirectory() as folder:
        out = Path(out or Path(folder) / "faceted.step")
        out.write_text(faceted(mesh), encoding="ascii")
        shape, seconds = read(out)
        faces = len(of_kind(shape, TopAbs_FACE))
        print(f"{faces} | {out.stat().st_size / 1e6:.2f} | {seconds:.2f}", flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
