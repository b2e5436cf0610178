#!/usr/bin/env python3
"""Holds that every build computes the same frames, to the last bit:  tools/same_bits.py TACTUM TACTUM...

Each program runs the gears once on the virtual clock and names the hash of all its frames. One that was not built is
left out and told, unless TACTUM_ALL_BUILDS=1 says that all must be there. Exit code 77 (skipped) when fewer than two
programs are there to compare.
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile

SKIPPED = 77


def frame_hash(program):
    """The hash the program names, after the published 12 499 updates."""
    with tempfile.TemporaryDirectory() as folder:
        report = pathlib.Path(folder) / "table1.json"
        command = [str(program), "bench", "table1", "--replays", "1", "--json", str(report)]
        done = subprocess.run(command, capture_output=True, text=True, stdin=subprocess.DEVNULL)
        if done.returncode != 0:
            raise RuntimeError(f"{program}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
        told = json.loads(report.read_text())
    return str(told["frame_hash"]), told["updates"]


def main(arguments):
    programs = [pathlib.Path(argument) for argument in arguments]
    absent = [program for program in programs if not program.exists()]
    for program in absent:
        print(f"not built: {program}")
    if absent and os.environ.get("TACTUM_ALL_BUILDS") == "1":
        return 1
    present = [program for program in programs if program.exists()]
    if len(present) < 2:
        print("nothing to compare: build another preset, or run ./test, which builds them all")
        return SKIPPED
    told = {}
    for program in present:
        told[program] = frame_hash(program)
        print(f"{told[program][0]}  {told[program][1]} updates  {program}")
    if len(set(told.values())) != 1:
        print("the builds differ")
        return 1
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except (RuntimeError, OSError, KeyError, ValueError) as error:
        sys.exit(f"same_bits: {error}")
