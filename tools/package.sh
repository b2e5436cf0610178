#!/usr/bin/env bash
# Makes the Debian packages and the wheel, and checks them:  tools/package.sh [--no-wheel]
#
# build/package/packages   the packages, which lintian has read; install them with `apt install ./NAME.deb`
# build/package/wheel      the Python module as a wheel, which was installed in a fresh virtual environment and used
#
# What is missing is installed (tools/packages.txt: run, package). tools/check_packages.sh tries the packages in a clean root.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
"$root/tools/install_packages.sh" run package
configure package
build package
rm -rf "$root/build/package/packages"
cmake --build "$root/build/package" --target package >"$root/build/cpack.log" 2>&1 || { cat "$root/build/cpack.log" >&2; exit 1; }
# CMake leaves out what it finds no library for: then a package would lack it.
for file in tactum/usr/bin/tactum tactum-tools/usr/bin/tactum-{bench,step,field,sweep-mpi} python3-tactum/usr/lib/python3/dist-packages/tactum/_tactum; do
  package="${file%%/*}"
  dpkg-deb --contents "$root/build/package/packages/$package"_*.deb | grep " \./${file#*/}" >/dev/null ||
    { echo "package: ${file#*/} was left out: see build/configure-package.log" >&2; exit 1; }
done
ls -sh "$root/build/package/packages"
lintian --fail-on error,warning --tag-display-limit 0 "$root"/build/package/packages/*.deb
echo "lintian has nothing to say that packaging/overrides does not answer"
[[ ${1:-} == --no-wheel ]] || "$root/tools/wheel.sh"
