#!/usr/bin/env python3
"""Counts what makes a house hard to read, and lists it:  tools/count_structure.py [--list] [ROOT]

- shared states: types of src/ with more than 12 public data members that some function takes to change. Plain reports
  and settings are not counted, by their names (FrameReport, FrameSettings, RunRecord...).
- circles: a room is a header with its source. Of the include arrows between the rooms of a layer as many are counted as
  must go before no circle is left (found greedily); a layer whose includes run one way has none.
- long files (over 500 lines), long functions (over 60, from the opening brace to the closing one), large folders (over
  25 headers), and identifiers that hold a word which docs/glossary.md replaces.

The text is read without a compiler: macros that open braces, or declarations made by macros, would mislead it.
"""
import pathlib
import re
import sys

import check_words

MOST_MEMBERS, MOST_FILE_LINES, MOST_FUNCTION_LINES, MOST_HEADERS = 12, 500, 60, 25
CODE = ("src", "app", "viewer/server", "viewer/web/src", "tests", "bench", "fuzz", "examples")
PLAIN = re.compile(r"(?:Report|Record|Settings|Options|Limits|Work|Setup)$")
INCLUDE = re.compile(r'^\s*#\s*include\s*"tactum/([^"]+)"', re.MULTILINE)
DIRECTIVE = re.compile(r"^[ \t]*#(?:[^\n]*\\\n)*[^\n]*", re.MULTILINE)
TYPE = re.compile(r"\b(struct|class|union)\s+(?:\[\[[^\]]*\]\]\s*)?(\w+)[^;{}()=]*$")
NOT_A_FUNCTION = re.compile(r"(?:^|[^\w])(?:if|for|while|switch|catch|return|else|do)\b[^{]*$")
NOT_DATA = re.compile(r"^\s*(?:using|typedef|friend|static|template|enum|struct|class|union|operator|static_assert)\b")
ANGLES = re.compile(r"<[^<>;{}]*>")


def blanked(text):
    """The text without comments, strings and directives; lines kept."""
    text = check_words.COMMENT_OR_STRING.sub(lambda found: " " + "\n" * found.group(0).count("\n"), text)
    return DIRECTIVE.sub(lambda found: "\n" * found.group(0).count("\n"), text)


def closing(text, opened):
    """Where the brace at `opened` is closed."""
    depth = 0
    for at in range(opened, len(text)):
        depth += {"{": 1, "}": -1}.get(text[at], 0)
        if depth == 0:
            return at
    return len(text)


def without_angles(text):
    """Template arguments taken out, the innermost first; `operator<` and `->` are left alone."""
    text = text.replace("->", "  ").replace("operator<", "operator ")
    while (shorter := ANGLES.sub("", text)) != text:
        text = shorter
    return text


class Scan:
    """The types and functions of one text: types as (name, public data members), functions as (name, line, lines)."""

    def __init__(self, text):
        self.text, self.types, self.functions = blanked(text), [], []
        self.members(0, len(self.text), None, True)

    def members(self, start, end, name, public):
        """Reads what stands between two places of a file, a namespace (no name) or a type; returns its public data."""
        data, head, at = 0, start, start
        while at < end:
            letter = self.text[at]
            if letter == ";":
                data += public and self.data_in(self.text[head:at])
                head = at + 1
            elif letter == ":" and re.search(r"\b(public|private|protected)\s*$", self.text[head:at]):
                public = self.text[head:at].split()[-1] == "public"
                head = at + 1
            elif letter == "{":
                last = closing(self.text, at)
                if self.opened(self.text[head:at], at, last):
                    head = last + 1
                at = last
            at += 1
        if name:
            self.types.append((name, data))
        return data

    def opened(self, head, at, last):
        """Looks at what a brace opens; whether the declaration ends with it."""
        if not head.strip():
            return True
        if re.search(r"\bnamespace\b[^;={}()]*$", head) or re.search(r"\bextern\s*$", head):
            self.members(at + 1, last, None, True)
            return True
        if re.search(r"\benum\b[^()]*$", head):
            return False
        found = TYPE.search(without_angles(head))
        if found:
            self.members(at + 1, last, found.group(2), found.group(1) != "class")
            return False
        call = re.search(r"(~?\w+)\s*\(", without_angles(head))
        if call is None or "=" in head.split("(")[0].replace("operator=", "") and "[" not in head:
            return False
        lines = self.text.count("\n", at, last) + 1
        self.functions.append((call.group(1), self.text.count("\n", 0, at) + 1, lines))
        return True

    @staticmethod
    def data_in(statement):
        """How many data members a statement declares."""
        text = re.sub(r"\[\[.*?\]\]", "", statement)
        while (shorter := re.sub(r"\{[^{}]*\}", "", text)) != text:
            text = shorter
        text = without_angles(text)
        if not text.split() or NOT_DATA.match(text) or "(" in text.split("=")[0]:
            return 0
        while (shorter := re.sub(r"\([^()]*\)", "", text)) != text:
            text = shorter
        return text.count(",") + 1


