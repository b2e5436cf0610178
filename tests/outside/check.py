#!/usr/bin/env python3
"""Uses the library as others do:  tests/outside/check.py SOURCE BUILD INSIDE

Builds the program of this folder against the library that was built in BUILD and is installed into a folder of the
test's own, and against its sources in SOURCE, with g++ and with clang++ where it is installed. What a library alone must
not need is hidden. Each program must print the hash that INSIDE prints, the same program built within the tree.

clang++ compiles the sources of the library only when TACTUM_ALL_BUILDS=1 says that its build is there: then the compiler
cache knows all of them, for the files are joined as there. With TACTUM_FULL=1 each is compiled alone, as by others.
"""
import json
import os
import pathlib
import shutil
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
NOT_NEEDED = ("Boost", "CLI11", "GTest")
NOT_LOOKED_FOR = ("NODE", "CLI11_DIR", "GTest_DIR", "OCCT_INCLUDE_DIR", "VTK_INCLUDE_DIR", "TACTUM_HDF5_FOUND", "MPI_C_COMPILER")


def run(*command):
    """Runs the command and returns what it printed; the test fails with all of its output when it fails."""
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, stdin=subprocess.DEVNULL)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def build_and_run(folder, compiler, hidden, *options):
    """The hash that the program prints, built in `folder` by `compiler`."""
    (folder / "CMakeCache.txt").unlink(missing_ok=True)
    hide = [f"-DCMAKE_DISABLE_FIND_PACKAGE_{name}=ON" for name in hidden]
    run("cmake", "-G", "Ninja", "-S", HERE, "-B", folder, f"-DCMAKE_CXX_COMPILER={compiler}",
        "-DCMAKE_BUILD_TYPE=Release", *hide, *options)
    cached = {line.partition(":")[0] for line in (folder / "CMakeCache.txt").read_text().splitlines()}
    looked_for = sorted(cached.intersection(NOT_LOOKED_FOR))
    if looked_for:
        sys.exit(f"the library alone looks for {', '.join(looked_for)}")
    run("cmake", "--build", folder)
    return run(folder / "outside").strip()


def joined(source):
    """The options by which the presets of the project join files."""
    presets = json.loads((source / "CMakePresets.json").read_text())["configurePresets"]
    variables = next(preset["cacheVariables"] for preset in presets if preset["name"] == "joined")
    return [f"-D{name}={value}" for name, value in variables.items()]


def main(source, build, inside):
    source, build = pathlib.Path(source).resolve(), pathlib.Path(build).resolve()
    prefix = build / "installed"
    shutil.rmtree(prefix, ignore_errors=True)
    run("cmake", "--install", build, "--component", "library", "--prefix", prefix)
    # Compiled as the build's own files, and in a folder of the same depth: so the compiler cache knows them.
    as_own = [f"-DTACTUM_SOURCE={source}", "-DTACTUM_WARNINGS_ARE_ERRORS=ON"]
    if os.environ.get("TACTUM_FULL") != "1":
        as_own += joined(source)
    os.environ.update(CCACHE_BASEDIR=str(source), CCACHE_NOHASHDIR="1")
    hashes = {"inside": run(inside).strip()}
    for compiler in ("g++", "clang++"):
        if not shutil.which(compiler):
            print(f"{compiler} is not installed: left out")
            continue
        way = f"{compiler}, find_package"
        hashes[way] = build_and_run(build / f"outside-{compiler}", compiler, (*NOT_NEEDED, "nlohmann_json"),
                                    f"-DCMAKE_PREFIX_PATH={prefix}")
        if compiler == "clang++" and os.environ.get("TACTUM_ALL_BUILDS") != "1":
            continue
        way = f"{compiler}, add_subdirectory"
        own_flags = ["-DTACTUM_POSITION_INDEPENDENT=OFF"] if compiler == "clang++" else []  # as the preset has it
        folder = build.with_name(f"{build.name}-outside-{compiler}")
        hashes[way] = build_and_run(folder, compiler, NOT_NEEDED, *as_own, *own_flags)
    for way, value in hashes.items():
        print(value, way)
    return 0 if len(set(hashes.values())) == 1 else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
