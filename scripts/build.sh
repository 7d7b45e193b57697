#!/usr/bin/env bash
# Configures where needed and builds: scripts/build.sh [PRESET [TARGET...]]. Presets are those of
# CMakePresets.json (default: release); without targets everything is built.
set -euo pipefail
cd "$(dirname "$0")/.."

preset=${1:-release}
targets=("${@:2}")

# Only the first configuration asks for the preset, and one after the presets have changed; the rest is
# ninja's business. A cache that a copied or moved checkout brought along names other paths and is of no use.
cache=build/$preset/CMakeCache.txt
if [ ! -f "build/$preset/build.ninja" ] || [ CMakePresets.json -nt "$cache" ] ||
    ! grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$(pwd -P)" "$cache"; then
  if command -v ccache >/dev/null; then export CMAKE_CXX_COMPILER_LAUNCHER=ccache; fi
  cmake --fresh --preset "$preset" >&2
elif grep -qE '^(JAVAC|JAR|LCM_JAR):.*-NOTFOUND' "$cache" && command -v javac >/dev/null; then
  cmake "build/$preset" >&2 # a JDK has come since: the message types for Java can be built
fi

# Without this ccache keeps nothing of a file that wants a precompiled header, and every file wants one.
export CCACHE_SLOPPINESS=${CCACHE_SLOPPINESS:-pch_defines,time_macros}

# Two heavy compilations want some 2 GB: never more jobs than cores.
jobs=$(nproc)
if [ ${#targets[@]} -gt 0 ]; then
  cmake --build "build/$preset" -j "$jobs" --target "${targets[@]}" >&2
else
  cmake --build "build/$preset" -j "$jobs" >&2
fi
