#!/usr/bin/env python3
"""Prepares every mesh below a folder and prints a table of what came of it:  tools/prepare_table.py TACTUM FOLDER

Two-way deviation as a share of the size, processor time (which a busy machine does not stretch much) and the most memory held, without
the cache. The numbers of docs/prepare.md
come from here.
"""
import json
import pathlib
import resource
import subprocess
import sys
import tempfile

ENDINGS = {".obj", ".stl", ".ply", ".off", ".gltf", ".glb", ".dae"}


def row_of(program, mesh, name, part):
    command = [program, "prepare", str(mesh), "-o", part, "--no-cache", "--json", "-"]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime
    if run.returncode != 0:
        return f"| {name} | refused: {run.stderr.strip().replace(str(mesh), mesh.name)} | | | | | |"
    told = json.loads(run.stdout)
    report = told["report"]
    findings = ", ".join(f"{note['count']} {note['kind'].replace('_', ' ')}" for note in report["left"])
    pieces = f"{report['pieces']['count']} solid" if report["pieces"]["solid"] else "surface"
    return (f"| {name} | {report['mesh']['triangles']} | {pieces} | {findings} | "
            f"{report['verification']['deviation_over_size']:.1g} | {seconds:.2f} | {told['peak_memory_MB']:.0f} |")


def main(arguments):
    program, folder = arguments
    root = pathlib.Path(folder)
    print("| mesh | triangles | pieces | left as found | deviation / size | s | MB |\n|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as scratch:
        for mesh in sorted(root.rglob("*")):
            if mesh.suffix.lower() in ENDINGS:
                print(row_of(program, mesh, mesh.relative_to(root).as_posix(), f"{scratch}/part.tactum"), flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
