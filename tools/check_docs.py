#!/usr/bin/env python3
"""Keeps the documents true:  tools/check_docs.py [ROOT]

In every Markdown file: relative links resolve, and paths in backticks exist, seen from the file, from the root or from
src/tactum, or are the reader's own: a command in an ```sh block of the page names them. Programs under build/ are some that
a CMakeLists.txt makes. In Markdown, C++ and scene files: sources cited as [Name 1999] have their entry in
docs/references.bib. A block that is opened with ```cpp PATH, in any language, is the whole of that file, seen from the
root, and every examples/*.cpp is quoted.
"""
import pathlib
import re
import sys

TEXT_SUFFIXES = (".md", ".h", ".cpp", ".toml")
SKIPPED_FOLDERS = {".git", "build", "out", "node_modules", "__pycache__"}
MADE_BY_BUILDING = ("build/", "out/")

LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")
FENCE = re.compile(r"^(```|~~~).*?^\1\s*$", re.MULTILINE | re.DOTALL)
QUOTE = re.compile(r"^```\w+ (\S+)\n(.*?)^```\s*$", re.MULTILINE | re.DOTALL)
COMMANDS = re.compile(r"^```sh\n(.*?)^```\s*$", re.MULTILINE | re.DOTALL)
BACKTICKS = re.compile(r"`([^`\n]+)`")
# A path: no blanks, no wildcards or placeholders; it ends as a file of this project does, or starts in a known folder
# (so that a unit such as N/m is none).
PATH = re.compile(r"(?:\.{1,2}/)?[\w.+-]+(?:/[\w.+-]+)*/?")
PROGRAM = re.compile(r"build/(?:[\w-]+/)+([\w-]+)")
ADDED_PROGRAM = re.compile(r"^\s*add_executable\(([\w-]+)", re.MULTILINE)
FILE_ENDING = re.compile(r"\.(?:md|h|cpp|py|sh|txt|toml|cmake|bib|json|csv)$")
# [Gregory 2000, 4.1; Lin and Canny 1991]: a name or two, a year, perhaps a place.
ONE_SOURCE = r"[A-Z][A-Za-z-]+(?: and [A-Z][A-Za-z-]+)? (?:19|20)\d\d[a-z]?(?:, [^\];]+)?"
CITATION = re.compile(rf"\[({ONE_SOURCE}(?:; {ONE_SOURCE})*)\](?!\()")
BIB_KEY = re.compile(r"^@\w+\{([^,\s]+),", re.MULTILINE)


def texts(root):
    """Every file of the project that is looked at."""
    for path in sorted(root.rglob("*")):
        inside = path.relative_to(root)
        if path.suffix in TEXT_SUFFIXES and not SKIPPED_FOLDERS.intersection(inside.parts) and path.is_file():
            yield path


def line_of(text, position):
    return text.count("\n", 0, position) + 1


def without_fences(text):
    """The text with code blocks blanked, lines kept."""
    return FENCE.sub(lambda block: "\n" * block.group(0).count("\n"), text)


def looks_like_path(word, bases):
    if not PATH.fullmatch(word):
        return False
    first, slash, _ = word.partition("/")
    return bool(FILE_ENDING.search(word)) or bool(slash) and any((base / first).is_dir() for base in bases)


def link_faults(text, path, root):
    for match in LINK.finditer(without_fences(text)):
        target = match.group(1).split("#")[0]
        if not target or re.match(r"[a-z]+:", target):
            continue
        if not (path.parent / target).exists():
            yield f"{path.relative_to(root)}:{line_of(text, match.start())}: link to {target}, which is not there"


def programs(root):
    """The names of what is built; a folder of tests makes test_FOLDER."""
    names = {f"test_{path.name}" for path in (root / "tests").glob("*") if path.is_dir()}
    for folder in (path for path in root.iterdir() if path.is_dir() and path.name not in SKIPPED_FOLDERS):
        for path in folder.rglob("CMakeLists.txt"):
            names.update(ADDED_PROGRAM.findall(path.read_text()))
    return names


def path_faults(text, path, root, built):
    bases = (path.parent, root, root / "src/tactum")
    readers_own = set(" ".join(COMMANDS.findall(text)).split())
    for match in BACKTICKS.finditer(without_fences(text)):
        for program in PROGRAM.findall(match.group(1)):
            if program not in built:
                yield f"{path.relative_to(root)}:{line_of(text, match.start())}: names {program}, which nothing builds"
        word = match.group(1).split()[0]  # `./run --build-only` names ./run
        if not looks_like_path(word, bases) or word.startswith(MADE_BY_BUILDING) or word in readers_own:
            continue
        if not any((base / word).exists() for base in bases):
            yield f"{path.relative_to(root)}:{line_of(text, match.start())}: names {word}, which is not there"


def citation_faults(text, path, root, keys):
    for match in CITATION.finditer(text):
        for source in match.group(1).split("; "):
            cited = source.split(",")[0]
            key = cited.replace(" and ", "").replace(" ", "")
            if key not in keys:
                place = f"{path.relative_to(root)}:{line_of(text, match.start())}"
                yield f"{place}: cites [{cited}], but docs/references.bib has no {key}"


def quotes(text):
    """Path, text and position of each file that the text quotes whole."""
    for match in QUOTE.finditer(text):
        yield match.group(1), match.group(2), match.start()


def quote_faults(text, path, root):
    for quoted, block, position in quotes(text):
        place = f"{path.relative_to(root)}:{line_of(text, position)}"
        if not (root / quoted).is_file():
            yield f"{place}: quotes {quoted}, which is not there"
        elif (root / quoted).read_text() != block:
            yield f"{place}: quotes {quoted}, but not as it is"


def unquoted_examples(root):
    quoted = {name for path in texts(root) if path.suffix == ".md" for name, _, _ in quotes(path.read_text())}
    for example in sorted(root.glob("examples/*.cpp")):
        name = example.relative_to(root).as_posix()
        if name not in quoted:
            yield f"{name}: no document quotes it"


def faults(root):
    """Everything that is wrong under `root`, a sentence each."""
    bib = root / "docs/references.bib"
    keys = set(BIB_KEY.findall(bib.read_text())) if bib.exists() else set()
    built = programs(root)
    for path in texts(root):
        text = path.read_text()
        if path.suffix == ".md":
            yield from link_faults(text, path, root)
            yield from path_faults(text, path, root, built)
            yield from quote_faults(text, path, root)
        yield from citation_faults(text, path, root, keys)
    yield from unquoted_examples(root)


def main(arguments):
    root = pathlib.Path(arguments[0] if arguments else pathlib.Path(__file__).parent.parent).resolve()
    found = list(faults(root))
    for fault in found:
        print(fault)
    print(f"docs: {len(found)} faults")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
