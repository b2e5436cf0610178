import subprocess

from support import ROOT, TreeTest

import tidy


class Tidy(TreeTest):
    def findings(self, code):
        path = self.write("x.cpp", code)
        command = ["clang-tidy", f"--config-file={ROOT / '.clang-tidy'}", "--quiet", str(path), "--", "-std=c++20"]
        done = subprocess.run(command, capture_output=True, text=True)
        return done.returncode, done.stdout

    def test_names_as_agreed_pass(self):
        code, said = self.findings("""
            namespace tactum {
            inline constexpr double kWeld = 0.5;
            enum class JointKind { kFree, kFixed };
            struct Setting { double stiffness_Nm_per_rad = 0.0; };
            class Ring {
             public:
              int head() const { return head_; }
             private:
              int head_ = 0;
            };
            double speed(double X_WB, double v_c) { const double F_W = X_WB * v_c; return F_W; }
            }  // namespace tactum
            """)
        self.assertEqual(code, 0, said)

    def test_other_names_and_slips_are_caught(self):
        for wrong in ("struct bad_name {};", "void BadName();", "constexpr int limit = 3;", "enum class E { free };",
                      "class C { int head = 0; };", "int f() { int i; return i; }", "int* p = 0;",
                      "int g(int x) { return x == x; }"):
            code, said = self.findings(wrong + "\n")
            self.assertNotEqual(code, 0, f"{wrong} passed\n{said}")

    def test_only_own_sources_are_chosen(self):
        names = ("src/tactum/base/assert.cpp", "src/tactum/scene/x.cpp", "app/main.cpp", "tests/base/base_test.cpp")
        database = [{"file": str(ROOT / name)} for name in names] + [{"file": "/usr/src/other.cpp"}]
        self.assertEqual(tidy.chosen_sources(database, full=False), [names[0]])
        self.assertEqual(tidy.chosen_sources(database, full=True), sorted(names[:3]))
