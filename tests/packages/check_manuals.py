#!/usr/bin/env python3
"""The manual pages and completions of the programs against their `--help`:  tests/packages/check_manuals.py PROGRAM...

For every command: the options that `help COMMAND` lists are those of its section in the page, and those that bash and
fish, where it is installed, offer behind it; the commands likewise. Where groff is installed, it lays out each page without a warning.
"""
import pathlib
import re
import shutil
import subprocess
import sys

OPTION_LINE = re.compile(r"^  (?:  )?(-[\w,-]+)", re.MULTILINE)
COMMAND_LINE = re.compile(r"^  ([a-z][\w-]*) ", re.MULTILINE)


def output(*command):
    return subprocess.run([str(word) for word in command], capture_output=True, text=True, check=True).stdout


def told(program, words):
    """The options and the commands that the program's help names for the command of these words."""
    page = output(program, *words, "--help")
    below = page.partition("Subcommands:")[2]
    return {name for names in OPTION_LINE.findall(page) for name in names.split(",")}, COMMAND_LINE.findall(below)


def sections(page, name):
    """The options in the manual page, by the words of the command."""
    found, words = {(): set()}, ()
    for line in page.splitlines():
        plain = re.sub(r"\\f.|\\:", "", line).replace("\\-", "-")
        if line.startswith(".SS "):
            words = tuple(plain.split()[2:])
            found[words] = set()
        elif line.startswith("\\fB"):
            found[words].update(word.rstrip(",") for word in plain.split() if re.fullmatch(r"--?[a-z][\w-]*,?", word))
    return found


def offered(program, completion, words, begun):
    """What bash offers for `begun` behind the words."""
    name = program.name
    script = ('source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); '
              f'_{name.replace("-", "_")} 2>/dev/null; printf "%s\\n" "${{COMPREPLY[@]}}"')
    return set(output("bash", "--norc", "-c", script, "bash", completion, program, *words, begun).split())


def offered_by_fish(program, completion, words, begun):
    """What fish offers for `begun` behind the words: it shows its own wildcard for files, which no check counts."""
    line = " ".join((program.name, *words, begun))
    script = "set -x PATH $argv[2] $PATH; source $argv[1]; complete -C $argv[3]"
    listed = output("fish", "--no-config", "-c", script, completion, program.parent, line).splitlines()
    return {one.split("\t")[0] for one in listed}


def check_fish(program, completion, words, told_options, told_commands):
    """A sentence for every fault behind these words."""
    where = " ".join((program.name, *words))
    given = offered_by_fish(program, completion, words, "-") | offered_by_fish(program, completion, words, "--")
    faults = [f"{where}: fish offers {sorted(given)}, --help has {sorted(told_options)}"] if given != told_options else []
    if not told_commands:
        return faults
    expected = {*told_commands} | ({"help"} if not words else set())
    given = offered_by_fish(program, completion, words, "")
    if given != expected:
        faults.append(f"{where}: fish offers {sorted(given)}, --help has {sorted(expected)}")
    if not words:
        after_help = offered_by_fish(program, completion, ("help",), "")
        if after_help != {*told_commands}:
            faults.append(f"{where} help: fish offers {sorted(after_help)}, expected {sorted(told_commands)}")
        if offered_by_fish(program, completion, ("help", told_commands[0]), "--"):
            faults.append(f"{where} help {told_commands[0]}: fish offers options, which help does not take")
    return faults


def check(program, folder):
    """A sentence for every fault, and how many commands were looked at."""
    faults = []
    page, text = output(program, "help", "--man"), output(program, "help", "--bash")
    completion = folder / f"{program.name}.bash"
    completion.write_text(text)
    fish = folder / f"{program.name}.fish"
    fish.write_text(output(program, "help", "--fish"))
    documented = sections(page, program.name)
    waiting, seen = [()], set()
    while waiting:
        words = waiting.pop()
        seen.add(words)
        options, commands = told(program, words)
        waiting += [(*words, command) for command in commands]
        where = " ".join((program.name, *words))
        if documented.get(words) != options:
            faults.append(f"{where}: the manual has {sorted(documented.get(words, ()))}, --help has {sorted(options)}")
        given = offered(program, completion, words, "-")
        if given != options:
            faults.append(f"{where}: bash offers {sorted(given)}, --help has {sorted(options)}")
        if shutil.which("fish"):
            faults += check_fish(program, fish, words, options, commands)
        if commands:
            given = offered(program, completion, words, "")
            expected = {*commands} | ({"help"} if not words else set())
            if given != expected:
                faults.append(f"{where}: bash offers {sorted(given)}, --help has {sorted(expected)}")
            if not words and offered(program, completion, ("help",), commands[0][:-1]) != {commands[0]}:
                faults.append(f"{where} help: bash does not complete {commands[0][:-1]}")
    if set(documented) != seen:
        faults.append(f"{program.name}: the manual has other commands: {sorted(set(documented) ^ seen)}")
    if shutil.which("groff"):
        done = subprocess.run(["groff", "-man", "-ww", "-Tutf8", "-z", "-rLL=80n"], input=page, capture_output=True, text=True)
        faults += [f"{program.name}: groff says {line}" for line in done.stderr.splitlines()]
    return faults, len(seen)


def main(programs, folder):
    folder.mkdir(parents=True, exist_ok=True)
    faults, count = [], 0
    for program in map(pathlib.Path, programs):
        found, commands = check(program.resolve(), folder)
        faults += found
        count += commands
        if program.name == "tactum" and "peg-in-hole" not in offered(program.resolve(), folder / "tactum.bash", ("feel",), "peg-i"):
            faults.append("tactum feel peg-i: bash does not offer peg-in-hole")
        if program.name == "tactum" and shutil.which("fish") and "peg-in-hole" not in offered_by_fish(
                program.resolve(), folder / "tactum.fish", ("feel",), "peg-i"):
            faults.append("tactum feel peg-i: fish does not offer peg-in-hole")
    for fault in faults:
        print(fault)
    fish = "" if shutil.which("fish") else "; fish is not installed, its completion was not tried"
    print(f"manuals: {count} commands of {len(programs)} programs, {len(faults)} faults{fish}")
    return 1 if faults or count == 0 else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[2:], pathlib.Path(sys.argv[1])))
