#!/usr/bin/env python3
"""clang-tidy (settings: .clang-tidy) over the program's own sources:  tools/tidy.py BUILD_FOLDER [FILE...]

Without files it checks the last stages before the motors, where a slip moves one, the files of a layer as one, and every
header at once through one generated file; with TACTUM_FULL=1 every source of src/, app/ and viewer/server/, each alone.
"""
import json
import os
import pathlib
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

ROOT = pathlib.Path(__file__).resolve().parent.parent
JOINED = re.compile(r'^#include "([^"]+)"$', re.MULTILINE)
OWN = ("src/", "app/", "viewer/server/")
LAST_STAGES = ("src/tactum/base/", "src/tactum/devices/", "src/tactum/loop/", "src/tactum/haptics/frame", "src/tactum/haptics/show_stage",
               "src/tactum/response/constraint.cpp", "src/tactum/response/energy.cpp")


def each_source(database):
    """The entries of a compilation database with those of joined files taken apart, one for each source."""
    entries = []
    for entry in database:
        joined = pathlib.Path(entry["directory"], entry["file"])
        sources = JOINED.findall(joined.read_text()) if joined.name.startswith("unity_") else [entry["file"]]
        for source in sources:
            entries.append(entry | {"file": source, "command": entry["command"].replace(entry["file"], source)})
    return entries


def chosen_sources(database, full):
    """The files of the compilation database that are to be checked, relative to the root."""
    known = {pathlib.Path(entry["file"]).resolve() for entry in database}
    own = sorted(path.relative_to(ROOT).as_posix() for path in known if path.is_relative_to(ROOT))
    return [path for path in own if path.startswith(OWN if full else LAST_STAGES)]


def join_layers(database, paths, folder):
    """Writes a file for each layer into `folder` that includes those of `paths` in it, adds it to the compilation database
    and returns the new paths: the headers of others, which take most of the time, are then read once a layer."""
    entries = {pathlib.Path(entry["file"]).resolve().relative_to(ROOT).as_posix(): entry for entry in database
               if pathlib.Path(entry["file"]).resolve().is_relative_to(ROOT)}
    joined = []
    for layer in sorted({str(pathlib.Path(path).parent) for path in paths}):
        sources = [path for path in paths if str(pathlib.Path(path).parent) == layer]
        together = folder / f"{pathlib.Path(layer).name}.cpp"
        together.write_text("".join(f'#include "{ROOT / source}"  // NOLINT(bugprone-suspicious-include)\n' for source in sources))
        entry = entries[sources[0]]
        database.append(entry | {"file": str(together), "command": entry["command"].replace(entry["file"], str(together))})
        joined.append(str(together))
    return joined


def check(build, path):
    """Exit code, the path and what clang-tidy said of one file."""
    command = ["clang-tidy", "-p", str(build), "--quiet", "--extra-arg=-Wno-unknown-warning-option", str(ROOT / path)]
    done = subprocess.run(command, capture_output=True, text=True)
    said = done.stdout + (done.stderr if done.returncode and not done.stdout.strip() else "")
    return done.returncode, path, said


def main(arguments):
    if not arguments:
        sys.exit(__doc__)
    build = pathlib.Path(arguments[0]).resolve()
    database = each_source(json.loads((build / "compile_commands.json").read_text()))
    separate = build / "tidy"
    separate.mkdir(exist_ok=True)
    full = os.environ.get("TACTUM_FULL") == "1"
    paths = arguments[1:] or chosen_sources(database, full)
    if not arguments[1:] and not full:
        paths = join_layers(database, paths, separate)
    every_header = build / "tests/headers/every_header.cpp"
    if not arguments[1:] and every_header.exists():
        paths = [str(every_header)] + paths
    (separate / "compile_commands.json").write_text(json.dumps(database))
    workers = len(os.sched_getaffinity(0))
    with ThreadPoolExecutor(workers) as pool:
        results = list(pool.map(lambda path: check(separate, path), paths))
    bad = [result for result in results if result[0] != 0]
    for _, path, said in bad:
        print(f"-- {path}\n{said}")
    print(f"clang-tidy: {len(paths)} files, {len(bad)} with findings")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
