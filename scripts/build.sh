#!/usr/bin/env bash
# Configures if needed and builds: scripts/build.sh [PRESET [TARGET...]]. Presets are those of CMakePresets.json
# (default: release); without targets everything is built.
set -euo pipefail
cd "$(dirname "$0")/.."

preset=${1:-release}
targets=("${@:2}")

# The preset is configured once, and again if the presets change; ninja does the rest. The cache of a copied or
# moved checkout names other paths and is rebuilt.
cache=build/$preset/CMakeCache.txt
if [ ! -f "build/$preset/build.ninja" ] || [ CMakePresets.json -nt "$cache" ] ||
    ! grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$(pwd -P)" "$cache"; then
  if command -v ccache >/dev/null; then export CMAKE_CXX_COMPILER_LAUNCHER=ccache; fi
  cmake --fresh --preset "$preset" >&2
elif grep -qE '^(JAVAC|JAR|LCM_JAR):.*-NOTFOUND' "$cache" && command -v javac >/dev/null; then
  cmake "build/$preset" >&2 # a JDK was installed: the message types for Java can be built
fi

# ccache ignores files with a precompiled header otherwise, and every file has one.
export CCACHE_SLOPPINESS=${CCACHE_SLOPPINESS:-pch_defines,time_macros}

# Two heavy compilations need 2 GB: at most one job per core.
jobs=$(nproc)
if [ ${#targets[@]} -gt 0 ]; then
  cmake --build "build/$preset" -j "$jobs" --target "${targets[@]}" >&2
else
  cmake --build "build/$preset" -j "$jobs" >&2
fi
