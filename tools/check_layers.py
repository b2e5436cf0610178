#!/usr/bin/env python3
"""Holds the layers of src/tactum apart:  tools/check_layers.py [ROOT]

A file includes only its own layer and those to the left of it; the device branch (devices, loop) and the geometry branch meet first in haptics.
Nothing inside includes the umbrella tactum.h. The folder of every layer has a README.md with a caption for each header
(`pose.h`, or `pose` for header and source).
"""
import pathlib
import re
import sys

# Layer -> the layers it stands on directly. CMakeLists.txt says the same to the linker.
STANDS_ON = {
    "base": [],
    "math": ["base"],
    "devices": ["math"],
    "loop": ["devices"],
    "geometry": ["math"],
    "mesh": ["geometry"],
    "parts": ["geometry"],
    "surface": ["geometry"],
    "collision": ["geometry"],
    "contact": ["collision", "surface"],
    "dynamics": ["geometry"],
    "haptics": ["contact", "dynamics", "loop"],
    "scene": ["haptics", "mesh", "parts"],
    "telemetry": ["haptics"],
    "session": ["scene", "telemetry"],
}
INCLUDE = re.compile(r'^\s*#\s*include\s*["<]([^">]+)[">]', re.MULTILINE)


def reachable(layer):
    """The layer and all it stands on, directly or not."""
    layers = {layer}
    for below in STANDS_ON[layer]:
        layers |= reachable(below)
    return layers


def include_faults(source, path):
    """Sentences about the includes of one file; `path` is relative to src/tactum."""
    layer = path.parts[0]
    allowed = reachable(layer)
    for match in INCLUDE.finditer(source):
        name = match.group(1)
        parts = pathlib.PurePosixPath(name).parts
        line = source.count("\n", 0, match.start(1)) + 1
        place = f"src/tactum/{path}:{line}"
        if parts[0] != "tactum":
            if ".." in parts or parts[0] in STANDS_ON:
                yield f'{place}: includes "{name}"; write it from the root: "tactum/..."'
        elif len(parts) == 2:
            yield f"{place}: includes the umbrella {name}, which is for outsiders only"
        elif parts[1] not in STANDS_ON:
            yield f"{place}: includes {name}, of a layer nobody knows"
        elif parts[1] not in allowed:
            yield f"{place}: {layer} includes {name}, but may only see {', '.join(sorted(allowed))}"


def faults(root):
    """Everything that is wrong under `root`, a sentence each."""
    source_root = root / "src/tactum"
    for folder in sorted(path for path in source_root.iterdir() if path.is_dir()):
        if folder.name not in STANDS_ON:
            yield f"src/tactum/{folder.name}: a layer nobody knows; its place belongs into tools/check_layers.py"
            continue
        files = sorted(path for path in folder.rglob("*") if path.suffix in (".h", ".cpp"))
        for file in files:
            yield from include_faults(file.read_text(), file.relative_to(source_root))
        readme = folder / "README.md"
        text = readme.read_text() if readme.exists() else ""
        if not text:
            yield f"src/tactum/{folder.name}/README.md: missing; it says what the layer is for"
        for header in (file for file in files if file.suffix == ".h"):
            if text and f"`{header.name}`" not in text and f"`{header.stem}`" not in text:
                yield f"src/tactum/{folder.name}/README.md: no caption for `{header.name}`"


def main(arguments):
    root = pathlib.Path(arguments[0] if arguments else pathlib.Path(__file__).parent.parent).resolve()
    found = list(faults(root))
    for fault in found:
        print(fault)
    print(f"layers: {len(found)} faults")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
