#!/usr/bin/env python3
"""Takes stages out of the code, one by one, and expects a test to fail:  tools/mutations.py (--check | --write | --run)

tests/mutations.toml lists the mutations. Each names a file, a text that stands there exactly once, what stands in its
place, and the test that then fails; docs/mutations.md shows the list.

  --check         every text is found exactly once, every test is there, the page shows the list as it is
  --write         write the list into the page
  --run           in a copy of the tree, build/mutations: the tests pass as it is, and each fails with its mutation
  --only NAME     of --run: this mutation alone (may be repeated)
  --root ROOT     another tree than this one
"""
import argparse
import filecmp
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tomllib

LIST = "tests/mutations.toml"
PAGE = "docs/mutations.md"
COPY = "build/mutations"
KEYS = ("name", "without", "file", "find", "replace", "program", "test")
MARKS = ("<!-- mutations -->\n", "<!-- end mutations -->\n")
LEFT_OUT = {".git", "build", "out", "node_modules", "__pycache__"}
OPTIONS = ("-DTACTUM_PAGE=OFF", "-DTACTUM_STEP=OFF", "-DTACTUM_FIELD=OFF", "-DTACTUM_BENCH_PEERS=OFF")
MINUTES = 20  # a test that a mutation keeps from ending fails


def mutations(root):
    return tomllib.loads((root / LIST).read_text())["mutation"]


def table(listed):
    """The list as Markdown."""
    lines = ["| mutation | the code without ... | in | the test that fails |", "|---|---|---|---|"]
    for mutation in listed:
        lines.append(f"| {mutation['name']} | {mutation['without']} | `{mutation['file']}` | "
                     f"`{mutation['program']} --gtest_filter='{mutation['test']}'` |")
    return "\n".join(lines) + "\n"


def split_page(text):
    """What stands before the list, the list, and what stands after it."""
    before, _, rest = text.partition(MARKS[0])
    shown, _, after = rest.partition(MARKS[1])
    return before, shown, after


def test_exists(root, mutation):
    suite, _, name = mutation["test"].partition(".")
    wanted = re.compile(rf"\bTEST(?:_F|_P)?\(\s*{re.escape(suite)},\s*{re.escape(name)}\)")
    folder = root / "tests" / mutation["program"].removeprefix("test_")
    return any(wanted.search(path.read_text()) for path in folder.glob("*.cpp"))


def faults_of(root, mutation):
    missing = [key for key in KEYS if key not in mutation]
    if missing:
        yield f"{LIST}: {mutation.get('name', 'a mutation')} has no {missing[0]}"
        return
    name = mutation["name"]
    path = root / mutation["file"]
    if not path.is_file():
        yield f"{LIST}: {name} changes {mutation['file']}, which is not there"
        return
    times = path.read_text().count(mutation["find"])
    if times != 1:
        yield f"{LIST}: the text of {name} stands {times} times in {mutation['file']}, not once"
    if mutation["find"] == mutation["replace"]:
        yield f"{LIST}: {name} changes nothing"
    if not test_exists(root, mutation):
        yield f"{LIST}: {name} names {mutation['test']}, which {mutation['program']} has not"


def faults(root):
    """Everything that is wrong with the list and its page, a sentence each."""
    listed = mutations(root)
    for mutation in listed:
        yield from faults_of(root, mutation)
    names = [mutation.get("name") for mutation in listed]
    for name in sorted({str(name) for name in names if names.count(name) > 1}):
        yield f"{LIST}: there are several mutations {name}"
    if all(key in mutation for mutation in listed for key in KEYS) \
            and split_page((root / PAGE).read_text())[1] != table(listed):
        yield f"{PAGE}: the table is not that of {LIST}; tools/mutations.py --write writes it"


def write_page(root):
    path = root / PAGE
    before, _, after = split_page(path.read_text())
    path.write_text(before + MARKS[0] + table(mutations(root)) + MARKS[1] + after)


def files_of(folder):
    for path in folder.rglob("*"):
        inside = path.relative_to(folder)
        if not LEFT_OUT.intersection(inside.parts) and path.is_file():
            yield inside


