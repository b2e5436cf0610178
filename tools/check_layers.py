#!/usr/bin/env python3
"""Holds the layers of src/tactum apart:  tools/check_layers.py [ROOT]

A file includes only its own layer and those to the left of it; the device branch (devices, drivers, loop) and the geometry
branch meet first in response. Inside a layer, where x.h and x.cpp are one unit, includes have no cycle.
A folder holds at most 25 headers. Nothing inside includes the umbrella tactum.h. The folder of every layer has a
README.md with a caption for each header (`pose.h`, or `pose` for header and source).
"""
import pathlib
import re
import sys

# Layer -> the layers it stands on directly. CMakeLists.txt says the same to the linker.
STANDS_ON = {
    "base": [],
    "math": ["base"],
    "devices": ["math"],
    "drivers": ["devices"],
    "loop": ["devices"],
    "geometry": ["math"],
    "repair": ["geometry"],
    "mesh": ["repair"],
    "parts": ["geometry"],
    "surface": ["geometry"],
    "referee": ["geometry"],
    "collision": ["geometry"],
    "contact": ["collision", "surface"],
    "dynamics": ["geometry"],
    "response": ["contact", "dynamics", "loop"],
    "haptics": ["response"],
    "scene": ["haptics", "mesh", "parts"],
    "import": ["scene"],
    "telemetry": ["haptics"],
    "session": ["scene", "telemetry", "drivers"],
    "recording": ["session"],
    "embedding": ["session"],
}
MOST_HEADERS = 25
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


def inner_includes(files, layer):
    """Unit -> the other units of the layer that its header or source includes. A unit is a file's name without ending."""
    units = {file.stem for file in files}
    arrows = {unit: set() for unit in units}
    for file in files:
        for match in INCLUDE.finditer(file.read_text()):
            path = pathlib.PurePosixPath(match.group(1))
            if path.parts[:2] == ("tactum", layer) and path.stem in units and path.stem != file.stem:
                arrows[file.stem].add(path.stem)
    return arrows


def shortest_cycle(arrows, start):
    """From `start` along the arrows back to it, as a list that begins and ends with it; None where there is no way."""
    came_from = {}
    queue = [start]
    for unit in queue:
        for following in sorted(arrows[unit]):
            if following == start:
                path = [start]
                while unit != start:
                    path.append(unit)
                    unit = came_from[unit]
                return [start, *reversed(path)]
            if following not in came_from:
                came_from[following] = unit
                queue.append(following)
    return None


def cycles(files, layer):
    """A shortest cycle for each unit that is in one."""
    arrows = inner_includes(files, layer)
    found = {unit: shortest_cycle(arrows, unit) for unit in sorted(arrows)}
    return {unit: cycle for unit, cycle in found.items() if cycle}


def cycle_faults(files, layer):
    """A sentence for each cycle of units of a layer that is not known."""
    told = set()
    for unit, cycle in cycles(files, layer).items():
        if unit not in told:
            yield f"src/tactum/{layer}: include cycle: {' -> '.join(cycle)}"
            told |= set(cycle)


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
        yield from cycle_faults(files, folder.name)
        headers = [file for file in files if file.suffix == ".h"]
        if len(headers) > MOST_HEADERS:
            yield f"src/tactum/{folder.name}: {len(headers)} headers, more than {MOST_HEADERS}; make it two layers"
        for header in headers:
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
