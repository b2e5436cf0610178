#!/usr/bin/env python3
"""What a recording costs the loop:  tests/recording/work_per_frame.py TACTUM

Counts the instructions of Session::run, the loop's work of a frame, by callgrind, over the same frames of the gears on
the virtual clock, with a recording and without. The two may differ by three hundredths. Both programs take the times
of the stages, as `tactum feel` always does. Skipped (77) where valgrind is not installed.
"""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

MOST_DIFFERENCE = 0.03
FRAMES = 2500


def instructions(program, out, recording):
    """Instructions inside Session::run and what it calls, and the printed hash of the frames."""
    command = ["valgrind", "--tool=callgrind", f"--callgrind-out-file={out}", "--collect-atstart=no",
               "--toggle-collect=*Session::run(*", program, "feel", "gears", "--virtual-clock", "--updates",
               str(FRAMES)] + (["--record", recording] if recording else [])
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode not in (0, 2):  # 2: a goal of the scene was not reached in so few frames
        sys.exit(f"{' '.join(command)}\n{done.stdout}{done.stderr}")
    found = re.search(r"^(?:summary|totals): (\d+)", out.read_text(), re.MULTILINE)
    hashes = re.search(r"frames' hash.*", done.stdout)
    return int(found.group(1)) if found else 0, hashes.group(0) if hashes else ""


def main(arguments):
    if len(arguments) != 1:
        sys.exit(__doc__)
    if shutil.which("valgrind") is None:
        print("valgrind is not installed")
        return 77
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        recording = folder / "run.mcap"
        alone, hash_alone = instructions(arguments[0], folder / "alone", None)
        recorded, hash_recorded = instructions(arguments[0], folder / "recorded", str(recording))
        verified = subprocess.run([arguments[0], "replay", str(recording), "--verify"], capture_output=True, text=True)
    if alone == 0:
        sys.exit("callgrind counted nothing: has Session::run been renamed?")
    if not hash_alone or hash_alone != hash_recorded:
        sys.exit(f"the two runs are not the same frames: {hash_alone} and {hash_recorded}")
    if f"all {FRAMES} frames are the same to the bit" not in verified.stdout:
        sys.exit(f"what was recorded is not all frames:\n{verified.stdout}{verified.stderr}")
    difference = (recorded - alone) / alone
    print(f"instructions a frame: {alone / FRAMES:.0f} without a recording, {recorded / FRAMES:.0f} with one: "
          f"{100 * difference:.2f} % more")
    return 0 if difference < MOST_DIFFERENCE else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
