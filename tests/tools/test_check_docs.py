from support import TreeTest

import check_docs


class Docs(TreeTest):
    def says(self, text):
        self.write("docs/page.md", text)
        return check_docs.faults(self.root)

    def test_true_documents_pass(self):
        self.write("src/tactum/base/result.h")
        self.write("run")
        self.write("app/CMakeLists.txt", "add_executable(tactum main.cpp)\n")
        self.write("tests/math/x_test.cpp")
        self.write("docs/references.bib", "@article{Gregory2000,\n}\n@inproceedings{LinCanny1991,\n}\n")
        text = """See [the tour](page.md#one-frame), [outside](https://example.org/x) and `src/tactum/base/result.h`,
            `base/result.h`, `./run --build-only`, `build/release/tactum`, `X=1 build/dev/tests/test_math -v`, `--json FILE`, `n . (a/b)`, `N/m`,
            [Gregory 2000, 4.1; Lin and Canny 1991]
            """
        self.assertEqual(list(self.says(text)), [])

    def test_broken_links_are_caught(self):
        self.assert_one_fault(self.says("text\n\n[gone](away.md)"), "page.md:3", "away.md")

    def test_paths_that_do_not_exist_are_caught(self):
        self.assert_one_fault(self.says("see `src/tactum/base/gone.h`"), "page.md:1", "gone.h")
        self.assert_one_fault(self.says("see `gone.md`"), "gone.md")
        self.assert_one_fault(self.says("type `./gone --now`"), "./gone")

    def test_files_that_a_command_of_the_page_names_are_the_readers_own(self):
        self.assertEqual(list(self.says("see `out.json`\n```sh\ntactum feel --json out.json\n```\n")), [])
        self.assert_one_fault(self.says("see `out.json`\n```\ntactum feel --json out.json\n```\n"), "out.json")

    def test_programs_that_nothing_builds_are_caught(self):
        self.assert_one_fault(self.says("by `build/release/bench_pairs --all`"), "page.md:1", "bench_pairs")

    def test_code_blocks_are_left_alone(self):
        self.assertEqual(list(self.says("```\n`a/b.h` [x](y.md)\n```\n")), [])

    def test_quotes_must_be_the_whole_file_as_it_is(self):
        self.write("examples/a.cpp", "int main() {}\n")
        self.assertEqual(list(self.says("```cpp examples/a.cpp\nint main() {}\n```\n")), [])
        self.assert_one_fault(self.says("text\n```cpp examples/a.cpp\nint main() { }\n```\n"), "page.md:2", "not as it is")

    def test_quotes_of_files_that_do_not_exist_are_caught(self):
        self.assert_one_fault(self.says("```cpp examples/gone.cpp\nint x;\n```\n"), "page.md:1", "gone.cpp")

    def test_examples_that_no_document_quotes_are_caught(self):
        self.write("examples/a.cpp", "int main() {}\n")
        self.assert_one_fault(self.says("nothing"), "examples/a.cpp")

    def test_unknown_sources_are_caught(self):
        self.write("docs/references.bib", "@article{Gregory2000,\n}\n")
        self.write("src/x.h", "/// [Gregory 2000, 5.1; Mirtich 1998]\n")
        self.assert_one_fault(check_docs.faults(self.root), "x.h:1", "Mirtich1998")
