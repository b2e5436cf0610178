#!/usr/bin/env python3
"""Holds that every build computes the same frames, to the last bit:  tools/same_bits.py PROGRAM PROGRAM...

Each program is the frame_hashes of another build (tests/same_bits): it runs scenes on the virtual clock and prints the
name of each and the hash of all its frames. Then each records a run, and every program verifies the recordings of all,
and those of tests/recordings, frame by frame. One that was not built is left out and told, unless TACTUM_ALL_BUILDS=1 says
that all must be there. Exit code 77 (skipped) when fewer than two programs are there to compare.
"""
import os
import pathlib
import subprocess
import sys
import tempfile

SKIPPED = 77


def frame_hashes(program):
    """The hashes that the program prints, by what was run."""
    done = subprocess.run([str(program)], capture_output=True, text=True, stdin=subprocess.DEVNULL)
    if done.returncode != 0 or not done.stdout:
        raise RuntimeError(f"{program}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    return dict(line.split() for line in done.stdout.splitlines())


def run(program, *words):
    """What the program prints; an error where it ends with another code than 0."""
    done = subprocess.run([str(program), *map(str, words)], capture_output=True, text=True, stdin=subprocess.DEVNULL)
    if done.returncode != 0:
        raise RuntimeError(f"{program} {words[0]}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def verify_recordings(programs):
    """Every program verifies what every other has recorded, and the recordings that are kept."""
    kept = sorted((pathlib.Path(__file__).resolve().parents[1] / "tests/recordings").glob("*.mcap"))
    with tempfile.TemporaryDirectory() as folder:
        recordings = [pathlib.Path(folder) / f"{number}.mcap" for number in range(len(programs))]
        for program, recording in zip(programs, recordings):
            run(program, "record", recording)
        for program in programs:
            lines = run(program, "verify", *recordings, *kept).splitlines()
            if len(lines) < 2 * len(programs) + len(kept):
                raise RuntimeError(f"{program} verifies too little: {lines}")
            print(f"{len(recordings)} recordings of all builds and {len(kept)} that are kept: the same frames ", program)


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
        told[program] = frame_hashes(program)
        print("  ".join(f"{name} {value}" for name, value in told[program].items()), "", program)
    runs = sorted(set().union(*told.values()))
    differ = [name for name in runs if len({hashes.get(name) for hashes in told.values()}) != 1]
    if differ:
        print(f"the builds differ in: {', '.join(differ)}")
        return 1
    verify_recordings(present)
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except (RuntimeError, OSError, ValueError) as error:
        sys.exit(f"same_bits: {error}")
