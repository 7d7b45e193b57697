#!/usr/bin/env bash
# Line coverage of base, culling, kinematics, avatars and lcm_io by the tests of these folders:
# scripts/coverage.sh [MIN], MIN per cent of each folder (default 90). Prints a line per folder and the uncovered
# lines; exit code 1 if a folder has less. Report: build/coverage/report/index.html.
set -euo pipefail
cd "$(dirname "$0")/.."

min=${1:-90}
folders=(base culling kinematics avatars lcm_io)
tests=(base_tests culling_tests allocation_tests kinematics_tests avatars_tests gait_tests lcm_io_tests)
if ! command -v gcovr >/dev/null; then
  echo "scripts/coverage.sh: expected gcovr; scripts/setup.sh reliability installs it" >&2
  exit 3
fi
bash scripts/build.sh coverage "${tests[@]}"

build=build/coverage
find "$build" -name '*.gcda' -delete
for test in "${tests[@]}"; do
  "$build/$test" --gtest_brief=1 >"$build/$test.txt" 2>&1 || { cat "$build/$test.txt" >&2; exit 1; }
done

mkdir -p "$build/report"
lines=$build/report/lines.json
filters=()
for folder in "${folders[@]}"; do filters+=(--filter "$folder/"); done
# Excludes lines that the compiler adds to clean up after exceptions.
gcovr --root . --object-directory "$build" -j "$(nproc)" "${filters[@]}" --exclude-throw-branches \
  --json "$lines" "${folders[@]/#/$build/}" "$build/tests"
gcovr --root . --add-tracefile "$lines" --html-details "$build/report/index.html"
gcovr --root . --add-tracefile "$lines" | grep '%' | grep -v '100%' || true
status=0
for folder in "${folders[@]}"; do
  # The last figure covers all files.
  percent=$(gcovr --root . --add-tracefile "$lines" --filter "$folder/" --json-summary |
    sed -n 's/.*"line_percent": *\([0-9.]*\).*/\1/p' | tail -n 1)
  printf '[ coverage ] %-12s %s %% of lines\n' "$folder" "$percent"
  if awk -v percent="$percent" -v min="$min" 'BEGIN {exit !(percent < min)}'; then status=1; fi
done
[ "$status" -eq 0 ] || echo "scripts/coverage.sh: expected $min % of lines in each folder" >&2
exit "$status"
