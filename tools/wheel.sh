#!/usr/bin/env bash
# Makes the wheel of the Python module with pip and setuptools, and installs it in a fresh virtual environment without
# network; there the tests of the module's wheel run: the version, a wrench, the files that types need.
#
# The wheel is linked with this machine's Qhull, assimp, zstd and fmt, so it is one for this kind of machine. numpy
# comes from the system (--system-site-packages), for a virtual environment cannot fetch it without network.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
python=/usr/bin/python3
wheels="$root/build/package/wheel"
mkdir -p "$root/build/package"
rm -rf "$wheels" "$root/build/package/wheel-build"
"$python" -m pip wheel --quiet --no-index --no-deps --no-build-isolation --wheel-dir "$wheels" "$root/python"
ls -sh "$wheels"

fresh="$(mktemp -d)"
trap 'rm -rf "$fresh"' EXIT
"$python" -m venv --system-site-packages "$fresh/venv"
"$fresh/venv/bin/pip" install --quiet --no-index "$wheels"/tactum-*.whl
cd "$fresh"
# -P and no PYTHONPATH: the module comes from the environment, not from the build.
env -u PYTHONPATH "$fresh/venv/bin/python" -P - "$fresh" <<'PYTHON'
import importlib.metadata
import pathlib
import sys

import tactum

folder = pathlib.Path(tactum.__file__).parent
assert str(folder).startswith(sys.argv[1]), folder
assert importlib.metadata.version("tactum") == tactum.__version__, tactum.__version__
assert (folder / "py.typed").exists() and (folder / "__init__.pyi").exists()
sim = tactum.open("block-on-plate")
for i in range(1500):
    wrench, contacts = sim.step(tactum.pose((0, 0, -1e-5 * i)))
assert wrench[2] > 1.0 and len(contacts) >= 3, (wrench, contacts)
print(f"tactum {tactum.__version__} of the wheel pushes with {wrench[2]:.3f} N")
PYTHON
