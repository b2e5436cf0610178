from support import TreeTest

import check_words

GLOSSARY = """# Glossary

| term | meaning | replaces |
|---|---|---|
| error bound | how far a distance is off | `doubt`, uncertainty |
| emit | | `hand_on` |
| plain | | |

| term | not a list of words |
|---|---|
| `free` | `word` |
"""


class Words(TreeTest):
    def setUp(self):
        super().setUp()
        self.write("docs/glossary.md", GLOSSARY)

    def code(self, text, name="src/tactum/math/x.h"):
        self.write(name, text)
        return list(check_words.faults(self.root))

    def test_words_come_from_the_column_replaces(self):
        self.assertEqual(check_words.replaced_words(GLOSSARY), {"doubt": "error bound", "hand_on": "emit"})

    def test_identifiers_are_split(self):
        self.assertEqual(check_words.parts_of("kMostDoubt_m"), ("k", "most", "doubt", "m"))
        self.assertEqual(check_words.parts_of("X_WBTrial2"), ("x", "wb", "trial", "2"))

    def test_replaced_words_are_caught(self):
        for name in ("doubt", "doubt_", "kDoubt", "settle_doubt", "Doubt", "handOn", "hand_on_", "to_hand_on"):
            self.assert_one_fault(self.code(f"\nint {name} = 0;\n"), name, "x.h:2")
        self.assert_one_fault(self.code("x.doubt = 1;"), "doubt", "error bound")
        self.write("src/tactum/math/x.h")
        self.assert_one_fault(self.code("const doubtful = lastDoubt;", "viewer/web/src/x.ts"), "lastDoubt")

    def test_other_words_pass(self):
        for name in ("doubtful", "redoubt", "hand", "on", "hand_upon", "on_hand", "free"):
            self.assertEqual(self.code(f"int {name} = 0;\n"), [], name)

    def test_comments_strings_and_names_of_tests_pass(self):
        self.assertEqual(self.code('// doubt\n/* doubt\n*/ #include "doubt.h"\nauto a = "doubt"; auto b = R"(doubt ")";\n'), [])
        self.assertEqual(self.code('#include "tactum/doubt.h"\nTEST(Hand, DoubtIsSmall) {}\n'), [])
        self.assert_one_fault(self.code("auto s = \"a\"; int doubt = 1'000; char c = '\"';\n"), "doubt")

    def test_a_word_that_is_being_replaced_may_only_sink(self):
        self.write("tools/words_baseline.txt", "# words\ndoubt 2\n")
        self.assertEqual(self.code("int doubt, kDoubt, doubt;\n"), [])
        self.assertEqual(self.code("int doubt;\n"), [])
        self.assert_one_fault(self.code("int doubt, kDoubt, doubt_m;\n"), "3 identifiers", "2 may")

    def test_lowering_keeps_the_head_and_never_raises(self):
        self.write("tools/words_baseline.txt", "# words\ndoubt 2\nhand_on 1\n")
        self.code("int doubt;\n")
        check_words.lower(self.root)
        self.assertEqual((self.root / "tools/words_baseline.txt").read_text(), "# words\ndoubt 1\n")
        self.code("int doubt, doubt_m;\n")
        check_words.lower(self.root)
        self.assertEqual((self.root / "tools/words_baseline.txt").read_text(), "# words\ndoubt 1\n")

    def test_a_baseline_of_other_words_is_caught(self):
        self.write("tools/words_baseline.txt", "march 2\n")
        self.assert_one_fault(self.code("int a;\n"), "march", "glossary.md")
