"""Compares least squares conformal maps with `igl.lscm` (lscm_*.json, see README.md)."""

import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from common import main

LIMIT = 1e-8

# In a process of its own: igl.lscm ends the process on bad input instead of raising an error.
LSCM = """
import sys
import igl
import numpy as np
with np.load(sys.argv[1]) as d:
    uv, _ = igl.lscm(d["vertices"], d["faces"], d["pins"], d["pin_uv"])
np.save(sys.argv[2], uv)
"""


def lscm(vertices, faces, pins, pin_uv):
    with tempfile.TemporaryDirectory() as folder:
        given, found = Path(folder, "given.npz"), Path(folder, "found.npy")
        np.savez(given, vertices=vertices, faces=faces, pins=pins, pin_uv=pin_uv)
        run = subprocess.run([sys.executable, "-c", LSCM, given, found], capture_output=True, text=True, timeout=600)
        if run.returncode != 0 or not found.exists():
            raise RuntimeError(f"igl.lscm ended with {run.returncode}: {run.stderr[-300:]}")
        return np.load(found)


def check(_, data):
    vertices = np.array(data["vertices"], dtype=np.float64)
    faces = np.array(data["faces"], dtype=np.int64)
    pins = np.array(data["pins"], dtype=np.int64)
    pin_uv = np.array(data["pin_uv"], dtype=np.float64)
    uv = np.array(data["uv"], dtype=np.float64)
    if uv.shape != (len(vertices), 2):
        raise ValueError(f"uv is {uv.shape}, expected {(len(vertices), 2)}")
    if len(set(np.ravel(faces))) != len(vertices):
        raise ValueError("a vertex belongs to no face, its uv is not determined")
    want = lscm(vertices, faces, pins, pin_uv)
    diagonal = np.linalg.norm(np.ptp(want, axis=0))
    yield "largest distance / diagonal", np.linalg.norm(uv - want, axis=1).max() / diagonal, LIMIT


if __name__ == "__main__":
    main("lscm_*.json", check)
