#!/usr/bin/env python3
"""Checks the data set that is made of recordings:  dataset.py TACTUM CONVERTER

Its numbers are those of the recording at the rows of its steps, the action is where the hand goes next, forces of contacts
add up to the force that pushes the part. Ends with 77 where h5py is not installed.
"""
import pathlib
import subprocess
import sys
import tempfile

try:
    import h5py
    import numpy
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

TACTUM, CONVERTER = sys.argv[1:3]
FRAMES, RATE = 1500, 100


def demand(holds, what):
    if not holds:
        sys.exit(f"wrong: {what}")


def record(folder, name, scene):
    for words in (("feel", scene, "--virtual-clock", "--updates", FRAMES, "--record", folder / f"{name}.mcap"),
                  ("export", folder / f"{name}.mcap", "--hdf5", folder / f"{name}.h5")):
        run = subprocess.run([TACTUM, *map(str, words)], capture_output=True, text=True, check=False)
        demand(run.returncode in (0, 2), run.stderr)


def convert(*words):
    return subprocess.run([sys.executable, CONVERTER, *map(str, words)], capture_output=True, text=True, check=False)


def check_demo(demo, run):
    steps = (FRAMES - 1) // (1000 // RATE)
    rows = numpy.arange(steps + 1) * (1000 // RATE)
    demand(demo.attrs["num_samples"] == steps and demo.attrs["rate_Hz"] == RATE, f"{demo.attrs['num_samples']} steps")
    frame = {name: column[:] for name, column in run["frame"].items()}
    observed = demo["obs"]
    for axis, letter in enumerate("xyz"):
        for key, name in (("part_pos", f"proxy_p{letter}_m"), ("part_vel_ang", f"proxy_w{letter}_rad_per_s"),
                          ("force", f"computed_f{letter}_N"), ("torque_sent", f"sent_t{letter}_Nm")):
            demand(numpy.array_equal(observed[key][:, axis], frame[name][rows[:-1]]), f"{key} is not {name}")
        demand(numpy.array_equal(demo["actions"][:, axis], frame[f"hand_p{letter}_m"][rows[1:]]), "the action is another pose")
    demand(numpy.array_equal(demo["actions"][:, :3], demo["next_obs"]["hand_pos"][:]), "the action is not where the hand goes")
    quaternions = numpy.concatenate([observed["hand_quat"][:], demo["actions"][-1:, 3:]])
    demand(numpy.allclose(numpy.linalg.norm(quaternions, axis=1), 1.0), "quaternions have another length")
    demand((numpy.sum(quaternions[1:] * quaternions[:-1], axis=1) > 0).all(), "a quaternion jumps")
    demand(demo["dones"][:].tolist() == [0] * (steps - 1) + [1], "the end is not marked")
    demand(all(column.attrs["unit"] and column.attrs["meaning"] for column in observed.values()), "an observation has no unit")
    demand("schema = 1" in demo.attrs["scene_toml"], "the scene is missing")
    return observed, frame, rows[:-1]


def check_contacts(observed, run, rows):
    mask = observed["contact_mask"][:]
    forces = observed["contact_force"][:].reshape(len(mask), -1, 3)
    number, force = run["contacts"]["frame"][:], run["contacts"]["force_N"][:]
    demand(mask.any(), "there are no contacts")
    for step, row in enumerate(rows):
        mine = number == row
        demand(mask[step].sum() == mine.sum(), f"step {step} has {mask[step].sum()} contacts, not {mine.sum()}")
        lengths = numpy.sort(numpy.linalg.norm(forces[step], axis=1))
        expected = numpy.sort(numpy.concatenate([numpy.zeros(len(lengths) - mine.sum()), force[mine]]))
        demand(numpy.allclose(lengths, expected, atol=1e-12), f"the contact forces of step {step} are others")


def main():
    with tempfile.TemporaryDirectory(prefix="tactum-dataset-") as name:
        folder = pathlib.Path(name)
        record(folder, "a", "block-on-plate")
        record(folder, "b", "peg-1mm")
        run = convert(folder / "a.h5", folder / "b.h5", "-o", folder / "set.h5", "--rate", RATE)
        demand(run.returncode == 0, run.stderr)
        with h5py.File(folder / "set.h5") as data:
            demand(list(data["data"]) == ["demo_0", "demo_1"], "there are other demonstrations")
            demand(data["data"].attrs["total"] == sum(demo.attrs["num_samples"] for demo in data["data"].values()), "another total")
            for demo, name in (("demo_0", "a"), ("demo_1", "b")):
                with h5py.File(folder / f"{name}.h5") as one:
                    observed, _, rows = check_demo(data["data"][demo], one)
                    check_contacts(observed, one, rows)
        demand("no recording" in convert(folder / "set.h5", "-o", folder / "bad.h5").stderr, "a data set is taken for a recording")
        demand("--rate" in convert(folder / "a.h5", "-o", folder / "bad.h5", "--rate", 5000).stderr, "a rate beyond the recording's")
    print("the data set is that of the recordings")


main()
