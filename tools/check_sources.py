#!/usr/bin/env python3
"""Small rules of the sources:  tools/check_sources.py [ROOT]

- Epsilons live in base/tolerances.h, each with its story. Anywhere else in src/ a number written with an exponent of -4
  or less (1e-6), or with as many zeros (0.00001), is a fault, unless it has a unit: in the name it is given to
  (inertia_kg_m2 = 2e-5) or in a tag behind it (///< [N s/m]). A quantity that can have neither is written in thousandths
  (0.023e-3), a conversion as a division (nanoseconds / 1e9): none of them can be mistaken for a tolerance.
- Comments are wrapped by hand, at most 110 columns: clang-format would break the drawings in them.
- haptics/frame.cpp is read from top to bottom: at most 80 lines.
- The library's namespace holds an inline one that names the version, v0_1 for 0.1.x and v1 for 1.x, so that two versions
  can be linked into one program.
- The files of a layer are compiled several at a time, and the compiler's preset decides which: a constant or type that a
  .cpp file defines at the margin has a name that no other .cpp file of that layer gives to its own.
- Nothing is left for later, no merge is left unfinished, and no file knows the folders of the machine it was written on.
"""
import pathlib
import re
import sys

FRAME_LINES = 80
COMMENT_COLUMNS = 110
LOOKED_AT = ("src", "app", "viewer/server", "viewer/web/src", "tests", "bench", "fuzz", "examples", "scenes", "docs", "cmake", "README.md", "CMakeLists.txt", "run",
             "test")
SUFFIXES = (".h", ".cpp", ".md", ".toml", ".cmake", ".txt", ".bib", ".ts", ".mjs", ".css", "")

COMMENT_OR_STRING = re.compile(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"', re.DOTALL)
EPSILON = re.compile(r"(?<![\w.])(?:\d[\d']*\.?\d*|\.\d+)[eE]-0*(?:[4-9]|[1-9]\d+)\b|(?<![\w.])0?\.0000\d*(?![\w.])")
UNIT = r"(?:kg|N|Nm|Ns|Nms|m|m2|m3|s|rad|J|W|Hz)(?:_(?:per_)?(?:kg|N|Nm|m|m2|m3|s|s2|rad|rad2))*"
NAMED_QUANTITY = re.compile(rf"_{UNIT}\s*(?:=|\{{)\s*-?$")
TAGGED_QUANTITY = re.compile(r"//.*\[(?:kg|N|m|s|rad|J|W|Hz)\b[^\]\n]*\]")
LONG_COMMENT = re.compile(rf"^(?=[ \t]*//)[^\n]{{{COMMENT_COLUMNS + 1},}}$", re.MULTILINE)
NAMESPACE = re.compile(r"^namespace tactum\b[^\n]*", re.MULTILINE)
VERSION = re.compile(r"^#define TACTUM_VERSION_(MAJOR|MINOR) (\d+)$", re.MULTILINE)
DEFINED_IN_FILE = re.compile(r"^(?:constexpr|const|struct|class|enum(?: class)?)\b[^\n(=;{]*?(\w+) *(?=[={:]|final\b)(?!::)", re.MULTILINE)
FOR_LATER = re.compile(r"\b(?:TODO|FIXME|XXX|HACK)\b")
UNFINISHED_MERGE = re.compile(r"^(?:<{7}|>{7}) \S+", re.MULTILINE)
MACHINE_PATH = re.compile(r"(?<![\w.~*-])/(?:home|root|work|Users|tmp)/\w")


def places(pattern, text):
    """Line number and match of each finding."""
    for match in pattern.finditer(text):
        yield text.count("\n", 0, match.start()) + 1, match.group(0)


def code_only(text):
    """C++ with comments and strings blanked, lines kept."""
    return COMMENT_OR_STRING.sub(lambda found: " " + "\n" * found.group(0).count("\n"), text)


def epsilon_faults(text, name):
    lines = text.splitlines()
    for number, line in enumerate(code_only(text).splitlines()):
        for match in EPSILON.finditer(line):
            if not NAMED_QUANTITY.search(line[: match.start()]) and not TAGGED_QUANTITY.search(lines[number]):
                place = f"{name}:{number + 1}"
                yield f"{place}: {match.group(0)} looks like an epsilon; those live in base/tolerances.h (a quantity has a unit)"


def versioned_namespace(root):
    """How the library's namespace begins, by its version; empty where the tree has no version."""
    path = root / "src/tactum/version.h"
    version = dict(VERSION.findall(path.read_text())) if path.is_file() else {}
    if not version:
        return ""
    return "namespace tactum::inline v" + (version["MAJOR"] if version["MAJOR"] != "0" else f"0_{version['MINOR']}")


def clashes_of_joined_files(root):
    """Names that two files of a layer define, each for itself."""
    for layer in sorted((root / "src/tactum").glob("*/")):
        first = {}
        for path in sorted(layer.glob("*.cpp")):
            for line, _ in places(DEFINED_IN_FILE, text := code_only(path.read_text())):
                word = DEFINED_IN_FILE.match(text.splitlines()[line - 1]).group(1)
                place = f"{path.relative_to(root).as_posix()}:{line}"
                if first.setdefault(word, place) != place:
                    yield f"{place}: {word} is defined in {first[word]} too, and files of a layer are compiled together"


def faults(root):
    """Everything that is wrong under `root`, a sentence each."""
    namespace = versioned_namespace(root)
    yield from clashes_of_joined_files(root)
    for top in (root / name for name in LOOKED_AT):
        for path in sorted(top.rglob("*")) if top.is_dir() else [top]:
            name = path.relative_to(root).as_posix()
            if not path.is_file() or path.suffix not in SUFFIXES or name.startswith("tests/tools/"):
                continue
            text = path.read_text()
            for line, word in places(FOR_LATER, text):
                yield f"{name}:{line}: {word} leaves something for later"
            for line, word in places(UNFINISHED_MERGE, text):
                yield f"{name}:{line}: {word} was left by a merge"
            for line, word in places(MACHINE_PATH, text):
                yield f"{name}:{line}: {word}... is a path of one machine"
            for line, words in places(LONG_COMMENT, text) if path.suffix in (".h", ".cpp") else ():
                yield f"{name}:{line}: a comment of {len(words)} columns; there is room for {COMMENT_COLUMNS}"
            if name.startswith("src/") and path.suffix in (".h", ".cpp") and name != "src/tactum/base/tolerances.h":
                yield from epsilon_faults(text, name)
            for line, found in places(NAMESPACE, text) if name.startswith("src/tactum/") else ():
                if not re.match(re.escape(namespace) + r"(?!\w)", found):
                    yield f"{name}:{line}: found {found.rstrip(' {')}, expected {namespace}"
            if name == "src/tactum/haptics/frame.cpp" and text.count("\n") > FRAME_LINES:
                yield f"{name}: {text.count(chr(10))} lines; the frame is read at one glance, in at most {FRAME_LINES}"


def main(arguments):
    root = pathlib.Path(arguments[0] if arguments else pathlib.Path(__file__).parent.parent).resolve()
    found = list(faults(root))
    for fault in found:
        print(fault)
    print(f"sources: {len(found)} faults")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
