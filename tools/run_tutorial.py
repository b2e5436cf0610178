#!/usr/bin/env python3
"""Runs a page of commands as a reader would:  tools/run_tutorial.py PROGRAM [PAGE]

PROGRAM is the built `tactum`, PAGE docs/tutorial.md unless another one is given. Its fenced blocks are taken one after
another, in an empty folder with the program on the path:

- ```LANGUAGE PATH (a file of the project, quoted whole) is saved under the file's name;
- ```sh is run by bash, and every command of it must end with 0;
- ```text, behind an ```sh, is what that printed: each of its lines stands in the output, at the start or end of a line or
  inside it; `...` stands for anything.

Blocks without a language, and indented ones, are for the reader alone.
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
BLOCK = re.compile(r"^```(\w*)(?: (\S+))?\n(.*?)^```\s*$", re.MULTILINE | re.DOTALL)
LONGEST_S = 120  # of one block


def blocks(text):
    """Line, language, path or None, and content of every fenced block."""
    for match in BLOCK.finditer(text):
        yield text.count("\n", 0, match.start()) + 1, match.group(1), match.group(2), match.group(3)


def is_printed(line, output):
    """Whether a line of the page, in which `...` is anything, stands in a line of the output."""
    pattern = ".*".join(re.escape(part.strip()) for part in line.strip().split("..."))
    return re.search(pattern, output) is not None


def run_block(commands, folder, environment):
    """Exit status and what was printed, standard output and standard error."""
    try:
        done = subprocess.run(["bash", "-euo", "pipefail", "-c", commands], cwd=folder, env=environment, timeout=LONGEST_S,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, text=True)
    except subprocess.TimeoutExpired:
        return -1, f"(not done after {LONGEST_S} s)"
    return done.returncode, done.stdout


def faults(text, folder, environment, root=ROOT):
    """What a reader would stumble over, a sentence each; nothing is run behind a command that failed."""
    output = None
    for line, language, path, content in blocks(text):
        if path:
            (folder / pathlib.Path(path).name).write_text((root / path).read_text())
        elif language == "sh":
            status, output = run_block(content, folder, environment)
            if status != 0:
                yield f"line {line}: the commands ended with {status}, and printed:\n{output}"
                return
        elif language == "text" and output is None:
            yield f"line {line}: shows output before any command"
        elif language == "text":
            for shown in filter(str.strip, content.splitlines()):
                if not is_printed(shown, output):
                    yield f"line {line}: shows a line that was not printed:\n  {shown}\nwhat was printed:\n{output}"
    if output is None:
        yield "the page runs nothing"


def main(arguments):
    if not 1 <= len(arguments) <= 2:
        print(__doc__.splitlines()[0])
        return 2
    program = pathlib.Path(arguments[0]).resolve()
    page = pathlib.Path(arguments[1]) if len(arguments) > 1 else ROOT / "docs/tutorial.md"
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name) / "page"
        folder.mkdir()
        environment = dict(os.environ, PATH=f"{program.parent}:{os.environ['PATH']}", XDG_CACHE_HOME=f"{name}/cache")
        found = list(faults(page.read_text(), folder, environment))
    for fault in found:
        print(f"{page}: {fault}")
    print(f"{page.name}: {len(found)} faults")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