def functions_of_script(text):
    """Named functions and methods of TypeScript: name, line, lines."""
    text = blanked(text)
    for found in re.finditer(r"(\w+)\s*(?:<[^<>]*>)?\([^{};]*\)\s*(?::[^{};=]+)?\{", text):
        opened = found.end() - 1
        if found.group(1) not in ("if", "for", "while", "switch", "catch"):
            yield found.group(1), text.count("\n", 0, found.start()) + 1, text.count("\n", opened, closing(text, opened)) + 1


def sources(root, folders, suffixes):
    for folder in folders:
        for path in sorted((root / folder).rglob("*")) if (root / folder).is_dir() else []:
            if path.suffix in suffixes and "node_modules" not in path.parts:
                yield path


def shared_states(root):
    types, changed = [], {}
    for path in sources(root, ("src",), (".h", ".cpp")):
        name, scan = path.relative_to(root).as_posix(), Scan(path.read_text())
        types += [(name, kind, data) for kind, data in scan.types if data > MOST_MEMBERS and not PLAIN.search(kind)]
        changed[name] = set(re.findall(r"(?<!const )\b(\w+)\s*&\s*\w+\s*[,)]", re.sub(r"\s+", " ", scan.text)))
    anywhere = set().union(*changed.values())
    return [f"{name}: {kind}, {data} public data members" for name, kind, data in sorted(types)
            if kind in (anywhere if name.endswith(".h") else changed[name])]


def rooms_of(root, layer):
    """Room -> the rooms of the same layer that it includes."""
    arrows = {}
    for path in sources(root, (f"src/tactum/{layer}",), (".h", ".cpp")):
        room = path.relative_to(root / "src/tactum").with_suffix("").as_posix()
        arrows.setdefault(room, set())
        for name in INCLUDE.findall(path.read_text()):
            other = name.rsplit(".", 1)[0]
            if other != room and other.startswith(layer + "/"):
                arrows[room].add(other)
    return arrows


def back_arrows(arrows):
    """Arrows without which no circle is left: rooms are laid in a row, each time one that needs, or is needed by, none
    of the rest, else the one that is needed most beyond what it needs [the heuristic of Eades, Lin and Smyth]."""
    left = {room: {other for other in others if other in arrows} for room, others in arrows.items()}
    below, above = [], []
    while left:
        needed = {room: sum(room in others for others in left.values()) for room in left}
        needs = {room: len(others) for room, others in left.items()}
        free = sorted(room for room in left if not needs[room])
        roofs = sorted(room for room in left if not needed[room])
        if free:
            chosen = free[0]
            below.append(chosen)
        elif roofs:
            chosen = roofs[0]
            above.append(chosen)
        else:
            chosen = max(sorted(left), key=lambda room: needed[room] - needs[room])
            below.append(chosen)
        left = {room: others - {chosen} for room, others in left.items() if room != chosen}
    place = {room: at for at, room in enumerate(below + above[::-1])}
    return sorted((room, other) for room, others in arrows.items() for other in others
                  if other in place and place[other] > place[room])


def circles(root):
    layers = sorted(path.name for path in (root / "src/tactum").iterdir() if path.is_dir())
    return [f"{room} includes {other}" for layer in layers for room, other in back_arrows(rooms_of(root, layer))]


def long_files(root):
    found = []
    for path in sources(root, CODE, (".h", ".cpp", ".ts", ".mjs")):
        lines = path.read_text().count("\n")
        if lines > MOST_FILE_LINES:
            found.append(f"{path.relative_to(root).as_posix()}: {lines} lines")
    return found


def long_functions(root):
    found = []
    for path in sources(root, CODE, (".h", ".cpp", ".ts")):
        text = path.read_text()
        functions = functions_of_script(text) if path.suffix == ".ts" else Scan(text).functions
        found += [f"{path.relative_to(root).as_posix()}:{line}: {name}, {lines} lines" for name, line, lines in functions
                  if lines > MOST_FUNCTION_LINES]
    return found


def large_folders(root):
    headers = {}
    for path in sources(root, ("src",), (".h",)):
        folder = path.parent.relative_to(root).as_posix()
        headers[folder] = headers.get(folder, 0) + 1
    return [f"{folder}: {count} headers" for folder, count in sorted(headers.items()) if count > MOST_HEADERS]


def replaced_words(root):
    return sorted(f"{place}: {name} ({word})" for word, found in check_words.uses(root).items() for name, place in found)


COUNTS = (
    (f"types with more than {MOST_MEMBERS} public data members that functions change", shared_states),
    ("include arrows against the order inside a layer", circles),
    (f"files over {MOST_FILE_LINES} lines", long_files),
    (f"functions over {MOST_FUNCTION_LINES} lines", long_functions),
    (f"folders over {MOST_HEADERS} headers", large_folders),
    ("replaced words in identifiers", replaced_words),
)


def main(arguments):
    places = [argument for argument in arguments if not argument.startswith("--")]
    root = pathlib.Path(places[0] if places else pathlib.Path(__file__).parent.parent).resolve()
    for title, count in COUNTS:
        found = count(root)
        print(f"{len(found):5}  {title}")
        for line in found if "--list" in arguments else ():
            print(f"           {line}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
