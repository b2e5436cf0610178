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
# as it is. Many files at once, in a copy: most of the time for one is that of starting clang-format.
copy="$(mktemp -d)"
trap 'rm -rf "$copy"' EXIT
cp .clang-format "$copy"
files | xargs -0 cp -p --parents -t "$copy"
(cd "$copy" && files | xargs -0 -r -n 24 -P 2 clang-format -i)
status=0
while IFS= read -r -d '' file; do
  cmp -s "$file" "$copy/$file" || { echo "$file is not laid out as tools/format.sh does it"; status=1; }
done < <(files)
exit "$status"