def copy_tree(root, copy):
    """Makes the copy equal to the tree. What is equal keeps its time stamp, so that little is built again."""
    wanted = set(files_of(root))
    if copy.exists():
        for inside in set(files_of(copy)) - wanted:
            (copy / inside).unlink()
    for inside in wanted:
        if (copy / inside).is_file() and filecmp.cmp(root / inside, copy / inside, shallow=False):
            continue
        (copy / inside).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(root / inside, copy / inside)
        shutil.copymode(root / inside, copy / inside)


class Copy:
    """The copy of the tree, where mutations are built and run."""

    def __init__(self, root):
        self.root = root / COPY
        self.build = self.root / "build/release"
        self.environment = {**os.environ, "CCACHE_BASEDIR": str(self.root), "CCACHE_NOHASHDIR": "1"}
        copy_tree(root, self.root)
        self.call("cmake", "-S", str(self.root), "--preset", "release", *OPTIONS)

    def call(self, *command):
        done = subprocess.run(command, cwd=self.root, env=self.environment, capture_output=True, text=True,
                              stdin=subprocess.DEVNULL)
        if done.returncode != 0:
            raise RuntimeError(f"{' '.join(command)}\n{done.stdout[-4000:]}{done.stderr[-4000:]}")

    def make(self, *programs):
        self.call("cmake", "--build", str(self.build), "--target", *programs)

    def passes(self, mutation, *options):
        """Whether the mutation's test passes with the code as it now stands there."""
        command = [str(self.build / "tests" / mutation["program"]), f"--gtest_filter={mutation['test']}", *options]
        try:
            done = subprocess.run(command, cwd=self.root, env=self.environment, capture_output=True, text=True,
                                  stdin=subprocess.DEVNULL, timeout=60 * MINUTES)
        except subprocess.TimeoutExpired:
            return False
        if "[==========]" not in done.stdout:
            raise RuntimeError(f"{' '.join(command)} ran no test\n{done.stdout}{done.stderr}")
        return done.returncode == 0

    def passes_with(self, mutation):
        """Whether the test passes with the mutation; the code then stands as it did."""
        path = self.root / mutation["file"]
        text = path.read_text()
        if text.count(mutation["find"]) != 1:
            raise RuntimeError(f"the text of {mutation['name']} does not stand once in {mutation['file']}")
        path.write_text(text.replace(mutation["find"], mutation["replace"]))
        try:
            self.make(mutation["program"])
            return self.passes(mutation, "--gtest_break_on_failure")  # one failure is enough
        finally:
            path.write_text(text)


def run(root, only):
    """Runs the mutations; returns how many of their tests do not tell them."""
    chosen = [mutation for mutation in mutations(root) if not only or mutation["name"] in only]
    copy = Copy(root)
    copy.make(*sorted({mutation["program"] for mutation in chosen}))
    # The tests of all mutations first, while the programs are as they should be.
    broken = [mutation["name"] for mutation in chosen if not copy.passes(mutation)]
    for name in broken:
        print(f"{name}: its test fails without the mutation too", flush=True)
    unseen = 0
    for mutation in chosen:
        try:
            seen = not copy.passes_with(mutation)
            outcome = f"{mutation['test']} {'fails, as it must' if seen else 'PASSES'}"
        except RuntimeError as error:
            seen = False
            outcome = f"cannot be tried: {error}"
        unseen += 0 if seen else 1
        print(f"{mutation['name']}: {outcome}", flush=True)
    return unseen + len(broken)


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    task = parser.add_mutually_exclusive_group(required=True)
    for option in ("--check", "--write", "--run"):
        task.add_argument(option, action="store_true")
    parser.add_argument("--only", action="append", default=[])
    parser.add_argument("--root", type=pathlib.Path, default=pathlib.Path(__file__).parent.parent)
    options = parser.parse_args(arguments)
    root = options.root.resolve()
    if options.write:
        write_page(root)
        return 0
    found = list(faults(root))
    for fault in found:
        print(fault)
    if options.check or found:
        print(f"mutations: {len(found)} faults")
        return 1 if found else 0
    unseen = run(root, options.only)
    print(f"mutations: {unseen} that no test tells")
    return 1 if unseen else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
