import contextlib
import io
import os
import unittest.mock

from support import TreeTest

import same_bits

PROGRAM = """#!/bin/sh
for report; do :; done
case "$1 $2" in
  "schedule --bodies") printf '{"budgets": [{"frame_hash": "%s"}]}' HEAP > "$report" ;;
  "bench table1" | "feel moving-objects") printf '{"frame_hash": "%s"}' HASH > "$report" ;;
  *) exit 3 ;;
esac
exit CODE
"""


class SameBits(TreeTest):
    def build(self, name, frame_hash, code=0, heap="2a"):
        text = PROGRAM.replace("HASH", frame_hash).replace("HEAP", heap).replace("CODE", str(code))
        for program in ("tactum", "tactum-bench"):
            path = self.write(f"{name}/{program}", text)
            path.chmod(0o755)
        return str(path.parent)

    def run_on(self, *builds, all_builds="0"):
        with unittest.mock.patch.dict(os.environ, TACTUM_ALL_BUILDS=all_builds):
            with contextlib.redirect_stdout(io.StringIO()):
                return same_bits.main(builds)

    def test_equal_hashes_pass(self):
        self.assertEqual(self.run_on(self.build("a", "1f"), self.build("b", "1f")), 0)

    def test_different_hashes_fail(self):
        self.assertEqual(self.run_on(self.build("a", "1f"), self.build("b", "1e")), 1)
        self.assertEqual(self.run_on(self.build("a", "1f"), self.build("b", "1f", heap="2b")), 1)

    def test_a_build_that_fails_is_no_proof(self):
        with self.assertRaises(RuntimeError):
            self.run_on(self.build("a", "1f"), self.build("b", "1f", code=1))

    def test_one_build_is_nothing_to_compare(self):
        self.assertEqual(self.run_on(self.build("a", "1f"), str(self.root / "gone")), same_bits.SKIPPED)

    def test_a_missing_build_fails_when_all_are_wanted(self):
        builds = (self.build("a", "1f"), self.build("b", "1f"), str(self.root / "gone"))
        self.assertEqual(self.run_on(*builds), 0)
        self.assertEqual(self.run_on(*builds, all_builds="1"), 1)
