#!/usr/bin/env bash
# Installs what is missing of the given sections of tools/packages.txt:  tools/install_packages.sh run [test]
# Says nothing when nothing is missing. TACTUM_SKIP_INSTALL=1 leaves the machine as it is.
set -euo pipefail

list="$(dirname "${BASH_SOURCE[0]}")/packages.txt"
stop() { echo "install_packages: $*" >&2; exit 1; }

[[ $# -gt 0 ]] || stop "which sections? for instance: tools/install_packages.sh run test"
[[ ${TACTUM_SKIP_INSTALL:-0} != 1 ]] || exit 0

wanted=()
for section in "$@"; do
  mapfile -t found < <(awk -v section="[$section]" '/^\[/ { on = ($1 == section) } on && /^[a-z0-9]/ { print $1 }' "$list")
  [[ ${#found[@]} -gt 0 ]] || stop "there is no section [$section] in $list"
  wanted+=("${found[@]}")
done

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  stop "this is not a Debian machine. Install these in your system's own way, then set TACTUM_SKIP_INSTALL=1: ${wanted[*]%%|*}"
fi

missing=()
for entry in "${wanted[@]}"; do
  package="${entry%%|*}"
  if [[ "$entry" == *"|"* ]] && command -v "${entry#*|}" >/dev/null; then continue; fi
  [[ $(dpkg-query -W -f '${Status}' "$package" 2>/dev/null) == "install ok installed" ]] || missing+=("$package")
done
[[ ${#missing[@]} -gt 0 ]] || exit 0

as_root=()
if [[ $(id -u) -ne 0 ]]; then
  command -v sudo >/dev/null || stop "packages are missing, and this is neither root nor is there sudo. As root: apt-get install ${missing[*]}"
  as_root=(sudo)
fi

# The lock is waited for: a fresh machine may still be updating itself.
apt() {
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -o DPkg::Lock::Timeout=300 -o Dpkg::Use-Pty=0 "$@" </dev/null
}
install() { apt install -y --no-install-recommends "${missing[@]}" >"$log" 2>&1; }

echo "Installing ${#missing[@]} packages: ${missing[*]}"
log="$(mktemp)"
trap 'rm -f "$log"' EXIT
# A machine with a package index needs no new one, unless the index is so old that its files are gone.
if ! install; then
  apt update >>"$log" 2>&1 || { cat "$log" >&2; stop "apt-get update failed: is there a network?"; }
  install || { cat "$log" >&2; stop "apt-get could not install: ${missing[*]}"; }
fi
