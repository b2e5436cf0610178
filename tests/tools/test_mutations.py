"""tools/mutations.py tells every fault of the list of mutations and of its page."""
import contextlib
import io

from support import TreeTest

import mutations

LIST = """
[[mutation]]
name = "smoothing"
without = "smoothing"
file = "src/a.cpp"
find = "smooth(x);"
replace = "x;"
program = "test_a"
test = "Frame.IsSmooth"
"""


class Mutations(TreeTest):
    def setUp(self):
        super().setUp()
        self.write("tests/mutations.toml", LIST)
        self.write("src/a.cpp", "y = smooth(x);\n")
        self.write("tests/a/a_test.cpp", "TEST(Frame, IsSmooth) {}\n")
        self.write("docs/mutations.md", "# Mutations\n" + "".join(mutations.MARKS) + "after\n")
        mutations.write_page(self.root)

    def faults(self):
        return mutations.faults(self.root)

    def test_a_true_list_passes(self):
        self.assertEqual(list(self.faults()), [])
        self.assertIn("after", (self.root / "docs/mutations.md").read_text())

    def test_a_text_that_is_gone_is_told(self):
        self.write("src/a.cpp", "y = x;\n")
        self.assert_one_fault(self.faults(), "smoothing", "0 times")

    def test_a_text_that_stands_twice_is_told(self):
        self.write("src/a.cpp", "smooth(x);\nsmooth(x);\n")
        self.assert_one_fault(self.faults(), "smoothing", "2 times")

    def test_a_file_that_is_gone_is_told(self):
        (self.root / "src/a.cpp").unlink()
        self.assert_one_fault(self.faults(), "src/a.cpp", "not there")

    def test_a_test_that_is_gone_is_told(self):
        self.write("tests/a/a_test.cpp", "TEST(Frame, IsRough) {}\n")
        self.assert_one_fault(self.faults(), "Frame.IsSmooth")

    def test_a_page_that_does_not_show_the_list_is_told(self):
        self.write("docs/mutations.md", "# Mutations\n" + "".join(mutations.MARKS))
        self.assert_one_fault(self.faults(), "docs/mutations.md")

    def test_a_missing_key_is_told(self):
        self.write("tests/mutations.toml", LIST.replace('replace = "x;"', ""))
        self.assert_one_fault(self.faults(), "smoothing", "replace")

    def test_nothing_runs_with_a_faulty_list(self):
        self.write("src/a.cpp", "y = x;\n")
        with contextlib.redirect_stdout(io.StringIO()) as said:
            self.assertEqual(mutations.main(["--run", "--root", str(self.root)]), 1)
        self.assertIn("0 times", said.getvalue())
        self.assertFalse((self.root / mutations.COPY).exists())


class Copying(TreeTest):
    def test_what_is_equal_keeps_its_time_stamp_and_what_is_gone_goes(self):
        self.write("tree/same.cpp", "same")
        self.write("tree/other.cpp", "new")
        self.write("tree/build/left_out.cpp")
        copy = self.root / "copy"
        mutations.copy_tree(self.root / "tree", copy)
        stamp = (copy / "same.cpp").stat().st_mtime_ns
        self.write("copy/other.cpp", "old")
        self.write("copy/gone.cpp")
        mutations.copy_tree(self.root / "tree", copy)
        self.assertEqual((copy / "same.cpp").stat().st_mtime_ns, stamp)
        self.assertEqual((copy / "other.cpp").read_text(), "new")
        self.assertEqual(sorted(path.name for path in copy.iterdir()), ["other.cpp", "same.cpp"])
