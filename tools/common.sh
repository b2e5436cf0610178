# shellcheck shell=bash
# What ./run and ./test share; sourced, never run. Sets `root` and `jobs`.
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"

# As many compilers as there are cores, but each needs about 1.5 GB at its peak.
memory_GB="$(awk '/MemAvailable/ { print int($2 / 1048576) }' /proc/meminfo)"
jobs="$(nproc)"
if (( memory_GB * 2 / 3 < jobs )); then jobs=$(( memory_GB * 2 / 3 )); fi
if (( jobs < 1 )); then jobs=1; fi

# Paths and folders do not matter to the compiler cache: a fresh clone beside this one finds it warm.
export CCACHE_BASEDIR="$root" CCACHE_NOHASHDIR=1

# configure PRESET [CMAKE OPTION...]: quiet unless it fails.
configure() {
  local preset="$1" log
  shift
  mkdir -p "$root/build"
  log="$root/build/configure-$preset.log"
  cmake -S "$root" --preset "$preset" "$@" >"$log" 2>&1 || { cat "$log" >&2; return 1; }
}

# build PRESET [TARGET...]
build() {
  local preset="$1"
  shift
  cmake --build "$root/build/$preset" -j "$jobs" ${1:+--target "$@"}
}
