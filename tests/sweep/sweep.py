#!/usr/bin/env python3
"""Sweeps as their users run them:  sweep.py TACTUM

One thread, two threads, two ranks of MPI, and sweeps that were killed and went on give the same file to the byte; the
values of the axes reach the scene, which `tactum feel` shows; what is wrong is told. Small runs; with TACTUM_FULL=1 the
200 of examples/sweep/assembly.toml. Ends with 77 where h5py is not installed.
"""
import fcntl
import json
import math
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time

try:
    import h5py
    import numpy
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

TACTUM = pathlib.Path(sys.argv[1]).resolve()
SHIPPED = pathlib.Path(__file__).resolve().parents[2] / "examples/sweep"
FULL = os.environ.get("TACTUM_FULL") == "1"
SMALL = """schema = 1
description = "of a test"
scene = "peg.toml"
[[axis]]
name = "clearance_m"
path = "body[block].part.hole_block.clearance_m"
values = [0.00002, 0.001]
[[axis]]
name = "tilt_deg"
paths = ["hand.step[0].rpy_deg[1]", "hand.step[1].rpy_deg[1]"]
from = 0.0
to = 6.0
count = 3
[[axis]]
name = "friction"
path = "friction[0].coefficient"
values = [0.0, 0.6]
"""


def demand(holds, what):
    if not holds:
        sys.exit(f"wrong: {what}")


def tactum(*words, code=0, before=()):
    run = subprocess.run([*before, TACTUM, *map(str, words)], capture_output=True, text=True, check=False)
    demand(run.returncode == code, f"tactum {words} ended with {run.returncode}, not {code}: {run.stderr}{run.stdout}")
    return run


MPI = ("mpirun", "-n", "2", "--oversubscribe", "--allow-run-as-root", "--bind-to", "none")


def has_mpi():
    if not (TACTUM.parent / "tactum-sweep-mpi").exists():
        return False
    try:
        return subprocess.run(["mpirun", "--version"], capture_output=True, check=False).returncode == 0
    except FileNotFoundError:
        return False


def lines_in(path):
    try:
        return path.read_bytes().count(b"\n")
    except FileNotFoundError:
        return 0


def of_session(session):
    """The processes that one of ours, which began the session, has started."""
    found = []
    for name in os.listdir("/proc"):
        try:
            if name.isdigit() and os.getsid(int(name)) == session:
                found.append(int(name))
        except OSError:
            pass
    return found


