#!/usr/bin/env bash
# Reconstructs meshes, writes STEP files and checks them with OpenCASCADE: step_all.sh DATA OUT [NAME …], DATA with good/ and paper/.
# Prints a table; its last three columns are of a STEP file with one plane per triangle. With FACETED=no they are left out.
# Wants target/release/suture and the environment that `cargo xtask oracle` makes. Files that are in OUT already are not made again.
set -uo pipefail
data=${1:?folder with good/ and paper/} out=${2:?folder for results}
shift 2
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
suture=${SUTURE:-$here/../../target/release/suture} python=${PYTHON:-$here/.venv/bin/python}
mkdir -p "$out"
if [ $# = 0 ]; then
    set -- sphere_320 deformed_tetrahedron deformed_octahedron cylinder_2736 l_shape torus_2304 \
        sphere torus blobby spot fish hand cow knot1 eight wingnut fandisk elephant anchor_dense
fi
bad=0
for name in "$@"; do
    mesh=$(ls "$data"/{paper,good}/"$name".{obj,off,ply} 2>/dev/null | head -n 1)
    labels=()
    [ -e "$data/paper/$name.labels" ] && labels=(--labels "$data/paper/$name.labels")
    [ -e "$out/$name.step" ] || "$suture" reconstruct -q "$mesh" "${labels[@]}" -o "$out/$name.step" --json "$out/$name.json" ||
        { echo "$name | FAILED"; bad=1; continue; }
    row=$("$python" "$here/check_step.py" "$out/$name.step" "$out/$name.json" "$mesh") || bad=1
    [ "${FACETED:-yes}" = no ] || row="$row | $("$python" "$here/faceted.py" "$mesh")"
    echo "$row"
done
exit $bad
