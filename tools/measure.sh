#!/usr/bin/env bash
# Measures the contact queries anew and puts tables and picture into docs/benchmarks.md:  tools/measure.sh
# Takes a quarter of an hour, longer on a busy machine; leave it alone meanwhile. Rows go to out/bench-*.json.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

tactum="$root/build/release/tactum"
page="$root/docs/benchmarks.md"
mkdir -p "$root/out"
"$tactum" bench pairs --json "$root/out/bench-pairs.json" --svg "$root/docs/pictures/pairs.svg" --markdown "$page"
"$tactum" bench penetration --referee-seconds 4 --json "$root/out/bench-penetration.json" --markdown "$page"
"$tactum" bench manifold --json "$root/out/bench-manifold.json" --markdown "$page"
"$tactum" bench impact --json "$root/out/bench-impact.json" --markdown "$page"
"$tactum" bench feel --json "$root/out/bench-feel.json" --svg "$root/docs/pictures/feel.svg" --markdown "$page"
# Real parts, where they are: see tests/support/real_data.h.
data="${TACTUM_DATA:-$root/../shared/data}"
"$tactum" bench surfaces --data "$data" --json "$root/out/bench-surfaces.json" --markdown "$page"
