#!/usr/bin/env bash
# Installs the packages of tools/package.sh in a clean Debian 12 and uses them there:  tools/check_packages.sh [FOLDER]
#
# debootstrap makes the root, with the archive that this machine's apt uses; it needs root. There, outside any tree of the
# project: the program runs, the line of Python in docs/packages.md prints what it says, the examples in Python run, those
# in C and C++ are built and run, and the tools start. In the end the packages are removed, and nothing of them is left.
# FOLDER holds the packages: build/package/packages. Ends with 77 where it cannot run. TACTUM_CLEAN_ROOT=FOLDER takes a copy of a
# root that `debootstrap --variant=minbase bookworm FOLDER` has made before.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
packages="$(cd "${1:-$root/build/package/packages}" 2>/dev/null && pwd)" || { echo "no folder of packages: run tools/package.sh first" >&2; exit 77; }
missing() { echo "check_packages: left out, $*" >&2; exit 77; }
[[ $(id -u) == 0 ]] || missing "this needs root"
command -v debootstrap >/dev/null || missing "debootstrap is not installed (tools/install_packages.sh package)"
# In a mount namespace of its own, so that nothing stays mounted however this ends.
if [[ ${TACTUM_OWN_MOUNTS:-} != 1 ]]; then TACTUM_OWN_MOUNTS=1 exec unshare --mount "$0" "$packages"; fi

archive="$(apt-get indextargets --format '$(REPO_URI) $(CODENAME)' 'Created-By: Packages' | awk '$2 == "bookworm" { print $1; exit }')"
[[ -n $archive ]] || missing "apt knows no archive of Debian 12 (bookworm)"
clean="$(mktemp -d)"
trap 'umount -l "$clean/proc" 2>/dev/null; rm -rf --one-file-system "$clean"' EXIT
log="$clean.log"
part() { printf '\n== %s (%d s)\n' "$1" "$SECONDS"; }
stop() { echo "check_packages: $*" >&2; exit 1; }
inside() { chroot "$clean" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 "$@" </dev/null; }
quietly() { "$@" >"$log" 2>&1 || { tail -40 "$log" >&2; rm -f "$log"; stop "failed: $*"; }; rm -f "$log"; }
# Recommended packages are left out: what a package needs it must depend on.
install() {
  quietly inside DEBIAN_FRONTEND=noninteractive apt-get -o Dpkg::Use-Pty=0 install -y --no-install-recommends "$@"
  echo "installed: $*"
}
deb() { local found=("$packages"/"$1"_*.deb); [[ -f ${found[0]} ]] || stop "no package $1 in $packages"; echo "./packages/$(basename "${found[0]}")"; }

part "A clean Debian 12 from $archive"
if [[ -n ${TACTUM_CLEAN_ROOT:-} ]]; then
  cp -a "$TACTUM_CLEAN_ROOT/." "$clean/"
else
  quietly debootstrap --variant=minbase bookworm "$clean" "$archive"
fi
apt-config dump Acquire::http Acquire::https Acquire::Check-Valid-Until Acquire::Check-Date >"$clean/etc/apt/apt.conf.d/90machine"
cp -L /etc/hosts /etc/resolv.conf "$clean/etc/"
mount -t proc proc "$clean/proc"
mkdir "$clean/packages" "$clean/examples"
cp "$packages"/*.deb "$clean/packages/"
cp -r "$root"/examples/*.{cpp,h,c} "$root"/examples/python "$clean/examples/"
cp "$root/tests/packages/CMakeLists.txt" "$clean/examples/"
quietly inside apt-get update
inside sh -c 'dpkg -l | grep -c ^ii' | sed 's/$/ packages in the clean root/'

part "The program"
install "$(deb tactum)"
inside tactum --version
inside tactum feel gears --virtual-clock | grep -E '^(goal|frames)'
inside test -s /usr/share/man/man1/tactum.1.gz
inside test -s /usr/share/bash-completion/completions/tactum

part "Python, as docs/packages.md prints it"
install "$(deb python3-tactum)"
# The line of the page, and the block after it, which says what it prints.
page="$root/docs/packages.md"
line="$(grep -m 1 '^python3 -c ' "$page")" || stop "docs/packages.md has no line of Python"
printed="$(awk '/^python3 -c / { seen = 1 } seen && /^```$/ { fence++; next } seen && /^```text/ { take = 1; next } take && fence >= 2 { exit } take' "$page")"
echo "$line"
found="$(inside sh -c "$line")"
echo "$found"
[[ -n $printed && $found == "$printed" ]] || stop "docs/packages.md says it prints: $printed"
install python3-h5py # which examples/python/demonstrations.py writes its data set with
for script in "$clean"/examples/python/*.py; do
  inside python3 "/examples/python/$(basename "$script")" >"$log" || { cat "$log"; stop "$(basename "$script") has failed"; }
  rm -f "$log"
  echo "ran examples/python/$(basename "$script")"
done

part "C, with the compiler alone"
install "$(deb libtactum-c0.1)" "$(deb libtactum-dev)" gcc libc6-dev
for source in "$clean"/examples/c_*.c; do
  name="$(basename "$source" .c)"
  inside gcc -std=c11 -Wall -Wextra -Wpedantic -Werror "/examples/$name.c" -o "/tmp/$name" -ltactum_c -lm
  inside "/tmp/$name" | tail -1
done
inside gcc -std=c11 -D_POSIX_C_SOURCE=200809L "/examples/network_device.c" -o /tmp/network_device -lm
echo "compiled network_device"

part "C++, by find_package"
install g++ cmake make libmujoco-dev # the last one for the examples with MuJoCo
quietly inside cmake -S /examples -B /tmp/built -DEXAMPLES=/examples
quietly inside cmake --build /tmp/built -j "$jobs"
for source in "$clean"/examples/*.cpp; do
  name="$(basename "$source" .cpp)"
  inside "/tmp/built/$name" >"$log" || { cat "$log"; stop "$name has failed"; }
  rm -f "$log"
  echo "built and ran $name"
done

part "The tools"
install "$(deb tactum-tools)"
for program in "$clean"/usr/bin/tactum-*; do
  inside "$(basename "$program")" help --man >"$clean/page.1" || stop "$program does not start"
  [[ "$(zcat "$clean/usr/share/man/man1/$(basename "$program").1.gz")" == "$(cat "$clean/page.1")" ]] || stop "$program has another manual"
  echo "$(basename "$program") starts, and its manual is its own"
done

part "Removed again"
quietly inside DEBIAN_FRONTEND=noninteractive apt-get purge -y tactum tactum-tools python3-tactum libtactum-dev libtactum-c0.1
left="$(find "$clean/usr" "$clean/etc" "$clean/var/lib" -iname '*tactum*' -not -path "$clean/var/lib/apt/*")"
[[ -z $left ]] || stop "left behind: $left"
echo "nothing is left"
part "All packages hold"
