#!/usr/bin/env bash
# Lays out every C++ file; with --check only says which are not laid out, and fails.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
mode=(-i)
[[ ${1:-} != --check ]] || mode=(--dry-run --Werror)
folders=()
for folder in src app viewer/server tests bench fuzz examples; do [[ ! -d $folder ]] || folders+=("$folder"); done
find "${folders[@]}" \( -name '*.h' -o -name '*.cpp' \) -print0 | xargs -0 -r clang-format "${mode[@]}"
