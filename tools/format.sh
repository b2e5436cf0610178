#!/usr/bin/env bash
# Lays out every C++ file; with --check only says which are not laid out, and fails.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
folders=()
for folder in src app viewer/server tests bench fuzz examples; do [[ ! -d $folder ]] || folders+=("$folder"); done
files() { find "${folders[@]}" \( -name '*.h' -o -name '*.cpp' \) -print0; }
if [[ ${1:-} != --check ]]; then
  files | xargs -0 -r clang-format -i
  exit
fi
# By its output: with --dry-run clang-format 14 takes the comment behind `namespace a::inline b` for wrong, and writes it
# as it is.
files | xargs -0 -r -n 32 -P 2 bash -c '
  status=0
  for file in "$@"; do
    clang-format "$file" | cmp -s - "$file" || { echo "$file is not laid out as tools/format.sh does it"; status=1; }
  done
  exit $status' check
