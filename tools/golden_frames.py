#!/usr/bin/env python3
"""Compares the frames of every shipped scene with the committed ones:  tools/golden_frames.py TACTUM [OPTION...]

Each scene runs with both responses (one with two hands with `constraint` alone) for 5 000 frames on the virtual clock, and, by the tactum-bench that lies beside
TACTUM, the heap with less budget than pairs. The hashes of all their frames must be those of tests/golden/frames.csv: a
change of the code that is not meant to change behaviour keeps every line, and a commit that changes a line says which and
why. Scenes of real meshes (NAME-file) run where the data is, in the folder named by TACTUM_DATA or in shared/data beside
the checkout; the slow one of them only with TACTUM_FULL=1.

  --write         write the file instead of comparing with it
  --only NAME     this scene alone (may be repeated)
"""
import argparse
import csv
import json
import os
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
GOLDEN = ROOT / "tests/golden/frames.csv"
FRAMES = 5000
DATA = pathlib.Path(os.environ.get("TACTUM_DATA", ROOT.parent / "shared/data"))
FULL = os.environ.get("TACTUM_FULL") == "1"
SLOW = ("nut-bolt-file",)
TWO_HANDED = ("peg-two-hands",)  # the penalty response knows one hand only
RESPONSES = ("constraint", "penalty")
HEAP = ["schedule", "--bodies", "6", "--seconds", "0.6", "--shares", "0.1", "--replays", "1"]


def report_of(program, arguments):
    """The JSON report of one run of the program."""
    with tempfile.TemporaryDirectory() as folder:
        report = pathlib.Path(folder) / "report.json"
        command = [str(program), *arguments, "--json", str(report)]
        done = subprocess.run(command, capture_output=True, text=True, stdin=subprocess.DEVNULL, cwd=ROOT,
                              env={**os.environ, "TACTUM_DATA": str(DATA)})
        if done.returncode not in (0, 2):  # 2: a goal was not met, as in a run cut short
            raise RuntimeError(f"{' '.join(command)}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
        return json.loads(report.read_text())


def is_left_out(scene):
    """Why a scene does not run here, or nothing."""
    if scene.endswith("-file") and not DATA.is_dir():
        return "its meshes are absent"
    return "it is slow; TACTUM_FULL=1 runs it" if scene in SLOW and not FULL else ""


def runs(scenes):
    """Every run by name: (scene, response) -> the program, what it is asked, and where its hash stands."""
    for scene in scenes:
        for response in RESPONSES[:1] if scene in TWO_HANDED else RESPONSES:
            arguments = ["feel", scene, "--response", response, "--virtual-clock", "--updates", str(FRAMES)]
            yield (scene, response), "tactum", arguments, lambda report: report["frame_hash"]
    yield ("heap", "constraint"), "tactum-bench", HEAP, lambda report: report["budgets"][0]["frame_hash"]


def read_golden():
    with GOLDEN.open(newline="") as file:
        return {(row["scene"], row["response"]): row["frame_hash"] for row in csv.DictReader(file)}


def write_golden(hashes):
    GOLDEN.parent.mkdir(exist_ok=True)
    with GOLDEN.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["scene", "response", "frame_hash"])
        writer.writerows([*run, value] for run, value in hashes.items())


def differences(golden, hashes, expected):
    """A sentence for each run whose frames are not the committed ones; `expected` names the scenes that had to run."""
    for run, value in hashes.items():
        if run not in golden:
            yield f"{run[0]} ({run[1]}): no committed hash; found {value}"
        elif golden[run] != value:
            yield f"{run[0]} ({run[1]}): found {value}, expected {golden[run]}"
    for run in golden.keys() - hashes.keys():
        if run[0] in expected:
            yield f"{run[0]} ({run[1]}): has a committed hash and did not run"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--only", action="append", default=[])
    options = parser.parse_args()
    scenes = [path.stem for path in sorted((ROOT / "scenes").glob("*.toml"))]
    chosen = []
    for scene in [*scenes, "heap"]:
        if options.only and scene not in options.only:
            continue
        if reason := is_left_out(scene):
            print(f"left out: {scene}: {reason}")
        else:
            chosen.append(scene)
    hashes = {run: str(read(report_of(options.program.with_name(name), arguments)))
              for run, name, arguments, read in runs(scenes) if run[0] in chosen}
    golden = read_golden() if GOLDEN.exists() else {}
    if options.write:
        write_golden(dict(sorted((golden | hashes).items())))
        return 0
    found = list(differences(golden, hashes, chosen))
    for sentence in found:
        print(sentence)
    print(f"golden frames: {len(hashes)} runs, {len(found)} differ from {GOLDEN.relative_to(ROOT)}")
    return 1 if found else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except (RuntimeError, OSError, KeyError, ValueError) as error:
        sys.exit(f"golden_frames: {error}")