def killed(plan, out, runs, before=(), options=()):
    """Starts a sweep, and kills all of it with the signal that nothing can catch when it has some runs."""
    process = subprocess.Popen([*before, TACTUM, "sweep", plan, "-o", out, *options], start_new_session=True,
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    journal = pathlib.Path(f"{out}.runs")
    deadline = time.monotonic() + 120
    while lines_in(journal) < 1 + runs and process.poll() is None and time.monotonic() < deadline:
        time.sleep(0.005)
    demand(process.poll() is None, "the sweep was over before it could be killed")
    for number in of_session(process.pid):  # mpirun puts its ranks into groups of their own
        try:
            os.kill(number, signal.SIGKILL)
        except ProcessLookupError:
            pass
    process.wait()
    with journal.open("rb") as file:  # what was killed is over when the lock is free
        while time.monotonic() < deadline:
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
                break
            except BlockingIOError:
                time.sleep(0.02)
    demand(lines_in(journal) >= 1 + runs and not out.exists(), "there is no journal, or a result")
    return journal


def check_equal(folder, plan, runs):
    one = folder / "one.h5"
    tactum("sweep", plan, "-o", one, "--threads", 1, "--page", folder / "one.html")
    whole = one.read_bytes()
    tactum("sweep", plan, "-o", folder / "two.h5", "--threads", 2)
    demand((folder / "two.h5").read_bytes() == whole, "two threads give another table")
    demand(list(folder.glob("*.runs")) == [], "a journal is left")

    cut = folder / "cut.h5"
    journal = killed(plan, cut, runs // 4, options=("--threads", "1"))
    with journal.open("ab") as file:  # as of a kill within a line
        file.write(b"deadbeef 3 0123")
    again = tactum("sweep", plan, "-o", cut, "--threads", 2)
    demand("runs were done before" in again.stderr, f"nothing was taken over: {again.stderr}")
    demand(cut.read_bytes() == whole, "the table of a sweep that was killed is another one")

    if not has_mpi():
        print("without MPI: tactum-sweep-mpi or mpirun is not there")
        return
    tactum("sweep", plan, "-o", folder / "mpi.h5", "--page", folder / "mpi.html", before=MPI)
    demand((folder / "mpi.html").read_bytes() == (folder / "one.html").read_bytes(), "the maps over MPI are others")
    demand((folder / "mpi.h5").read_bytes() == whole, "two ranks of MPI give another table")
    cut = folder / "cut-mpi.h5"
    killed(plan, cut, runs // 4, before=MPI)
    tactum("sweep", plan, "-o", cut, before=MPI)
    demand(cut.read_bytes() == whole, "the table of a sweep over MPI that was killed is another one")


def check_table(folder, plan):
    with h5py.File(folder / "one.h5") as file:
        axes = list(file.attrs["axes"])
        demand(axes == ["clearance_m", "tilt_deg", "friction"], f"the axes are {axes}")
        shape = tuple(len(file["axes"][axis]) for axis in axes)
        runs = {name: column[:] for name, column in file["runs"].items()}
        demand(all(len(column) == numpy.prod(shape) for column in runs.values()), "columns of other lengths")
        demand(all("unit" in column.attrs and "meaning" in column.attrs for column in file["runs"].values()), "no units")
        demand(file["runs"]["peak_force_N"].attrs["unit"] == "N" and file["axes"]["tilt_deg"].attrs["unit"] == "deg", "other units")
    demand(numpy.array_equal(runs["clearance_m"].reshape(shape)[:, 0, 0], [0.00002, 0.001]), "the first axis does not change last")
    success = runs["success"].reshape(shape)
    demand(success[1, 0, 0] == 1 and success.min() == 0, f"the easiest run fails, or none does: {success}")
    demand(numpy.array_equal(numpy.isnan(runs["success_time_s"]), runs["success"] == 0), "times without success")
    demand(numpy.array_equal(runs["longest_jam_s"] > 0, ~numpy.isnan(runs["jam_pz_m"])), "jams without a place")
    demand(runs["jam_s"].max() > 0.1 and (runs["computed"] == 1).all() and (runs["penetrating_frames"] == 0).all(), "no jam")
    # The maps hold the table: a cell for each run and number, and its value in the title.
    page = (folder / "one.html").read_text(encoding="utf-8")
    demand(not re.search(r"https?://|<link|<img|\bsrc=|@import|url\(", page), "the page of maps asks for something of the network")
    peaks = page.split("<h2>Peak force sent [N]</h2>")[1].split("<h2>")[0]
    cells = re.findall(r"<title>clearance_m = (\S+), tilt_deg = (\S+), friction = (\S+): (\S+)</title>", peaks)
    shown = {tuple(map(float, cell[:3])): cell[3] for cell in cells}
    demand(len(cells) == len(shown) == numpy.prod(shape), f"a map has {len(cells)} cells")
    for place, peak in zip(zip(*(runs[axis] for axis in axes)), runs["peak_force_N"]):
        demand(math.isclose(float(shown[place]), peak, rel_tol=1e-5, abs_tol=1e-12), f"the cell of {place} shows {shown[place]}, not {peak}")
    # One run by hand: the values are put into the scene's text, and felt.
    at = numpy.ravel_multi_index((1, 1, 1), shape)
    scene = (SHIPPED / "peg.toml").read_text(encoding="utf-8")
    scene = scene.replace("clearance_m = 0.0005", "clearance_m = 0.001").replace("coefficient = 0.1", "coefficient = 0.6")
    demand(scene.count("rpy_deg = [0, 2, 0]") == 2, "the scene is another one")
    (folder / "by-hand.toml").write_text(scene.replace("rpy_deg = [0, 2, 0]", "rpy_deg = [0, 3, 0]"), encoding="utf-8")
    felt = subprocess.run([TACTUM, "feel", folder / "by-hand.toml", "--virtual-clock", "--json", "-"], capture_output=True,
                          text=True, check=False)
    summary = json.loads(felt.stdout)
    demand(summary["frame_hash"] == f"{int(runs['frames_hash'][at]):016x}", "the run by hand has other frames")
    demand(summary["max_force_N"] == runs["peak_force_N"][at] and summary["goal_met"] == bool(runs["success"][at]), "other forces")


def check_recording(folder):
    subprocess.run([TACTUM, "feel", "block-on-plate", "--virtual-clock", "--updates", "700", "--record", folder / "run.mcap"],
                   capture_output=True, check=False)
    tactum("report", folder / "run.mcap", "-o", folder / "run.html")
    numbers = json.loads((folder / "run.html").read_text(encoding="utf-8").split('id="numbers">')[1].split("</script>")[0])[0]
    (folder / "hand.toml").write_text('schema = 1\nrecording = "run.mcap"\n[[axis]]\nname = "response"\npath = "response"\n'
                                      'values = ["constraint", "penalty"]\n', encoding="utf-8")
    tactum("sweep", folder / "hand.toml", "-o", folder / "hand.h5")
    with h5py.File(folder / "hand.h5") as file:
        runs = {name: column[:] for name, column in file["runs"].items()}
        demand(list(file["axes"]["response"].attrs["words"]) == ["constraint", "penalty"], "the words are not there")
    demand(runs["frames"].tolist() == [700, 700], "the recording's hand is not led to its end")
    demand(abs(runs["peak_force_N"][0] / numbers["largest_sent_force_N"] - 1) < 1e-12, "the recorded response has another force")
    demand(runs["peak_force_N"][1] != runs["peak_force_N"][0], "the other response has the same force")


def check_errors(folder, plan):
    def refused(change, words, where="bad.toml"):
        (folder / "bad.toml").write_text(change(SMALL), encoding="utf-8")
        error = tactum("sweep", folder / "bad.toml", "-o", folder / "bad.h5", code=1).stderr
        demand(all(word in error for word in (*words, where)), f"{words} is not told: {error}")
        demand(not (folder / "bad.h5.runs").exists(), "a journal of a bad sweep")

    refused(lambda text: text.replace("body[block]", "body[blok]"), ("leads nowhere", "[blok]"))
    refused(lambda text: text.replace("friction[0]", "friction[4]"), ("leads nowhere", "[4]"))
    refused(lambda text: text.replace("count = 3", "counts = 3"), ("counts", ":13:1"))
    refused(lambda text: text.replace("values = [0.0, 0.6]", "values = []"), ("list of values",))
    refused(lambda text: text.replace('name = "friction"', 'name = "tilt_deg"'), ("two axes have one name",))
    refused(lambda text: text.replace('scene = "peg.toml"', 'scene = "nowhere.toml"'), ("nowhere.toml",), where="nowhere")
    demand("is there already" in tactum("sweep", plan, "-o", folder / "one.h5", code=1).stderr, "a result is overwritten")
    # A run that cannot be computed is one row; the others are there.
    (folder / "part.toml").write_text(SMALL.replace("values = [0.00002, 0.001]", "values = [-0.5, 0.001]")
                                      .replace("count = 3", "count = 2"), encoding="utf-8")
    run = tactum("sweep", folder / "part.toml", "-o", folder / "part.h5")
    demand("4 could not be computed" in run.stdout and "clearance_m = -0.5" in run.stderr, run.stdout + run.stderr)
    with h5py.File(folder / "part.h5") as file:
        demand(file["runs"]["computed"][:].tolist() == [0] * 4 + [1] * 4, "other rows failed")
        demand(len(file["runs"].attrs["errors"]) == 4, "the errors are not in the table")
    # Runs of another sweep are not taken over.
    killed(plan, folder / "other.h5", 1, options=("--threads", "1"))
    plan.write_text(plan.read_text(encoding="utf-8").replace('"of a test"', '"of another"'), encoding="utf-8")
    demand("of another sweep" in tactum("sweep", plan, "-o", folder / "other.h5", code=1).stderr, "runs of another sweep are used")


def main():
    with tempfile.TemporaryDirectory(prefix="tactum-sweep-") as name:
        folder = pathlib.Path(name)
        plan = folder / "plan.toml"
        (folder / "peg.toml").write_bytes((SHIPPED / "peg.toml").read_bytes())
        plan.write_text(SMALL, encoding="utf-8")
        check_equal(folder, plan, 12)
        check_table(folder, plan)
        check_recording(folder)
        check_errors(folder, plan)
        if FULL:
            (folder / "full").mkdir()
            check_equal(folder / "full", SHIPPED / "assembly.toml", 200)
    print("every way gives the same table to the byte")


main()
