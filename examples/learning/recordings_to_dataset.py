#!/usr/bin/env python3
"""Makes a robot-learning data set of recordings:

    tactum export run.mcap --hdf5 run.h5
    recordings_to_dataset.py run.h5 more.h5 -o dataset.h5 [--rate 50]

The data set has the layout of robomimic and robosuite: one group /data/demo_N a recording with `obs/KEY`, `next_obs/KEY`,
`actions`, `rewards` and `dones`. docs/recording.md tells what each key is made of. Needs python3-h5py.
"""
import argparse
import json
import sys

import h5py
import numpy

CONTACTS = 16  # that a frame of a recording has at most

# Key of the observation: columns of /frame, what they are, and their unit.
XYZ = "xyz"
OBSERVATIONS = {
    "part_pos": ([f"proxy_p{a}_m" for a in XYZ], "place of the handle on the grasped part", "m"),
    "part_quat": ([f"proxy_q{a}" for a in "xyzw"], "its orientation, x y z w", "1"),
    "part_vel_lin": ([f"proxy_v{a}_m_per_s" for a in XYZ], "its velocity", "m/s"),
    "part_vel_ang": ([f"proxy_w{a}_rad_per_s" for a in XYZ], "its angular velocity", "rad/s"),
    "hand_pos": ([f"hand_p{a}_m" for a in XYZ], "place of the hand", "m"),
    "hand_quat": ([f"hand_q{a}" for a in "xyzw"], "its orientation, x y z w", "1"),
    "force": ([f"computed_f{a}_N" for a in XYZ], "force on the hand, before smoothing and safety", "N"),
    "torque": ([f"computed_t{a}_Nm" for a in XYZ], "torque on the hand at the handle, the same", "N m"),
    "force_sent": ([f"sent_f{a}_N" for a in XYZ], "force that the device was sent", "N"),
    "torque_sent": ([f"sent_t{a}_Nm" for a in XYZ], "torque that the device was sent", "N m"),
}
CONTACT_KEYS = {
    "contact_pos": (3, "contact points, the strongest first; zero where there is none", "m"),
    "contact_force": (3, "their forces on the first body, with direction; zero where there is none", "N"),
    "contact_mask": (1, "1 where there is one", "1"),
}
ACTION = "pose of the hand at the next step: place [m] and quaternion x y z w, axes of the world"


def fail(sentence):
    sys.exit(f"recordings_to_dataset: {sentence}")


def columns(frame, names):
    missing = [name for name in names if name not in frame]
    if missing:
        fail(f"{frame.file.filename} has no column {missing[0]}: is it of tactum export --hdf5?")
    return numpy.stack([frame[name][:] for name in names], axis=1)


def continuous(quaternions):
    """The same rotations, without the jumps of sign that a quaternion may have from one row to the next."""
    dots = numpy.sum(quaternions[1:] * quaternions[:-1], axis=1)
    signs = numpy.concatenate([[1.0], numpy.cumprod(numpy.where(dots < 0, -1.0, 1.0))])
    return quaternions * signs[:, None]


def contacts_of(file, rows):
    """The contact points of each frame in rows of one length."""
    group, frames = file["contacts"], len(file["frame"]["time_s"])
    number = group["frame"][:].astype(int)
    place = numpy.arange(len(number)) - numpy.searchsorted(number, number)  # within its frame
    kept = place < CONTACTS
    number, place = number[kept], place[kept]
    found = {key: numpy.zeros((frames, CONTACTS, width)) for key, (width, _, _) in CONTACT_KEYS.items()}
    found["contact_pos"][number, place] = group["p_W_m"][:][kept]
    found["contact_force"][number, place] = (group["n_BA_W"][:] * group["force_N"][:][:, None])[kept]
    found["contact_mask"][number, place] = 1.0
    return {key: values[rows].reshape(len(rows), -1) for key, values in found.items()}


def write_demo(data, number, path, rate_Hz):
    with h5py.File(path) as file:
        if file.attrs.get("format") != "tactum recording":
            fail(f"{path} is no recording of tactum export --hdf5")
        frame, own_rate_Hz = file["frame"], float(file.attrs["rate_Hz"])
        if not 0 < rate_Hz <= own_rate_Hz:
            fail(f"--rate {rate_Hz:g} is not between 0 and the {own_rate_Hz:g} Hz of {path}")
        every = max(round(own_rate_Hz / rate_Hz), 1)
        rows = numpy.arange(0, len(frame["time_s"]), every)
        if len(rows) < 2:
            fail(f"{path} is too short: it has {len(rows)} step at {rate_Hz:g} Hz")
        values = {}
        for key, (names, _, _) in OBSERVATIONS.items():
            table = columns(frame, names)
            values[key] = (continuous(table) if key.endswith("_quat") else table)[rows]
        values |= contacts_of(file, rows)
        demo = data.create_group(f"demo_{number}")
        units = {key: (meaning, unit) for key, (_, meaning, unit) in (OBSERVATIONS | CONTACT_KEYS).items()}
        for group, part in (("obs", slice(None, -1)), ("next_obs", slice(1, None))):
            for key, table in values.items():
                column = demo.create_dataset(f"{group}/{key}", data=table[part], compression="gzip")
                column.attrs["meaning"], column.attrs["unit"] = units[key]
                column.attrs["axes"] = "world"
        steps = len(rows) - 1
        actions = numpy.concatenate([values["hand_pos"], values["hand_quat"]], axis=1)[1:]
        demo.create_dataset("actions", data=actions).attrs["meaning"] = ACTION
        demo.create_dataset("rewards", data=numpy.zeros(steps))
        demo.create_dataset("dones", data=(numpy.arange(steps) == steps - 1).astype(numpy.int64))
        demo.attrs["num_samples"] = steps
        demo.attrs["rate_Hz"] = own_rate_Hz / every
        for name in ("scene", "device", "date", "tactum_version"):
            demo.attrs[name] = file.attrs[name]
        demo.attrs["scene_toml"] = file["files"]["scene.toml"][()]
        return steps


def main():
    parser = argparse.ArgumentParser(description="Makes a robot-learning data set of recordings exported to HDF5.")
    parser.add_argument("files", nargs="+", metavar="FILE.h5", help="made by tactum export --hdf5")
    parser.add_argument("-o", "--out", required=True, help="the data set to write")
    parser.add_argument("--rate", type=float, default=50.0, help="steps a second [Hz], a whole part of the recording's")
    options = parser.parse_args()
    with h5py.File(options.out, "w") as out:
        data = out.create_group("data")
        steps = [write_demo(data, number, path, options.rate) for number, path in enumerate(options.files)]
        data.attrs["total"] = sum(steps)
        data.attrs["env_args"] = json.dumps({"env_name": "tactum", "env_version": "1", "type": 1, "env_kwargs": {}})
        data.attrs["action"] = ACTION
    print(f"{len(steps)} demonstrations with {sum(steps)} steps in {options.out}")


main()
