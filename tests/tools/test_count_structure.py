from support import TreeTest

import count_structure

MANY = ", ".join(f"m{i} = {i}" for i in range(13))


class Structure(TreeTest):
    def scan(self, text):
        return count_structure.Scan(text)

    def test_public_data_is_counted(self):
        text = """struct A {
            A(int x) : a(x), b{x} {}
            int a = 0, b{0};  // int c;
            std::function<void(int, int)> call;
            std::vector<std::pair<int, int>> pairs = {{1, 2}, {3, 4}};
            static constexpr int kNone = 0;
            using Index = int;
            void f(int x);
            int g() const { int y = 0; return y; }
            struct Inner { int i; };
            enum class Kind { kOne, kTwo };
           private:
            int hidden = 0;
          };"""
        self.assertEqual(sorted(self.scan(text).types), [("A", 4), ("Inner", 1)])

    def test_classes_begin_private(self):
        self.assertEqual(self.scan("class A : public B { int a; public: int b; };").types, [("A", 1)])

    def test_functions_are_measured_by_their_braces(self):
        text = "namespace n {\nint f(int a,\n      int b) noexcept {\n  if (a) {\n  }\n  return 1;\n}\n}  // n\n"
        self.assertEqual(self.scan(text).functions, [("f", 3, 5)])
        self.assertEqual(self.scan("A::A(int a) : b(a) {\n}\nint v = g(1);\nint w{2};\n").functions[0][0], "A")
        self.assertEqual(self.scan('extern "C" {\nvoid f() {}\n}\n').functions, [("f", 2, 1)])

    def test_only_large_types_that_are_changed_count(self):
        self.write("src/tactum/math/a.h", f"struct Big {{ int {MANY}; }};\nstruct BigReport {{ int {MANY}; }};\n")
        self.write("src/tactum/math/a.cpp", "int f(const Big& b, int c);\nvoid g(BigReport& r);\n")
        self.assertEqual(count_structure.shared_states(self.root), [])
        self.write("src/tactum/math/b.cpp", "void f(int a, Big& b) {}\n")
        self.assert_one_fault(count_structure.shared_states(self.root), "Big", "13", "a.h")

    def test_circles_are_found(self):
        self.write("src/tactum/math/a.h", '#include "tactum/base/z.h"\n')
        self.write("src/tactum/math/a.cpp", '#include "tactum/math/a.h"\n#include "tactum/math/b.h"\n')
        self.write("src/tactum/math/b.h")
        self.assertEqual(count_structure.circles(self.root), [])
        self.write("src/tactum/math/b.h", '#include "tactum/math/a.h"\n')
        self.assert_one_fault(count_structure.circles(self.root), "math/a", "math/b")

    def test_as_few_arrows_as_needed_are_back(self):
        arrows = {"state": {"a", "b", "c"}, "a": {"state"}, "b": {"state", "a"}, "c": set(), "top": {"a"}}
        self.assertEqual(count_structure.back_arrows(arrows), [("a", "state"), ("b", "state")])

    def test_long_files_and_functions_and_large_folders(self):
        self.write("app/x.cpp", "void f() {\n" + "a();\n" * 59 + "}\n")
        self.assert_one_fault(count_structure.long_functions(self.root), "f, 61 lines", "x.cpp:1")
        self.write("app/x.cpp", "int x;\n" * 501)
        self.assert_one_fault(count_structure.long_files(self.root), "501")
        self.write("viewer/web/src/x.ts", "function f(a: number): void {\n" + "if (a) { b(); }\n" * 60 + "}\n")
        self.assert_one_fault(count_structure.long_functions(self.root), "x.ts:1", "f, 62 lines")
        for i in range(26):
            self.write(f"src/tactum/math/h{i}.h")
        self.assert_one_fault(count_structure.large_folders(self.root), "26 headers")
