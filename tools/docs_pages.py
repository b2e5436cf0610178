#!/usr/bin/env python3
"""Written pages for Doxygen:  tools/docs_pages.py PAGE.md        (prints the page as Doxygen takes it)
                               tools/docs_pages.py --check SITE  (fails on links of the site that lead nowhere)

Doxygen of Debian 12 knows no links to sections of other pages as they are written for readers of the repository. So every
heading gets a name of its own, made as those readers' hosts make it, and links to pages and sections go by these names. Other
files that pages link to are copied into the site, below files/.
"""
import html.parser
import os
import pathlib
import re
import shutil
import sys
import urllib.parse

ROOT = pathlib.Path(__file__).resolve().parent.parent
SITE_FILES = ROOT / "build/docs/html/files"
FENCE = re.compile(r"^(```|~~~)(\S*)[^\n]*$")
HEADING = re.compile(r"^(#{1,6}) +(.*?) *#*$")
LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^)\s]+)\)")
CODE = re.compile(r"(`+)(.+?)\1", re.DOTALL)


def slug(heading):
    """The name of a heading in a link: small letters, no punctuation, hyphens for blanks."""
    plain = LINK.sub(r"\2", heading).replace("`", "").lower()
    return re.sub(r"[^\w\- ]", "", plain).replace(" ", "-")


def page_name(path):
    """One name for each page: page_docs_python of docs/python.md."""
    return "page_" + re.sub(r"\W", "_", path.relative_to(ROOT).with_suffix("").as_posix())


def outside_fences(text):
    """Lines with whether they stand outside of blocks of code."""
    fence = None
    for line in text.split("\n"):
        found = FENCE.match(line)
        if found and fence in (None, found.group(1)):
            fence = None if fence else found.group(1)
            yield line, False
        else:
            yield line, fence is None


def link_to(path, target):
    """Where the link of a page goes in the site; the target as it was where it leads out of the repository."""
    if re.match(r"[a-z]+:", target):
        return target
    name, _, section = target.partition("#")
    file = (path.parent / name).resolve() if name else path
    if file.is_dir():
        file = file / "README.md"
    if file.suffix == ".md" and file.is_file():
        return "@ref " + page_name(file) + ("-" + section if section else "")
    if not file.is_file():
        sys.exit(f"{path}: a link to {target}, which is not there")
    inside = file.relative_to(ROOT)
    copy = SITE_FILES / inside
    copy.parent.mkdir(parents=True, exist_ok=True)
    shutil.copy(file, copy)
    return f"files/{inside.as_posix()}"


def linked(path, text):
    """A paragraph with its links rewritten, which may go over the end of a line; what is in backticks stays."""
    codes = []

    def hidden(match):
        codes.append(match.group(0))
        return f"\x00{len(codes) - 1}\x00"

    def rewritten(match):
        picture, words, target = match.groups()
        goal = link_to(path, target)
        if picture:
            return f'<img src="{goal}" alt="{words}"/>'
        return f"[{LINK.sub(rewritten, words)}]({goal})".replace("\n", " ")

    text = re.sub(r"(?<![\w\\])@(?=[a-z])", r"\\@", CODE.sub(hidden, text))  # no command of Doxygen
    text = LINK.sub(rewritten, text)
    return re.sub("\x00(\\d+)\x00", lambda match: codes[int(match.group(1))], text)


def page(path):
    """The text of a page for Doxygen."""
    done, paragraph, seen, first = [], [], {}, True

    def end_paragraph():
        if paragraph:
            done.append(linked(path, "\n".join(paragraph)))
            paragraph.clear()

    for line, prose in outside_fences(path.read_text()):
        heading = HEADING.match(line) if prose else None
        fence = FENCE.match(line)
        if prose and line.strip() and not heading and not fence:
            paragraph.append(line)
            continue
        end_paragraph()
        if heading:
            marks, words = heading.groups()
            name = page_name(path) + ("" if first else "-" + slug(words))
            first = False
            seen[name] = seen.get(name, -1) + 1
            if seen[name]:
                name += f"-{seen[name]}"
            line = f"{marks} {linked(path, words)} {{#{name}}}"
        elif fence:
            line = fence.group(1) + (f"{{.{fence.group(2)}}}" if fence.group(2) in ("cpp", "c", "py", "sh") else "")
        done.append(line)
    end_paragraph()
    return "\n".join(done)


class Links(html.parser.HTMLParser):
    """The names that a page of the site defines, and where its links lead."""

    def __init__(self):
        super().__init__()
        self.names, self.targets = set(), []

    def handle_starttag(self, tag, attributes):
        for key, value in attributes:
            if key == "id" or key == "name" and tag == "a":
                self.names.add(value)
            elif key in ("href", "src") and value and not re.match(r"[a-z]+:|//", value):
                self.targets.append(value)


def without_empty_summaries(site):
    """Takes out the links to "Classes" that Doxygen sets above classes whose inner ones are private, and so not shown."""
    for path in site.glob("*.html"):
        text = path.read_text(errors="surrogateescape")
        if 'href="#nested-classes"' in text and 'name="nested-classes"' not in text:
            text = re.sub(r'<a href="#nested-classes">[^<]*</a>( &#124;\s*)?', "", text)
            path.write_text(text, errors="surrogateescape")


def check(site):
    """The number of links of the site, and a sentence for each that leads nowhere."""
    pages = {}
    for path in sorted(site.glob("*.html")):
        links = Links()
        links.feed(path.read_text(errors="replace"))
        pages[path.name] = links
    count, faults = 0, []
    for name, links in pages.items():
        for target in links.targets:
            count += 1
            file, _, section = urllib.parse.unquote(target).partition("#")
            file = os.path.normpath(file) if file else name
            if not (site / file).exists():
                faults.append(f"{name}: a link to {target}: there is no {file}")
            elif section and file in pages and section not in pages[file].names:
                faults.append(f"{name}: a link to {target}: {file} has no such section")
    for path in sorted(site.glob("page_*.html")):
        for text in re.findall(r"(?:@ref|\\ref) \S+", path.read_text(errors="replace")):
            faults.append(f"{path.name}: {text} was not resolved")
    return count, faults


def main(arguments):
    if arguments[0] != "--check":
        print(page(pathlib.Path(arguments[0]).resolve()))
        return 0
    without_empty_summaries(pathlib.Path(arguments[1]))
    count, faults = check(pathlib.Path(arguments[1]))
    for fault in faults:
        print(fault)
    print(f"site: {count} links, {len(faults)} of them dead")
    return 1 if faults or count == 0 else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
