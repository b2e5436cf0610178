from support import ROOT, TreeTest

import check_layers


class Layers(TreeTest):
    def setUp(self):
        super().setUp()
        for layer in ("base", "math", "devices", "loop", "geometry", "dynamics", "haptics", "telemetry"):
            self.write(f"src/tactum/{layer}/README.md", f"{layer}\n")

    def includes(self, layer, *names):
        self.write(f"src/tactum/{layer}/x.cpp", "// first line\n" + "".join(f'#include "{name}"\n' for name in names))
        return check_layers.faults(self.root)

    def test_what_stands_to_the_left_is_allowed(self):
        names = ("tactum/haptics/y.h", "tactum/devices/d.h", "tactum/geometry/g.h", "tactum/base/b.h", "vector", "fmt/core.h")
        self.assertEqual(list(self.includes("haptics", *names)), [])

    def test_what_stands_to_the_right_is_caught(self):
        self.assert_one_fault(self.includes("math", "tactum/base/b.h", "tactum/haptics/frame.h"), "x.cpp:3", "haptics/frame.h")

    def test_layers_side_by_side_do_not_see_each_other(self):
        self.assert_one_fault(self.includes("loop", "tactum/geometry/g.h"), "geometry/g.h")
        self.write("src/tactum/loop/x.cpp")
        self.assert_one_fault(self.includes("dynamics", "tactum/collision/c.h"), "collision/c.h")
        self.write("src/tactum/dynamics/x.cpp")
        self.assert_one_fault(self.includes("telemetry", "tactum/scene/s.h"), "scene/s.h")

    def test_devices_and_geometry_do_not_see_each_other(self):
        self.assert_one_fault(self.includes("devices", "tactum/geometry/g.h"), "geometry/g.h")
        self.write("src/tactum/devices/x.cpp")
        self.assert_one_fault(self.includes("geometry", "tactum/devices/d.h"), "devices/d.h")

    def test_the_umbrella_is_caught(self):
        self.assert_one_fault(self.includes("haptics", "tactum/tactum.h"), "umbrella")

    def test_short_paths_are_caught(self):
        self.assert_one_fault(self.includes("haptics", "../base/b.h"), "from the root")

    def test_angle_brackets_do_not_hide(self):
        self.write("src/tactum/base/x.h", "#  include <tactum/math/m.h>\n")
        self.write("src/tactum/base/README.md", "`x.h`\n")
        self.assert_one_fault(check_layers.faults(self.root), "x.h:1", "math/m.h")

    def test_unknown_layers_are_caught(self):
        self.write("src/tactum/extras/x.cpp")
        self.assert_one_fault(check_layers.faults(self.root), "extras")
        self.write("src/tactum/extras/x.cpp").unlink()
        (self.root / "src/tactum/extras").rmdir()
        self.assert_one_fault(self.includes("base", "tactum/extras/x.h"), "nobody knows")

    def test_cycles_inside_a_layer_are_caught(self):
        self.write("src/tactum/math/README.md", "`a` `b` `c`\n")
        self.write("src/tactum/math/a.h", '#include "tactum/math/b.h"\n')
        self.write("src/tactum/math/b.cpp", '#include "tactum/math/b.h"\n#include "tactum/math/c.h"\n')
        self.write("src/tactum/math/b.h")
        self.write("src/tactum/math/c.h")
        self.assertEqual(list(check_layers.faults(self.root)), [])
        self.write("src/tactum/math/c.h", '#include "tactum/math/a.h"\n')
        self.assert_one_fault(check_layers.faults(self.root), "src/tactum/math", "a -> b -> c -> a")

    def test_large_layers_are_caught(self):
        names = [f"x{i}" for i in range(check_layers.MOST_HEADERS + 1)]
        self.write("src/tactum/math/README.md", " ".join(f"`{name}`" for name in names))
        for name in names:
            self.write(f"src/tactum/math/{name}.h")
        self.assert_one_fault(check_layers.faults(self.root), "26 headers")
        (self.root / "src/tactum/math/x0.h").unlink()
        self.assertEqual(list(check_layers.faults(self.root)), [])

    def test_headers_without_caption_are_caught(self):
        self.write("src/tactum/math/pose.h")
        self.assert_one_fault(check_layers.faults(self.root), "math/README.md", "`pose.h`")
        for name in ("pose.h", "pose"):
            self.write("src/tactum/math/README.md", f"- `{name}`: where a frame is.\n")
            self.assertEqual(list(check_layers.faults(self.root)), [])

    def test_a_missing_readme_is_caught(self):
        self.write("src/tactum/collision/x.cpp")
        self.assert_one_fault(check_layers.faults(self.root), "collision/README.md")

    def test_cmake_names_the_same_order(self):
        text = (ROOT / "CMakeLists.txt").read_text()
        for layer, below in check_layers.STANDS_ON.items():
            line = next(line for line in text.splitlines() if line.startswith(f"tactum_layer({layer} "))
            uses = {word.rstrip(")")[len("tactum_"):] for word in line.split() if word.startswith("tactum_") and "(" not in word}
            self.assertEqual(uses, set(below), line)
