#!/usr/bin/env python3
"""Holds that code for newer processors stays where it is called on those alone:  tools/check_wide_symbols.py BUILD

Files called *_wide.cpp are compiled with -mavx2. An inline function that one of them and another file define is one
symbol to the linker, which keeps either; kept from the wide file it would stop the program on a processor without AVX2.
So of the symbols that a wide file shows to others each must be its own: the table of its kernels (kWide...), or a kernel of
its width (...KernelsOf<...>), and no other file of the libraries BUILD/libtactum_*.a may define it.
"""
import pathlib
import re
import subprocess
import sys

# libtactum_math.a:column_kernels_wide.cpp.o:0000000000000000 W tactum::columns::KernelsOf<4ul>::dot(double const*)
SYMBOL = re.compile(r"^[^:]+:(?P<file>[^:]+):[0-9a-f]* (?P<kind>\S) (?P<name>.+)$")
SHOWN_KINDS = "ABCDGRSTuVvWwi"  # of nm: global, unique or weak
TABLE = re.compile(r"::kWide\w*$")
OWN = re.compile(r"\b\w*KernelsOf<|" + TABLE.pattern)
NO_CODE = re.compile(r"^DW\.ref\.")  # the address of a routine of the language, the same in every file


def shown_symbols(listing):
    """File by file, what it defines and shows to others, from the lines of `nm -A -C --defined-only`."""
    files = {}
    for line in listing.splitlines():
        match = SYMBOL.match(line)
        if match and match["kind"] in SHOWN_KINDS and not NO_CODE.match(match["name"]):
            files.setdefault(match["file"], set()).add(match["name"])
    return files


def leaks(files):
    """A sentence for every symbol of a wide file that another file could be given."""
    wide = {name: symbols for name, symbols in files.items() if "_wide.cpp." in name}
    for name, symbols in sorted(wide.items()):
        elsewhere = set().union(*(shown for other, shown in files.items() if other != name))
        for symbol in sorted(symbols):
            if not OWN.search(symbol):
                yield f"{name} shows {symbol}, which is no kernel of its own"
            elif symbol in elsewhere and not TABLE.search(symbol):
                yield f"{name} shows {symbol}, which another file defines too"


def main(arguments):
    libraries = sorted(pathlib.Path(arguments[0]).glob("libtactum_*.a"))
    command = ["nm", "-A", "-C", "--defined-only", *map(str, libraries)]
    files = shown_symbols(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
    if not any("_wide.cpp." in name for name in files):
        sys.exit(f"check_wide_symbols: no file *_wide.cpp in the libraries of {arguments[0]}")
    found = list(leaks(files))
    print("\n".join(found + [f"wide symbols: {len(found)} faults"]))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
