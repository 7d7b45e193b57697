#!/usr/bin/env bash
# Checks that each scene has one hash: 1, 2, 3 and 8 threads, every SIMD target of this machine, every pair
# search, for the given builds: scripts/determinism.sh [PRESET...] (default: release). For other compilers and
# optimisation: `scripts/determinism.sh release debug checked clang`. glibc's tunables simulate a processor
# without fused multiply-add, because the C library selects code by processor. Exit code 1 if two runs differ;
# --trace-hash of both then names the first stage and frame.
set -euo pipefail
cd "$(dirname "$0")/.."

presets=("$@")
[ ${#presets[@]} -gt 0 ] || presets=(release)
for preset in "${presets[@]}"; do bash scripts/build.sh "$preset" throng; done

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
scenes=("corridor --seconds 1" "plaza --avatars 300 --seconds 1 --exact" "paper_50 --seconds 1")
compared=0 splits=0

hash_of() { # PRESET SCENE OPTION...: "" if this machine cannot run it, "exit code N" if it broke
  local preset=$1 scene=$2 out="$folder/out" err="$folder/err" code=0
  # shellcheck disable=SC2086 # the scene is a name and its options
  "build/$preset/throng" run $scene "${@:3}" --lcm off --log off >"$out" 2>"$err" || code=$?
  if [ "$code" -eq 0 ]; then
    sed -n 's/^hash *//p' "$out"
  elif ! grep -q 'this machine cannot run SIMD target' "$err"; then
    echo "exit code $code"
  fi
}

for scene in "${scenes[@]}"; do
  expected=$(hash_of "${presets[0]}" "$scene" --threads 1 --simd scalar)
  case $expected in
    "" | exit*) echo "scripts/determinism.sh: '$scene' does not run: $expected" >&2; exit 1 ;;
  esac
  compare() { # WHAT HASH
    [ -n "$2" ] || return 0
    compared=$((compared + 1))
    [ "$2" = "$expected" ] && return 0
    splits=$((splits + 1))
    echo "split: $scene: $1 gives $2, expected $expected"
  }
  for preset in "${presets[@]}"; do
    for threads in 1 2 3 8; do
      for simd in scalar sse4 avx2 avx512; do
        compare "$preset, $threads threads, $simd" \
          "$(hash_of "$preset" "$scene" --threads "$threads" --simd "$simd")"
      done
    done
    for search in sweep brute; do
      compare "$preset, $search" "$(hash_of "$preset" "$scene" --threads 2 --pair-search $search)"
    done
    compare "$preset, a processor without AVX and FMA" \
      "$(GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX,-AVX2,-FMA,-FMA4,-AVX512F \
        hash_of "$preset" "$scene" --threads 2 --simd sse4)"
  done
done
echo "[ hashes ] $compared compared, $splits splits"
[ "$splits" -eq 0 ]
