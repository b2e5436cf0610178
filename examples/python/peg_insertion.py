#!/usr/bin/env python3
"""A peg is led into its hole a little aside and tilted, and the force is told, and plotted where a file is named:

    examples/python/peg_insertion.py [PLOT.png]
"""
import sys

import numpy as np

import tactum


def smooth(q):
    return 0.5 - 0.5 * np.cos(np.pi * np.clip(q, 0.0, 1.0))


def insertion(aside_m, tilt_rad, frames=3000):
    """The hand's poses from where the scene's own hand begins: first over the hole, aside and tilted, then down."""
    scene = tactum.open("peg-100um")
    scene.open_hand()
    start = scene.read_hand().X_DH
    scene.close_hand()
    poses = np.empty((frames, 4, 4))
    for i in range(frames):
        over, down = smooth(3.0 * i / frames), smooth(1.5 * i / frames - 0.5)
        poses[i] = start
        poses[i][:3, :3] = tactum.pose(rotation=(0.0, over * tilt_rad, 0.0))[:3, :3] @ start[:3, :3]
        poses[i][:3, 3] += (-0.004 + over * aside_m, 0.0, -0.025 * down)
        poses[i][0, 3] += 0.004 * (1.0 - over)
    return poses


def main(arguments):
    print("  aside    tilt   largest force   largest torque  smallest gap   contacts")
    worst = None
    for aside_m, tilt_rad in ((0.0, 0.0), (0.0003, 0.0), (0.0003, 0.01), (0.001, 0.02)):
        sim = tactum.open("peg-100um")
        wrenches = np.empty((3000, 6))
        most, nearest_m = 0, np.inf
        for i, X_DH in enumerate(insertion(aside_m, tilt_rad)):
            wrenches[i], contacts = sim.step(X_DH)
            if len(contacts):
                most = max(most, np.count_nonzero(contacts["normal_force_N"] > 0.0))
                nearest_m = min(nearest_m, contacts["distance_m"].min())
        assert not sim.report["penetrating"]
        assert nearest_m > 0.0, "the peg never touches the wall: it is kept a skin away"
        force, torque = np.linalg.norm(wrenches[:, :3], axis=1), np.linalg.norm(wrenches[:, 3:], axis=1)
        print(f"{1e3 * aside_m:4.1f} mm {tilt_rad:6.3f}   {force.max():8.3f} N     {torque.max():10.4f} N m"
              f"   {1e6 * nearest_m:8.3f} um {most:6d}")
        worst = (sim, wrenches)
    assert np.linalg.norm(worst[1][:, :3], axis=1).max() > 0.1, "1 mm aside the peg pushes its wall"
    if arguments:
        sim, wrenches = worst
        tactum.plots.wrenches(wrenches, sim.dt_s, "peg in hole, 1 mm aside").savefig(arguments[0])
        print(f"plotted in {arguments[0]}")


if __name__ == "__main__":
    main(sys.argv[1:])
