"""The wheel of the module: CMake builds its part in C++, in the folder that the packages are built in as well."""
import pathlib
import re
import subprocess

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = pathlib.Path(__file__).resolve().parent.parent
BUILD = ROOT / "build" / "package"


def version():
    """As src/tactum/version.h has it."""
    header = (ROOT / "src/tactum/version.h").read_text()
    return ".".join(re.search(rf"#define TACTUM_VERSION_{part} (\d+)", header).group(1) for part in ("MAJOR", "MINOR", "PATCH"))


class BuildByCMake(build_ext):
    """Builds the target tactum_python, and takes the library from where CMake installs it."""

    def build_extension(self, extension):
        # No programs, unless the folder was configured for them: the module alone needs less installed.
        if not (BUILD / "build.ninja").exists():
            subprocess.run(["cmake", "-S", ROOT, "--preset", "package", "-DTACTUM_PACKAGES=OFF", "-DTACTUM_BUILD_APP=OFF",
                            "-DTACTUM_BUILD_BENCH=OFF"], cwd=ROOT, check=True)
        subprocess.run(["cmake", "--build", BUILD, "--target", "tactum_python"], check=True)
        place = pathlib.Path(self.get_ext_fullpath(extension.name)).resolve()
        built = BUILD / "python" / "tactum" / place.name
        if not built.is_file():
            raise FileNotFoundError(f"CMake has not built {place.name}: the module is left out where pybind11, Python's or "
                                    f"numpy's headers are missing, or this Python is not the one that CMake has found")
        place.parent.mkdir(parents=True, exist_ok=True)
        subprocess.run(["cmake", "-E", "copy", built, place], check=True)
        subprocess.run(["strip", "--strip-unneeded", place], check=True)


setup(version=version(), ext_modules=[Extension("tactum._tactum", sources=[])], cmdclass={"build_ext": BuildByCMake},
      options={"egg_info": {"egg_base": str(BUILD)}, "build": {"build_base": str(BUILD / "wheel-build")}})
