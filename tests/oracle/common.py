"""What the checks share: finding the files, telling the results, and the exit code."""

import json
import sys
from pathlib import Path


def main(pattern, check):
    """Runs `check(path, data)` on every file of the folder named on the command line that matches `pattern`.

    `check` yields `(what, measured, limit)`; a file passes when every `measured <= limit` (NaN does not). Ends with exit code 1
    when a file fails, cannot be read, or there is none: a comparison that compared nothing is no comparison.
    """
    if len(sys.argv) != 2:
        sys.exit(f"usage: {sys.argv[0]} FOLDER")
    paths = sorted(Path(sys.argv[1]).glob(pattern))
    failures = 0
    for path in paths:
        try:
            results = list(check(path, json.loads(path.read_text(encoding="utf-8"))))
            good = bool(results) and all(measured <= limit for _, measured, limit in results)
            told = ", ".join(f"{what} {measured:.3g} (limit {limit:.3g})" for what, measured, limit in results)
        except Exception as e:  # A broken file must not hide the others.
            good, told = False, f"{type(e).__name__}: {e}"
        failures += not good
        print(f"{'ok  ' if good else 'FAIL'} {path.name}: {told}", flush=True)
    print(f"{pattern}: {len(paths) - failures} of {len(paths)} passed", flush=True)
    if not paths:
        print(f"no file {pattern} in {sys.argv[1]}", file=sys.stderr)
    sys.exit(failures > 0 or not paths)
