#!/usr/bin/env bash
# Makes the site of the documents in build/docs:  tools/docs_site.sh
# Doxygen, over the written pages and the headers (docs/Doxyfile). Fails on a link that leads nowhere and on every warning.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
if ! command -v doxygen >/dev/null; then echo "docs_site: doxygen is not installed (tools/install_packages.sh package)" >&2; exit 77; fi
site="$root/build/docs"
rm -rf "$site"
mkdir -p "$site/html/files"
cd "$root"
version="$(awk '/#define TACTUM_VERSION_(MAJOR|MINOR|PATCH) / { printf "%s%s", dot, $3; dot = "." }' src/tactum/version.h)"
faults=0
{ cat docs/Doxyfile; echo "PROJECT_NUMBER = $version"; echo "USE_MDFILE_AS_MAINPAGE = $root/README.md"; } | doxygen - >"$site/log" 2>&1 || { tail -20 "$site/log" >&2; faults=1; }
if [[ -s $site/warnings ]]; then
  sed "s|$root/||" "$site/warnings" >&2
  faults=1
fi
python3 tools/docs_pages.py --check "$site/html" || faults=1
if (( faults )); then exit 1; fi
ln -sf html/index.html "$site/index.html"
echo "the site is build/docs/html/index.html"
