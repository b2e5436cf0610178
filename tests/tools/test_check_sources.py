from support import TreeTest

import check_sources


class Sources(TreeTest):
    def code(self, text, name="src/tactum/math/x.h"):
        self.write(name, text)
        return list(check_sources.faults(self.root))

    def test_epsilons_are_caught(self):
        for literal in ("1e-6", "1e-12", "1.0E-09", "2.5e-4", "1e-04", ".5e-7", "0.00001", "1e-10"):
            self.assert_one_fault(self.code(f"\nbool b = a < {literal};\n"), "x.h:2", literal)

    def test_other_numbers_pass(self):
        for literal in ("1e-3", "0.023e-3", "1e9", "1e300", "0.001", "0.0005", "0x1p-53", "100.0000"):
            self.assertEqual(self.code(f"double a = {literal};\n"), [])

    def test_quantities_with_a_unit_pass(self):
        for code in ("m.inertia_kg_m2 = 2.0e-5;", "m.damping_Nms_per_rad = 1e-4;", "double step = 1e-4;  ///< aimed at [s]",
                     "constexpr double kSubstep_s{1e-4};", "double d = 1e-4;  // [N m s/rad]"):
            self.assertEqual(self.code(code + "\n"), [])
        for code in ("if (a_m < 1e-6) {}", "double eps = 1e-9;  ///< relative [-]", "double e = 1e-9;  // a[i]s"):
            self.assertEqual(len(self.code(code + "\n")), 1, code)

    def test_comments_and_strings_pass(self):
        self.assertEqual(self.code('// 1e-6\n/* 1e-7\n1e-8 */ const char* s = "1e-9 \\" 1e-9";\n'), [])

    def test_a_string_does_not_hide_what_follows(self):
        self.assert_one_fault(self.code('f("// no comment", 1e-6);\n'), "1e-6")

    def test_tolerances_are_at_home(self):
        self.assertEqual(self.code("double a = 1e-12;\n", "src/tactum/base/tolerances.h"), [])

    def test_tests_may_say_what_they_expect(self):
        self.assertEqual(self.code("double a = 1e-12;\n", "tests/math/x_test.cpp"), [])

    def test_long_comments_are_caught(self):
        self.assert_one_fault(self.code("int a;\n  /// " + "x" * 106 + "\n"), "x.h:2", "112 columns")
        self.assertEqual(self.code("  /// " + "x" * 104 + "\nint a = 0;  // " + "y" * 99 + "\n"), [])

    def test_the_frame_stays_short(self):
        frame = "src/tactum/haptics/frame.cpp"
        self.assertEqual(self.code("x\n" * 80, frame), [])
        self.assert_one_fault(self.code("x\n" * 81, frame), "frame.cpp", "81")

    def test_the_namespace_names_the_version(self):
        version = "#define TACTUM_VERSION_MAJOR {}\n#define TACTUM_VERSION_MINOR 7\n"
        for major, wanted, wrong in (0, "v0_7", "v0_71"), (2, "v2", "v0_7"):
            self.write("src/tactum/version.h", version.format(major))
            self.assertEqual(self.code(f"namespace tactum::inline {wanted} {{\n}}\n"), [])
            self.assertEqual(self.code(f"namespace tactum::inline {wanted}::detail {{\n}}\n"), [])
            for start in "tactum", "tactum::detail", f"tactum::inline {wrong}":
                self.assert_one_fault(self.code(f"namespace {start} {{\n}}\n"), "x.h:1", wanted)

    def test_names_of_joined_files_differ(self):
        self.write("src/tactum/math/a.cpp", "constexpr double kFar = 1.0;\nstruct Pair {};\nenum class Side { kIn };\n")
        self.write("src/tactum/mesh/a.cpp", "constexpr double kFar = 1.0;\nstruct Pair {};\n")
        self.assertEqual(self.code("constexpr Vec3 kNear{};\nstruct Pair2;\nvoid f(const Pair&);\n", "src/tactum/math/b.cpp"), [])
        for text, word in (("\nconstexpr int kFar = 2;\n", "kFar"), ("\nstruct Pair : Base {\n", "Pair"), ("\nenum class Side {\n", "Side")):
            self.assert_one_fault(self.code(text, "src/tactum/math/b.cpp"), "b.cpp:2", word)

    def test_things_left_for_later_are_caught(self):
        self.assert_one_fault(self.code("a\n// TODO mend\n"), "x.h:2", "TODO")

    def test_unfinished_merges_are_caught(self):
        self.assert_one_fault(self.code("a\n" + "<" * 7 + " HEAD\nb\n", "tests/CMakeLists.txt"), "CMakeLists.txt:2")

    def test_paths_of_one_machine_are_caught(self):
        self.assert_one_fault(self.code("see /home/ada/tactum\n", "docs/page.md"), "page.md:1")
        self.assertEqual(self.code("see https://example.org/home/ada\n", "docs/page.md"), [])
