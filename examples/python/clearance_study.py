#!/usr/bin/env python3
"""How much room a bolt has in its hole, over all places and tilts: a study of clearance with no Python between poses.

A round peg of 9.98 mm in a plate with a hole of 10.00 mm, both as polygons of so many sides: the clearance left in the
middle is told by geometry, and what a tilt takes of it is computed.
"""
import numpy as np

import tactum

SIDES = 96


def ring(radius, z):
    angle = 2.0 * np.pi * np.arange(SIDES) / SIDES
    return np.column_stack((radius * np.cos(angle), radius * np.sin(angle), np.full(SIDES, z)))


def peg(radius, half):
    """A prism of SIDES sides."""
    vertices = np.vstack((ring(radius, -half), ring(radius, half), [[0, 0, -half], [0, 0, half]]))
    triangles = []
    for i in range(SIDES):
        j = (i + 1) % SIDES
        triangles += [(i, j, SIDES + j), (i, SIDES + j, SIDES + i), (2 * SIDES, j, i), (2 * SIDES + 1, SIDES + i, SIDES + j)]
    return tactum.Part.from_mesh(vertices, triangles, name="peg")


def plate(hole, outer, half):
    """A disc with a hole: inner wall, outer wall and two rings."""
    vertices = np.vstack((ring(hole, -half), ring(hole, half), ring(outer, -half), ring(outer, half)))
    triangles = []
    for i in range(SIDES):
        j = (i + 1) % SIDES
        a, b, c, d = (k * SIDES for k in range(4))  # hole below and above, outside below and above
        triangles += [(a + i, b + j, a + j), (a + i, b + i, b + j), (c + i, c + j, d + j), (c + i, d + j, d + i),
                      (a + i, a + j, c + j), (a + i, c + j, c + i), (b + i, d + j, b + j), (b + i, d + i, d + j)]
    return tactum.Part.from_mesh(vertices, triangles, name="plate", pieces="surface")


def main():
    hole, shaft, half = 0.00500, 0.00499, 0.010
    bolt, disc = peg(shaft, 0.020), plate(hole, 0.015, half)
    tilts = np.linspace(0.0, 0.0012, 13)
    poses = np.array([tactum.pose(rotation=(0.0, tilt, 0.0)) for tilt in tilts])
    clear = tactum.clearances(disc, bolt, poses)
    for tilt, left in zip(tilts, clear):
        print(f"tilt {1e3 * tilt:5.2f} mrad: {1e6 * left:7.3f} um left")
    # In the middle the walls, as polygons, stand apart by the difference of their inner radii.
    expected = (hole - shaft) * np.cos(np.pi / SIDES)
    assert abs(clear[0] - expected) < 1e-10, (clear[0], expected)
    # A tilt takes its arm, which is half the plate's thickness, times its angle.
    free = clear > 0.0
    np.testing.assert_allclose(clear[free], expected - half * tilts[free], atol=2e-8)
    assert not free[-1], "at 1.2 mrad the bolt touches"


if __name__ == "__main__":
    main()
