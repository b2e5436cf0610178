#!/usr/bin/env python3
"""Keeps replaced words out of identifiers:  tools/check_words.py [--lower] [ROOT]

A column `replaces` of a table in docs/glossary.md names, in backticks, the words that its term stands in for: `doubt`,
or several in a row, as in `hand_on`. An identifier, in C++ or TypeScript, is split at underscores and where a capital
follows; it is at fault when the parts hold such a word. Comments, strings and the names of tests are left alone.

Words whose renaming is not finished stand in tools/words_baseline.txt with the number of different identifiers that
still hold them: there may be fewer, never more. A word that does not stand there has none. --lower writes the numbers
that have sunk into that file.
"""
import pathlib
import re
import sys

LOOKED_AT = ("src", "app", "viewer/server", "viewer/web/src", "tests", "bench", "fuzz", "examples")
SUFFIXES = (".h", ".cpp", ".ts", ".inl")
GLOSSARY = "docs/glossary.md"
BASELINE = "tools/words_baseline.txt"

BACKTICKS = re.compile(r"`([^`\n]+)`")
COMMENT_OR_STRING = re.compile(r"//[^\n]*|/\*.*?\*/|R\"(\w*)\(.*?\)\1\"|\"(?:\\.|[^\"\\\n])*\"|`(?:\\.|[^`\\])*`"
                               r"|(?<!\w)'(?:\\.|[^'\\\n])*'|^\s*#\s*include[^\n]*", re.DOTALL | re.MULTILINE)
TEST_NAME = re.compile(r"\b(?:TEST|TEST_F|TEST_P|INSTANTIATE_TEST_SUITE_P)\s*\([^)]*\)")
IDENTIFIER = re.compile(r"(?<![\w.])[A-Za-z_]\w*|(?<=\.)[A-Za-z_]\w*")
PART = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+")


def cells(line):
    return [cell.strip() for cell in line.strip().strip("|").split("|")]


def replaced_words(text):
    """Word -> the term that is used instead, from every table of the glossary with a column `replaces`."""
    words = {}
    column = None
    for line in text.splitlines():
        if not line.lstrip().startswith("|"):
            column = None
        elif column is None:
            column = cells(line).index("replaces") if "replaces" in cells(line) else -1
        elif column >= 0 and column < len(cells(line)):
            for word in BACKTICKS.findall(cells(line)[column]):
                words.setdefault(word, []).append(cells(line)[0])
    return {word: " or ".join(terms) for word, terms in words.items()}


def parts_of(identifier):
    """The words of an identifier: X_WB_atHand2 -> x, wb, at, hand, 2."""
    return tuple(part.lower() for part in PART.findall(identifier))


def holds(parts, word):
    """Whether the parts of `word` stand in a row among these."""
    return any(parts[first : first + len(word)] == word for first in range(len(parts) - len(word) + 1))


def identifiers(root):
    """Identifier -> the first place where it stands, over all sources."""
    found = {}
    for top in (root / name for name in LOOKED_AT):
        for path in sorted(top.rglob("*")) if top.is_dir() else []:
            if path.suffix not in SUFFIXES or "node_modules" in path.parts:
                continue
            text = COMMENT_OR_STRING.sub(lambda match: " " + "\n" * match.group(0).count("\n"), path.read_text())
            text = TEST_NAME.sub(lambda match: " " + "\n" * match.group(0).count("\n"), text)
            for number, line in enumerate(text.splitlines(), 1):
                for name in IDENTIFIER.findall(line):
                    found.setdefault(name, f"{path.relative_to(root).as_posix()}:{number}")
    return found


def uses(root):
    """Word -> the identifiers that hold it, each with its first place."""
    glossary = root / GLOSSARY
    words = {word: parts_of(word) for word in replaced_words(glossary.read_text())} if glossary.exists() else {}
    by_first = {}
    for word, wanted in words.items():
        by_first.setdefault(wanted[0], []).append(word)
    found = {word: [] for word in words}
    for name, place in identifiers(root).items():
        parts = parts_of(name)
        for word in {word for part in parts for word in by_first.get(part, ())}:
            if holds(parts, words[word]):
                found[word].append((name, place))
    return found


def baseline(root):
    """Word -> how many identifiers may hold it still."""
    path = root / BASELINE
    lines = path.read_text().splitlines() if path.exists() else []
    return {line.split()[0]: int(line.split()[1]) for line in lines if line.strip() and not line.startswith("#")}


def faults(root, used=None):
    """Everything that is wrong under `root`, a sentence each; `used`: uses(root), where known."""
    glossary = root / GLOSSARY
    terms = replaced_words(glossary.read_text()) if glossary.exists() else {}
    allowed = baseline(root)
    for word in allowed:
        if word not in terms:
            yield f"{BASELINE}: {word} is not replaced by any term of {GLOSSARY}"
    for word, found in (uses(root) if used is None else used).items():
        if len(found) > allowed.get(word, 0):
            shown = ", ".join(f"{name} ({place})" for name, place in sorted(found)[:8])
            yield (f"{len(found)} identifiers hold '{word}', {allowed.get(word, 0)} may; the glossary says"
                   f" '{terms[word]}': {shown}")


def lower(root):
    """Writes the numbers that have sunk into the baseline; words that are gone leave it."""
    path = root / BASELINE
    head = [line for line in path.read_text().splitlines() if line.startswith("#")]
    found = uses(root)
    counts = {word: min(most, len(found.get(word, ()))) for word, most in baseline(root).items()}
    path.write_text("\n".join(head + [f"{word} {count}" for word, count in sorted(counts.items()) if count]) + "\n")


def main(arguments):
    places = [argument for argument in arguments if not argument.startswith("--")]
    root = pathlib.Path(places[0] if places else pathlib.Path(__file__).parent.parent).resolve()
    if "--lower" in arguments:
        lower(root)
    used = uses(root)
    found = list(faults(root, used))
    for fault in found:
        print(fault)
    left = sum(len(names) for names in used.values())
    print(f"words: {len(found)} faults, {left} identifiers hold a word that is being replaced")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
