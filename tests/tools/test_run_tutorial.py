"""tools/run_tutorial.py finds every command of a page that fails and every shown line that is not printed."""
import os
import unittest

import support

import run_tutorial


class Faults(support.TreeTest):
    def faults(self, page):
        folder = self.root / "empty"
        folder.mkdir(exist_ok=True)
        return list(run_tutorial.faults(page, folder, dict(os.environ), self.root))

    def test_a_page_that_is_right_has_none(self):
        page = "```sh\necho one; echo two three\n```\ntext\n```text\ntwo three\none\n```\n"
        self.assertEqual(self.faults(page), [])

    def test_a_line_that_is_not_printed_is_told_with_what_was(self):
        self.assert_one_fault(self.faults("```sh\necho 41 N\n```\n```text\n42 N\n```\n"), "line 4", "42 N", "41 N")

    def test_dots_stand_for_anything_in_a_line_and_nothing_else_is_a_pattern(self):
        self.assertEqual(self.faults("```sh\necho 'mean 3.1 us (max 9)'\n```\n```text\nmean ... (max 9)\n```\n"), [])
        self.assert_one_fault(self.faults("```sh\necho 341\n```\n```text\n3.1\n```\n"), "3.1")

    def test_dots_do_not_reach_into_the_next_line(self):
        self.assert_one_fault(self.faults("```sh\necho one; echo two\n```\n```text\none ... two\n```\n"), "one ... two")

    def test_a_command_that_fails_ends_the_page(self):
        page = "```sh\necho before; false\necho behind\n```\n```sh\necho more\n```\n```text\nnothing\n```\n"
        self.assert_one_fault(self.faults(page), "line 1", "ended with 1", "before")

    def test_a_quoted_file_lies_in_the_folder(self):
        self.write("examples/tutorial/a.py", "print(6 * 7)\n")
        page = "```python examples/tutorial/a.py\nprint(6 * 7)\n```\n```sh\npython3 a.py\n```\n```text\n42\n```\n"
        self.assertEqual(self.faults(page), [])

    def test_blocks_without_a_language_are_not_run(self):
        self.assert_one_fault(self.faults("```\nfalse\n```\n\n    false\n"), "runs nothing")

    def test_output_before_any_command_is_a_fault(self):
        self.assert_one_fault(self.faults("```text\nout\n```\n```sh\ntrue\n```\n"), "before any command")


if __name__ == "__main__":
    unittest.main()
