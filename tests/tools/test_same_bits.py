import contextlib
import io
import os
import unittest.mock

from support import TreeTest

import same_bits

PROGRAM = """#!/bin/sh
case "$1" in
  record) touch "$2" ;;
  verify) shift; for file in "$@"; do VERIFIES; done ;;
  *) echo gears HASH; echo heap HEAP ;;
esac
exit CODE
"""


class SameBits(TreeTest):
    def program(self, name, frame_hash, code=0, heap="2a", verifies="echo same; echo same"):
        text = PROGRAM.replace("HASH", frame_hash).replace("HEAP", heap).replace("CODE", str(code))
        text = text.replace("VERIFIES", verifies)
        path = self.write(name, text)
        path.chmod(0o755)
        return str(path)

    def run_on(self, *programs, all_builds="0"):
        with unittest.mock.patch.dict(os.environ, TACTUM_ALL_BUILDS=all_builds):
            with contextlib.redirect_stdout(io.StringIO()):
                return same_bits.main(programs)

    def test_equal_hashes_pass(self):
        self.assertEqual(self.run_on(self.program("a", "1f"), self.program("b", "1f")), 0)

    def test_different_hashes_fail(self):
        self.assertEqual(self.run_on(self.program("a", "1f"), self.program("b", "1e")), 1)
        self.assertEqual(self.run_on(self.program("a", "1f"), self.program("b", "1f", heap="2b")), 1)

    def test_a_program_that_fails_is_no_proof(self):
        with self.assertRaises(RuntimeError):
            self.run_on(self.program("a", "1f"), self.program("b", "1f", code=1))

    def test_a_recording_that_another_build_does_not_verify_is_told(self):
        with self.assertRaisesRegex(RuntimeError, "verify: exit code 3"):
            self.run_on(self.program("a", "1f"), self.program("b", "1f", verifies="exit 3"))
        with self.assertRaisesRegex(RuntimeError, "verifies too little"):
            self.run_on(self.program("a", "1f"), self.program("b", "1f", verifies="echo same"))

    def test_one_program_is_nothing_to_compare(self):
        self.assertEqual(self.run_on(self.program("a", "1f"), str(self.root / "gone")), same_bits.SKIPPED)

    def test_a_missing_program_fails_when_all_are_wanted(self):
        programs = (self.program("a", "1f"), self.program("b", "1f"), str(self.root / "gone"))
        self.assertEqual(self.run_on(*programs), 0)
        self.assertEqual(self.run_on(*programs, all_builds="1"), 1)
