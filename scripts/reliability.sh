#!/usr/bin/env bash
# Checks every guarantee of docs/reliability.md in short form: scripts/reliability.sh [PAIRS]; PAIRS close pairs of
# parts against triangles (default 1000000; the long form has 10000000). Prints its steps and a table. Exit code 1
# if a guarantee is broken.
#
# Not included: checks with a separate build (scripts/fuzz.sh with clang, scripts/sanitize.sh) and checks that take
# hours (scripts/soak.sh 60).
set -uo pipefail
cd "$(dirname "$0")/.."

pairs=${1:-1000000}
bash scripts/build.sh release throng no_miss fuzz_replay mutated_meshes scenes_tests apps_tests || exit
build=$PWD/build/release
out=$(mktemp)
trap 'rm -f "$out" "$out.step"' EXIT
status=0
begun=$SECONDS

step() { # WHAT COMMAND...
  local start=$SECONDS
  echo "== $1"
  if ! "${@:2}" >"$out.step" 2>&1; then
    cat "$out.step" >&2
    echo "   broken: $1"
    status=1
  fi
  grep -E '^\[ (inputs|faults|figures|hashes|soak) \]|^split|^family|^all' "$out.step"
  cat "$out.step" >>"$out"
  echo "   $((SECONDS - start)) s"
}

step "hostile input" env THRONG_FUZZ_ROUNDS=100 "$build/fuzz_replay"
step "damaged meshes" "$build/mutated_meshes" 1000
step "faults" env THRONG_KILLS=100 "$build/apps_tests" --gtest_filter='Faults.*:Signals/*:Trace.*'
step "checkpoints" "$build/scenes_tests" --gtest_filter='*Resume*'
step "one hash" bash scripts/determinism.sh release
step "load" "$build/scenes_tests" --gtest_filter='Stress.*'
step "no misses" "$build/no_miss" "$pairs"
step "soak" bash scripts/soak.sh 1 0

sum() { # the sum of the numbers that a sed expression finds
  sed -n "$1" "$out" | awk '{total += $1} END {printf "%d\n", total}'
}
echo
printf '%-18s %12s\n' \
  "inputs tried" "$(sum 's/^\[ inputs \].*: \([0-9]*\) tried.*/\1/p')" \
  "faults survived" "$(sum 's/^\[ faults \].*: \([0-9]*\) survived.*/\1/p')" \
  "events written" "$(sum 's/^\[ soak \].* \([0-9]*\) events written.*/\1/p')" \
  "events lost" "$(sum 's/^\[ soak \].* \(-*[0-9]*\) lost.*/\1/p')" \
  "hashes compared" "$(sum 's/^\[ hashes \] \([0-9]*\) compared.*/\1/p')" \
  "splits" "$(sum 's/^\[ hashes \].* \([0-9]*\) splits.*/\1/p')" \
  "close pairs" "$(sum 's/^all *\([0-9]*\) .*/\1/p')" \
  "missed" "$(sum 's/^all.* \([0-9]*\)$/\1/p')" \
  "seconds" "$((SECONDS - begun))"
[ "$status" -eq 0 ] || echo "a guarantee is broken: see above" >&2
exit "$status"
