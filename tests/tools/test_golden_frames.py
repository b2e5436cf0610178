"""tools/golden_frames.py tells every difference between the committed hashes and those found."""
import unittest

import support  # noqa: F401  (puts tools/ on the path)

import golden_frames

GEARS = ("gears", "constraint")
LOCK = ("lock", "penalty")


class Differences(unittest.TestCase):
    def found(self, golden, hashes, expected):
        return list(golden_frames.differences(golden, hashes, expected))

    def test_equal_hashes_differ_in_nothing(self):
        self.assertEqual(self.found({GEARS: "a"}, {GEARS: "a"}, ["gears"]), [])

    def test_another_hash_is_named_with_both_values(self):
        [sentence] = self.found({GEARS: "a"}, {GEARS: "b"}, ["gears"])
        self.assertEqual(sentence, "gears (constraint): found b, expected a")

    def test_a_scene_without_a_committed_hash_is_a_difference(self):
        [sentence] = self.found({}, {LOCK: "b"}, ["lock"])
        self.assertIn("no committed hash", sentence)

    def test_an_expected_scene_that_did_not_run_is_a_difference(self):
        [sentence] = self.found({GEARS: "a", LOCK: "c"}, {GEARS: "a"}, ["gears", "lock"])
        self.assertIn("lock (penalty)", sentence)

    def test_a_scene_that_is_left_out_is_none(self):
        self.assertEqual(self.found({GEARS: "a", LOCK: "c"}, {GEARS: "a"}, ["gears"]), [])


if __name__ == "__main__":
    unittest.main()
