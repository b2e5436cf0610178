"""The Python module: the frames of the program to the bit, what parts are, recordings, errors, and nothing leaked."""
import contextlib
import gc
import io
import json
import os
import pathlib
import re
import resource
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy as np

import tactum

PROGRAM = os.environ.get("TACTUM_PROGRAM", "")


def cube(half, name="cube", density_kg_per_m3=1000.0):
    """A box about the origin from eight corners."""
    half = np.broadcast_to(half, (3,))
    corners = np.array([[half[0] * (1 if i & 1 else -1), half[1] * (1 if i & 2 else -1), half[2] * (1 if i & 4 else -1)]
                        for i in range(8)])
    triangles = [(0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4),
                 (2, 6, 7), (2, 7, 3), (0, 4, 6), (0, 6, 2), (1, 3, 7), (1, 7, 5)]
    return tactum.Part.from_mesh(corners, triangles, name=name, density_kg_per_m3=density_kg_per_m3)


def kilobytes():
    """Of memory that is resident now."""
    for line in pathlib.Path("/proc/self/status").read_text().splitlines():
        if line.startswith("VmRSS:"):
            return int(line.split()[1])
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


class Stepping(unittest.TestCase):
    @unittest.skipUnless(PROGRAM, "the program is not built")
    def test_ten_thousand_steps_of_the_gears_are_the_program_s_to_the_bit(self):
        frames = 10000
        with tempfile.TemporaryDirectory() as folder:
            summary, trace = os.path.join(folder, "summary.json"), os.path.join(folder, "trace.csv")
            subprocess.run([PROGRAM, "feel", "gears", "--virtual-clock", "--updates", str(frames), "--json", summary,
                            "--trace", trace], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            wanted = json.loads(pathlib.Path(summary).read_text())
            with open(trace) as lines:
                names = next(line for line in lines if not line.startswith("#")).strip().split(",")
                table = np.array([[float(number) for number in line.split(",")] for line in lines])
        sim = tactum.open("gears")
        sim.open_hand()
        wrenches = np.empty((frames, 6))
        for i in range(frames):  # the loop of the program, in Python
            wrench, _ = sim.step(sim.read_hand())
            sim.write_hand(wrench)
            wrenches[i] = wrench
        sim.close_hand()
        self.assertEqual(f"{sim.hash:016x}", wanted["frame_hash"])
        # The trace has the axes of W: in this scene those of D, so that the numbers can be compared as they are.
        first = names.index("sent_fx_N")
        sent = table[:, [names.index(f"sent_{kind}{axis}_{unit}") for kind, unit in (("f", "N"), ("t", "Nm"))
                         for axis in "xyz"]]
        self.assertGreaterEqual(first, 0)
        self.assertEqual(len(sent), frames)
        self.assertGreater(np.abs(wrenches).max(), 0.001)
        np.testing.assert_array_equal(sent, wrenches + 0.0)

    @unittest.skipUnless(PROGRAM, "the program is not built")
    def test_two_hands_are_the_program_s_to_the_bit(self):
        """The peg in one hand and its hole in the other, through first contact: as the scene is, with another device in the
        first or the second hand, with a looser grip, and with other settings."""
        softer = "[settings.coupling]\nstiffness_N_per_m = 400.0\n"
        variants = [([], {}),
                    (["--settings", "softer.toml"], {"settings": softer}),
                    (["--device", "touch", "--device", "premium-1.5-6dof"], {"device": "touch"}),
                    (["--device", "premium-1.5-6dof", "--device", "touch"], {"other_devices": ["touch"]}),
                    (["--hand", "loose"], {"grip": "loose"})]
        frames = 1600
        for arguments, options in variants:
            with self.subTest(**options), tempfile.TemporaryDirectory() as folder:
                summary, trace = os.path.join(folder, "summary.json"), os.path.join(folder, "trace.csv")
                pathlib.Path(folder, "softer.toml").write_text(softer)
                subprocess.run([os.path.abspath(PROGRAM), "feel", "peg-two-hands", "--virtual-clock", "--updates",
                                str(frames), "--json", summary, "--trace", trace, *arguments], cwd=folder,
                               stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
                wanted = json.loads(pathlib.Path(summary).read_text())
                with open(trace) as lines:
                    names = next(line for line in lines if not line.startswith("#")).strip().split(",")
                    table = np.array([[float(number) for number in line.split(",")] for line in lines])
                sim = tactum.open("peg-two-hands", **options)
                self.assertEqual((sim.hands, len(sim.devices)), (2, 2))
                sim.open_hand()
                wrenches = np.empty((frames, 2, 6))
                for i in range(frames):  # the loop of the program, in Python
                    both, contacts = sim.step([sim.read_hand(0), sim.read_hand(1)])
                    for hand, wrench in enumerate(both):
                        sim.write_hand(wrench, hand)
                    wrenches[i] = both
                sim.close_hand()
                self.assertEqual(f"{sim.hash:016x}", wanted["frame_hash"])
                for hand, prefix in enumerate(("", "h2_")):  # in this scene the axes of D are those of W
                    sent = table[:, [names.index(f"{prefix}sent_{kind}{axis}_{unit}")
                                     for kind, unit in (("f", "N"), ("t", "Nm")) for axis in "xyz"]]
                    np.testing.assert_array_equal(sent, wrenches[:, hand] + 0.0)
                    self.assertGreater(np.abs(sent).max(), 0.001)

    def test_every_way_to_step_two_hands_is_the_same(self):
        follower = tactum.open("peg-two-hands")
        follower.open_hand()
        followed, poses = follower.follow_hand(1300)
        self.assertEqual((followed.shape, poses.shape), ((1300, 2, 6), (1300, 2, 4, 4)))
        # By poses alone the frame estimates the velocities, so the ways by pose are compared with each other.
        by_list, by_array, by_samples = (tactum.open("peg-two-hands") for _ in range(3))
        ran = tactum.open("peg-two-hands").run(poses)
        for i, (X, Y) in enumerate(poses):
            for sim, both in ((by_list, [X, Y]), (by_array, np.array([X, Y])), (by_samples, (tactum.Sample(X), Y))):
                np.testing.assert_array_equal(sim.step(both)[0], ran[i])
        self.assertGreater(np.abs(ran).max(), 0.1)
        first, second = by_list.hand_reports
        self.assertEqual({first["grasped_body"], second["grasped_body"]}, {0, 1})
        np.testing.assert_allclose(first["F_W_contacts"][:3], -second["F_W_contacts"][:3], atol=1e-9)

    def test_the_number_of_hands_is_told(self):
        with self.assertRaisesRegex(tactum.Error, "a pose or a sample for each hand: found 1, expected 2"):
            tactum.open("peg-two-hands").step(np.eye(4))
        with self.assertRaisesRegex(tactum.Error, "a pose or a sample for each hand: found 2, expected 1"):
            tactum.open("gears").step([np.eye(4), np.eye(4)])
        with self.assertRaisesRegex(tactum.Error, r"found \(3, 4, 4\), expected \(n, 2, 4, 4\)"):
            tactum.open("peg-two-hands").run(np.zeros((3, 4, 4)))
        with self.assertRaisesRegex(tactum.Error, "more devices than the scene has hands: found 2, expected at most 1"):
            tactum.open("gears", other_devices=["touch"])
        with self.assertRaises(IndexError):
            tactum.open("gears").read_hand(1)
        with self.assertRaises(TypeError):
            tactum.open("gears").step("here")

    def test_every_way_to_step_is_the_same(self):
        sim, follower, runner = (tactum.open("gears") for _ in range(3))
        sim.open_hand()
        follower.open_hand()
        stepped = []
        for _ in range(400):
            sample = sim.read_hand()
            wrench, _ = sim.step(sample)
            sim.write_hand(wrench)
            stepped.append(wrench)
        followed, poses = follower.follow_hand(400)
        np.testing.assert_array_equal(stepped, followed)
        self.assertEqual(sim.hash, follower.hash)
        by_pose = np.array([runner.step(X)[0] for X in poses[:200]])
        np.testing.assert_array_equal(by_pose, tactum.open("gears").run(poses[:200]))

    def test_contacts_carry_the_force(self):
        sim = tactum.open("block-on-plate")
        for i in range(1500):
            wrench, contacts = sim.step(tactum.pose((0, 0, -1e-5 * i)))
        self.assertEqual(contacts.dtype, tactum.contact_dtype)
        self.assertGreater(len(contacts), 0)
        held = sim.report["grasped_body"]
        sign = np.where(contacts["body_a"] == held, 1.0, -1.0)
        force = (sign * contacts["normal_force_N"]) @ contacts["normal"]
        np.testing.assert_allclose(force[2], sim.report["F_W_contacts"][2], rtol=1e-9)
        self.assertGreater(force[2], 0.1)
        pushing = contacts[contacts["normal_force_N"] > 0]
        self.assertLess(np.abs(pushing["residual_m"]).max(), 1e-9)
        self.assertFalse(sim.report["penetrating"])
        self.assertIn("block", sim.bodies[held])

    def test_settings_count(self):
        stiff, soft = tactum.open("block-on-plate"), tactum.open(
            "block-on-plate", settings={"coupling.stiffness_N_per_m": 100.0})
        X = np.array([tactum.pose((0, 0, -1e-5 * i)) for i in range(1500)])
        self.assertLess(soft.run(X)[-1, 2], 0.9 * stiff.run(X)[-1, 2])
        self.assertEqual(tactum.open("gears", rate_Hz=2000.0).dt_s, 0.0005)

    def test_a_world_in_code(self):
        world = tactum.World()
        world.add("block", cube((0.010, 0.007, 0.005), density_kg_per_m3=700.0), tactum.pose((0, 0, 0.008)), material="wood")
        world.add("plate", cube((0.05, 0.05, 0.01)), tactum.pose((0, 0, -0.01)), joint=tactum.Joint("fixed"),
                  material="steel")
        world.friction("wood", "steel", 0.3)
        sim = world.simulate(tool="block")
        for i in range(2000):  # as examples/step_a_world.cpp does
            wrench, _ = sim.step(tactum.pose((0, 0, -0.008 * min(1.0, i * 1e-3))))
        self.assertGreater(wrench[2], 0.1)
        self.assertAlmostEqual(sim.X_WB[0, 2, 3], 0.005, delta=1e-4)
        vertices, triangles = sim.body_mesh(0)
        self.assertEqual((vertices.shape, triangles.shape), ((8, 3), (12, 3)))
        # Two hands with a block each, pressed onto each other: what one feels the other gives.
        world = tactum.World()
        for name, z in (("lower", 0.0), ("upper", 0.011)):
            world.add(name, cube((0.010, 0.010, 0.005)), tactum.pose((0, 0, z)))
        sim = world.simulate(["lower", "upper"], device=["premium-1.5-6dof", "touch"], p_BH=[None, (0, 0, 0)])
        for i in range(1500):
            way = 0.003 * min(1.0, i * 1e-3)
            (below, above), contacts = sim.step([tactum.pose((0, 0, way)), tactum.pose((0, 0, -way))])
        self.assertLess(below[2], -0.1)
        self.assertGreater(above[2], 0.1)
        self.assertGreater(len(contacts), 0)
        with self.assertRaisesRegex(tactum.Error, "device: there is another number of devices than of tools: found 2"):
            world.simulate("lower", device=["touch", "touch"])
        with self.assertRaisesRegex(tactum.Error, "world: there is no such body: found bolt"):
            world.simulate(tool="bolt")
        with self.assertRaisesRegex(tactum.Error, "no such joint: found screw"):
            tactum.Joint("screw")

    def test_other_threads_run_while_cpp_works(self):
        sim = tactum.open("gears")
        sim.open_hand()
        beats, over = [0], threading.Event()

        def beat():
            while not over.is_set():
                beats[0] += 1
                time.sleep(0)

        thread = threading.Thread(target=beat)
        thread.start()
        before = beats[0]
        sim.follow_hand(2000)
        between = beats[0] - before
        over.set()
        thread.join()
        self.assertGreater(between, 0)

    def test_overhead_of_a_step(self):
        """Of processor time, the best of five; printed, not judged: a machine that does other work has no steady times."""
        poses = np.array([tactum.pose((0, 0, 0.01)) for _ in range(4000)])
        best = {"step": 1.0, "run": 1.0}
        for _ in range(5):
            by_step, by_run = tactum.open("block-on-plate"), tactum.open("block-on-plate")
            start = time.thread_time()
            for X in poses:
                by_step.step(X)
            best["step"] = min(best["step"], (time.thread_time() - start) / len(poses))
            start = time.thread_time()
            by_run.run(poses)
            best["run"] = min(best["run"], (time.thread_time() - start) / len(poses))
        print(f"a step from Python {best['step'] * 1e6:.2f} us, in C++ {best['run'] * 1e6:.2f} us:"
              f" {(best['step'] - best['run']) * 1e6:.2f} us more")


class Parts(unittest.TestCase):
    def test_distance_and_clearance_of_boxes(self):
        a, b = cube((0.01, 0.02, 0.03)), cube((0.02, 0.02, 0.01))
        X_WA = tactum.pose((1, 2, 3), (0.3, -0.2, 0.9))
        for gap in (0.007, 0.0005, -0.002):
            X_WB = X_WA @ tactum.pose((0, 0, 0.04 + gap))
            found = tactum.signed_distance(a, b, X_WA, X_WB)
            self.assertAlmostEqual(found.distance_m, gap, delta=1e-12)
            np.testing.assert_allclose(found.n_BA_W, -X_WA[:3, 2], atol=1e-9)
            self.assertAlmostEqual(tactum.clearance(a, b, X_WA, X_WB).distance_m, max(0.0, gap), delta=1e-12)
        along = np.array([tactum.pose((0, 0, 0.04 + gap)) for gap in np.linspace(0.02, -0.01, 31)])
        np.testing.assert_allclose(tactum.clearances(a, b, along), np.maximum(0.0, np.linspace(0.02, -0.01, 31)), atol=1e-12)
        self.assertTrue(tactum.clearance(cube(0.1), a, np.eye(4), np.eye(4)).inside)

    def test_a_part_is_inspected_saved_and_loaded(self):
        made = cube((0.01, 0.02, 0.03), density_kg_per_m3=2000.0)
        self.assertAlmostEqual(made.mass_kg, 2000.0 * 8 * 0.01 * 0.02 * 0.03, delta=1e-12)
        self.assertEqual((made.pieces, made.is_surface, made.vertices.shape), (1, False, (8, 3)))
        self.assertEqual(made.report["mesh"]["triangles"], 12)
        with self.assertRaises(ValueError):
            made.vertices[0, 0] = 1.0  # a view of what is constant
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "cube.part")
            made.save(path)
            loaded = tactum.Part.load(path)
        np.testing.assert_array_equal(loaded.vertices, made.vertices)
        np.testing.assert_array_equal(loaded.inertia_B, made.inertia_B)
        view = loaded.vertices
        del loaded, made
        gc.collect()
        self.assertEqual(view.shape, (8, 3))  # it keeps its part alive
        self.assertGreater(np.ptp(view), 0.0)


class Runs(unittest.TestCase):
    def test_a_session_is_traced_recorded_and_replayed(self):
        with tempfile.TemporaryDirectory() as folder:
            path, csv = os.path.join(folder, "run.mcap"), os.path.join(folder, "run.csv")
            session = tactum.open_session("block-on-plate", record=path, trace=True)
            frames = session.run(700)
            self.assertEqual(frames, 700)
            names, table = session.trace()
            self.assertEqual(table.shape, (700, len(names)))
            self.assertEqual(session.summary["frames"], 700)
            recording = tactum.Recording(path)
            self.assertTrue(recording.complete, recording.wrong)
            self.assertEqual(recording.scene, "block-on-plate")
            sent = table[:, names.index("sent_fz_N")]
            np.testing.assert_array_equal(recording.column("sent_fz_N"), sent)
            again = recording.replay()
            self.assertEqual((again["frames"], again["same"], again["difference"]), (700, 700, None))
            self.assertEqual(recording.export_csv(csv), 700)
            lines = pathlib.Path(csv).read_text().splitlines()
            self.assertEqual(sum(not line.startswith("#") for line in lines), 701)
            if PROGRAM:
                ours, theirs = os.path.join(folder, "ours.h5"), os.path.join(folder, "theirs.h5")
                self.assertEqual(recording.export_hdf5(ours), 700)
                subprocess.run([PROGRAM, "export", path, "--hdf5", theirs], stderr=subprocess.DEVNULL, check=True)
                self.assertEqual(pathlib.Path(ours).read_bytes(), pathlib.Path(theirs).read_bytes())
            with self.assertRaisesRegex(tactum.Error, "cannot write the file"):
                recording.export_hdf5(os.path.join(folder, "no-such-folder", "run.h5"))
            with self.assertRaisesRegex(tactum.Error, "no such column: found weight"):
                recording.column("weight")
            sim = tactum.open("block-on-plate")
            sim.open_hand()
            sim.follow_hand(700)
            self.assertEqual(sim.hash, session.summary["hash"])
            with open(path, "r+b") as file:
                file.truncate(100)
            with self.assertRaises(tactum.Error):
                tactum.Recording(path)

    def test_a_disk_that_fills_up_during_the_export_is_an_error_and_python_ends_well(self):
        """On disks of their own of several sizes, full at the first bytes or in the middle; the next export works."""
        with tempfile.TemporaryDirectory() as folder:
            disk, path = os.path.join(folder, "disk"), os.path.join(folder, "run.mcap")
            os.mkdir(disk)
            own = ["unshare", "--user", "--map-root-user", "--mount", "sh", "-c"]
            mount = f"mount -t tmpfs -o size=$0 none {disk} && exec \"$@\""
            try:
                subprocess.run([*own, mount, "4k", "true"], check=True, capture_output=True)
            except (OSError, subprocess.CalledProcessError):
                self.skipTest("no disk of its own can be made here")
            tactum.open_session("block-on-plate", record=path).run(1500)
            script = f"""
import os, tactum
recording = tactum.Recording({path!r})
try:
    recording.export_hdf5({disk!r} + "/run.h5")
    print("whole")
except tactum.Error as error:
    print(error)
print(os.listdir({disk!r}), recording.export_hdf5({folder!r} + "/again.h5"))
"""
            for size in ("4k", "16k", "64k", "150k", "400k"):
                if PROGRAM:
                    run = subprocess.run([*own, mount, size, PROGRAM, "export", path, "--hdf5", disk + "/run.h5"],
                                         capture_output=True, text=True)
                    with self.subTest(size=size, of="the program"):
                        self.assertEqual(run.returncode, 1)
                        self.assertIn("cannot write the whole file: found No space left on device", run.stderr)
                run = subprocess.run([*own, mount, size, sys.executable, "-c", script], capture_output=True, text=True)
                with self.subTest(size=size):
                    self.assertEqual((run.returncode, run.stderr), (0, ""))
                    self.assertRegex(run.stdout, "run.h5: cannot write the whole file: found No space left on device, expected ")
                    self.assertIn("[] 1500", run.stdout)

    def test_errors_are_the_sentences_of_the_program(self):
        with self.assertRaisesRegex(tactum.Error, "gearz.*expected"):
            tactum.open("gearz")
        with self.assertRaisesRegex(tactum.Error, "no-such.stl"):
            tactum.Part.load("no-such.stl")
        with self.assertRaisesRegex(tactum.Error, r"X_DH: a pose has another shape: found \(3, 3\), expected \(4, 4\)"):
            tactum.open("gears").step(np.eye(3))
        with self.assertRaisesRegex(tactum.Error, "X_WA: the matrix of a pose is no rotation"):
            tactum.clearance(cube(0.01), cube(0.01), 2.0 * np.eye(4), np.eye(4))
        with self.assertRaisesRegex(tactum.Error, "the settings:2:"):
            tactum.open("gears", settings={"coupling.stifness_N_per_m": 1.0})
        with self.assertRaisesRegex(tactum.Error, "no such response: found hard"):
            tactum.open("gears", response="hard")
        if PROGRAM:
            said = subprocess.run([PROGRAM, "feel", "gearz"], capture_output=True, text=True).stderr
            with self.assertRaises(tactum.Error) as raised:
                tactum.open("gearz")
            self.assertIn(str(raised.exception), said)

    def test_a_thousand_sessions_leave_nothing_behind(self):
        def open_and_close(times):
            for _ in range(times):
                tactum.open_session("block-on-plate").run(2)
                sim = tactum.open("block-on-plate")
                sim.step(np.eye(4))
                del sim
            gc.collect()

        open_and_close(100)  # what is set up once, and the heap as large as it gets
        before_kB = kilobytes()
        open_and_close(1000)
        self.assertLess(kilobytes() - before_kB, 2000)  # less than two kilobytes a session

    def test_the_programs_of_the_page_that_stand_alone_run(self):
        page = (pathlib.Path(__file__).resolve().parents[2] / "docs/python.md").read_text()
        programs = re.findall(r"```py\n(.*?)```", page, re.DOTALL)
        space = {}
        for program in programs[:2]:
            with contextlib.redirect_stdout(io.StringIO()):
                exec(program, space)
        self.assertGreater(space["sim"].frames, 1000)

    def test_a_plot_is_one_call(self):
        try:
            import matplotlib
        except ImportError:
            self.skipTest("matplotlib is not installed")
        matplotlib.use("Agg")
        self.assertEqual(len(tactum.plots.wrenches(np.zeros((10, 6)), 0.001).axes), 2)
        panels = tactum.plots.columns(["a_N", "b_N"], np.eye(2), 0.5, shown=("b_N",)).axes
        np.testing.assert_array_equal(panels[0].lines[0].get_ydata(), [0.0, 1.0])

    def test_scenes_and_devices_are_listed(self):
        self.assertIn("gears", dict(tactum.scenes()))
        self.assertIn("simulated", " ".join(name for name, _ in tactum.devices()))


if __name__ == "__main__":
    unittest.main(verbosity=2)
