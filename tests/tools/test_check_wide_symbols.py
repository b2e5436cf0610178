import unittest

import check_wide_symbols

OWN = """\
libtactum_math.a:rows_wide.cpp.o:0000000000000000 D tactum::columns::kWide
libtactum_math.a:rows_wide.cpp.o:0000000000000000 W tactum::columns::KernelsOf<4ul>::dot(double const*)
libtactum_math.a:rows_wide.cpp.o:0000000000000000 V DW.ref.__gxx_personality_v0
libtactum_math.a:rows_wide.cpp.o:0000000000000000 t (anonymous namespace)::helper()
libtactum_math.a:rows_narrow.cpp.o:0000000000000000 W tactum::columns::KernelsOf<2ul>::dot(double const*)
libtactum_math.a:rows_narrow.cpp.o:0000000000000000 W std::array<float, 3ul>::operator[](unsigned long)
"""


def leaks(listing):
    return list(check_wide_symbols.leaks(check_wide_symbols.shown_symbols(listing)))


class WideSymbols(unittest.TestCase):
    def test_kernels_of_its_own_and_what_is_local_are_allowed(self):
        self.assertEqual(leaks(OWN), [])

    def test_an_inline_function_of_a_wide_file_is_caught(self):
        found = leaks(OWN + "libtactum_math.a:rows_wide.cpp.o:0000000000000010 W std::array<float, 3ul>::operator[](unsigned long)\n")
        self.assertEqual(len(found), 1)
        self.assertIn("no kernel of its own", found[0])

    def test_a_kernel_that_another_file_defines_is_caught(self):
        found = leaks(OWN + "libtactum_math.a:rows_wide.cpp.o:0000000000000010 W tactum::columns::KernelsOf<2ul>::dot(double const*)\n")
        self.assertEqual(len(found), 1)
        self.assertIn("another file defines too", found[0])


if __name__ == "__main__":
    unittest.main()
