#!/usr/bin/env bash
# Measures the contact queries anew and puts tables and picture into docs/benchmarks.md:  tools/measure.sh
# Takes a quarter of an hour, longer on a busy machine; leave it alone meanwhile. Rows go to out/bench-*.json.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

configure release
build release tactum-bench
bench="$root/build/release/tactum-bench"
page="$root/docs/benchmarks.md"
mkdir -p "$root/out"
"$bench" pairs --json "$root/out/bench-pairs.json" --svg "$root/docs/pictures/pairs.svg" --markdown "$page"
"$bench" penetration --referee-seconds 4 --json "$root/out/bench-penetration.json" --markdown "$page"
"$bench" manifold --json "$root/out/bench-manifold.json" --markdown "$page"
"$bench" impact --json "$root/out/bench-impact.json" --markdown "$page"
"$bench" feel --json "$root/out/bench-feel.json" --svg "$root/docs/pictures/feel.svg" --markdown "$page"
# Real parts, where they are: see tests/support/real_data.h.
data="${TACTUM_DATA:-$root/../shared/data}"
"$bench" surfaces --data "$data" --json "$root/out/bench-surfaces.json" --markdown "$page"
