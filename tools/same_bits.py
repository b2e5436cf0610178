#!/usr/bin/env python3
"""Holds that every build computes the same frames, to the last bit:  tools/same_bits.py BUILD BUILD...

The programs of each build folder run, on the virtual clock, the gears once, the first seconds of thirteen moving bodies,
and a heap with less budget than pairs, and name the hash of all their frames. A folder where they were not built is
left out and told, unless TACTUM_ALL_BUILDS=1 says that all must be there. Exit code 77 (skipped) when fewer than two
folders are there to compare.
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile

SKIPPED = 77

RUNS = [
    ("gears", "tactum", ["bench", "table1", "--replays", "1"], lambda told: told["frame_hash"]),
    ("moving-objects", "tactum", ["feel", "moving-objects", "--virtual-clock", "--duration", "2.5"],
     lambda told: told["frame_hash"]),
    ("heap", "tactum-bench", ["schedule", "--bodies", "6", "--seconds", "0.6", "--shares", "0.1", "--replays", "1"],
     lambda told: told["budgets"][0]["frame_hash"]),
]


def frame_hashes(build):
    """The hashes that the programs of a build name, by what was run."""
    hashes = {}
    with tempfile.TemporaryDirectory() as folder:
        for name, program, arguments, read in RUNS:
            report = pathlib.Path(folder) / "report.json"
            command = [str(build / program), *arguments, "--json", str(report)]
            done = subprocess.run(command, capture_output=True, text=True, stdin=subprocess.DEVNULL)
            if done.returncode != 0:
                raise RuntimeError(f"{' '.join(command)}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
            hashes[name] = str(read(json.loads(report.read_text())))
    return hashes


def main(arguments):
    builds = [pathlib.Path(argument) for argument in arguments]
    needed = {program for _, program, _, _ in RUNS}
    absent = [build for build in builds if not all((build / program).exists() for program in needed)]
    for build in absent:
        print(f"not built: {build}")
    if absent and os.environ.get("TACTUM_ALL_BUILDS") == "1":
        return 1
    present = [build for build in builds if build not in absent]
    if len(present) < 2:
        print("nothing to compare: build another preset, or run ./test, which builds them all")
        return SKIPPED
    told = {}
    for build in present:
        told[build] = frame_hashes(build)
        print("  ".join(f"{name} {value}" for name, value in told[build].items()), "", build)
    differ = [name for name, *_ in RUNS if len({hashes[name] for hashes in told.values()}) != 1]
    if differ:
        print(f"the builds differ in: {', '.join(differ)}")
        return 1
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except (RuntimeError, OSError, KeyError, ValueError) as error:
        sys.exit(f"same_bits: {error}")
