#!/usr/bin/env python3
"""Demonstrations of a task, recorded as a data set for robot learning: hands of different firmness put a peg into its hole.

    examples/python/demonstrations.py [DATASET.h5]

Each run is a recording, and one group /data/demo_N of the data set, in the layout of robomimic: what was observed, and as the
action the pose of the hand a step later. Needs python3-h5py.
"""
import os
import sys
import tempfile

import h5py
import numpy as np

import tactum

GRIPS = ("loose", "medium", "firm")
EVERY = 20  # frames a step of the data set: 50 a second
OBSERVATIONS = {
    "part_pos": [f"proxy_p{a}_m" for a in "xyz"],
    "part_quat": [f"proxy_q{a}" for a in "xyzw"],
    "part_vel_lin": [f"proxy_v{a}_m_per_s" for a in "xyz"],
    "part_vel_ang": [f"proxy_w{a}_rad_per_s" for a in "xyz"],
    "force": [f"computed_f{a}_N" for a in "xyz"],
    "torque": [f"computed_t{a}_Nm" for a in "xyz"],
}
HAND = [f"hand_p{a}_m" for a in "xyz"] + [f"hand_q{a}" for a in "xyzw"]


def columns(recording, names):
    return np.stack([recording.column(name) for name in names], axis=1)[::EVERY]


def demonstrate(grip, path):
    """A run of the scene's own hand, recorded; whether it reached the goals."""
    session = tactum.open_session("peg-100um", grip=grip, record=path)
    session.run()
    return all(met for _, met in session.goals)


def add_demonstration(data, name, recording, reached):
    group = data.create_group(name)
    for key, names in OBSERVATIONS.items():
        rows = columns(recording, names)
        group[f"obs/{key}"], group[f"next_obs/{key}"] = rows[:-1], rows[1:]
    group["actions"] = columns(recording, HAND)[1:]
    steps = len(group["actions"])
    group["dones"] = (np.arange(steps) == steps - 1).astype(np.int64)
    group["rewards"] = group["dones"][:] * float(reached)
    group.attrs.update(num_samples=steps, scene=recording.scene, device=recording.device)
    return steps


def main(arguments):
    with tempfile.TemporaryDirectory() as folder:
        path = arguments[0] if arguments else os.path.join(folder, "demonstrations.h5")
        with h5py.File(path, "w") as file:
            data = file.create_group("data")
            for number, grip in enumerate(GRIPS):
                run = os.path.join(folder, f"{grip}.mcap")
                reached = demonstrate(grip, run)
                recording = tactum.Recording(run)
                steps = add_demonstration(data, f"demo_{number}", recording, reached)
                force = np.linalg.norm(data[f"demo_{number}/obs/force"], axis=1).max()
                print(f"demo_{number}: {grip} hand, {steps} steps, at most {force:.2f} N, the goals are {'' if reached else 'not '}met")
            data.attrs["total"] = sum(group.attrs["num_samples"] for group in data.values())
            check(data)


def check(data):
    """Each action is where the hand is a step later, which the demonstrations tell apart."""
    assert data.attrs["total"] > 300
    for group in data.values():
        assert np.array_equal(group["obs/part_pos"][1:], group["next_obs/part_pos"][:-1])
        away = group["actions"][:, :3] - group["next_obs/part_pos"][:]
        assert np.linalg.norm(away, axis=1).max() < 0.02, "the part follows the hand"
    assert not np.array_equal(data["demo_0/obs/force"][:100], data["demo_2/obs/force"][:100])


if __name__ == "__main__":
    main(sys.argv[1:])
