#!/usr/bin/env python3
"""Counts what a frame costs with four pages looking and with none:  tools/viewer_work.py TEST_VIEWER

Instructions of Session::run, the loop's work of a frame, by callgrind, over the same frames on the virtual clock. The
two may differ by two hundredths. Skipped (77) where valgrind is not installed.
"""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

MOST_DIFFERENCE = 0.02


def instructions(program, test, folder):
    """Instructions inside Session::run and what it calls, while the test runs."""
    out = pathlib.Path(folder) / test
    command = ["valgrind", "--tool=callgrind", f"--callgrind-out-file={out}", "--collect-atstart=no",
               "--toggle-collect=*Session::run(*", program, f"--gtest_filter=ViewerRun.{test}"]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}\n{done.stdout}{done.stderr}")
    found = re.search(r"^(?:summary|totals): (\d+)", out.read_text(), re.MULTILINE)
    return int(found.group(1)) if found else 0


def main(arguments):
    if len(arguments) != 1:
        sys.exit(__doc__)
    if shutil.which("valgrind") is None:
        print("valgrind is not installed")
        return 77
    with tempfile.TemporaryDirectory() as folder:
        alone, watched = (instructions(arguments[0], test, folder) for test in ("WithoutPages", "WithFourPages"))
    if alone == 0:
        sys.exit("callgrind counted nothing: has Session::run been renamed?")
    difference = abs(watched - alone) / alone
    print(f"instructions of all frames: {alone} without pages, {watched} with four: {100 * difference:.3f} % apart")
    return 0 if difference < MOST_DIFFERENCE else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
