#!/usr/bin/env python3
"""What a shared library shows is what a header declares:  tests/embedding/check_symbols.py LIBRARY HEADER

The names that `nm -D` shows as defined are the functions marked TACTUM_C_API in the header, no more and no fewer.
"""
import re
import subprocess
import sys


def declared(text):
    """The functions that a header exports."""
    return set(re.findall(r"TACTUM_C_API\s[^;{(]*?\b(tactum_\w+)\s*\(", text))


def shown(listing):
    """The defined names of a listing by nm, without versions; the version's own name is absolute and none of them."""
    lines = (line.split() for line in listing.splitlines())
    return {words[-1].split("@")[0] for words in lines if len(words) >= 3 and words[-2] != "A"}


def main(library, header):
    listing = subprocess.run(["nm", "-D", "--defined-only", library], check=True, capture_output=True, text=True).stdout
    with open(header) as file:
        wanted = declared(file.read())
    found = shown(listing)
    for name in sorted(found - wanted):
        print(f"{library} shows {name}, which the header does not declare")
    for name in sorted(wanted - found):
        print(f"{library} does not show {name}, which the header declares")
    print(f"{len(found)} names, {len(wanted)} declared")
    return 0 if found == wanted and wanted else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
