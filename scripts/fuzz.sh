#!/usr/bin/env bash
# Fuzzes the readers of files and messages with address and undefined behaviour sanitizers: scripts/fuzz.sh
# [SECONDS [TARGET...]], 60 seconds per target by default, one target per core at a time. Prints a line per
# target. Failing inputs are stored in build/fuzz/found/TARGET; give them a descriptive name and move them to
# tests/fuzz/found/TARGET, and the test suite replays them.
set -euo pipefail
cd "$(dirname "$0")/.."

seconds=${1:-60}
targets=("${@:2}")
[ ${#targets[@]} -gt 0 ] || targets=(tri urdf scene starts study study_table messages log culled_log checkpoint recording wkt plan mesh)

if ! command -v clang++ >/dev/null; then
  echo "scripts/fuzz.sh: expected clang++ with libFuzzer; scripts/setup.sh reliability installs it" >&2
  exit 3
fi
# The preset leaves out what takes half of its compilation: kernels of several SIMD targets, which no input reaches,
# and checks that the address sanitizer makes as well (null, overflowing pointers) or that hardly depend on the input
# (alignment, vtables, object sizes). The test suite has all of them in scripts/sanitize.sh, with the stored inputs.
bash scripts/build.sh fuzz fuzz_seeds fuzzer
build=build/fuzz
"$build/fuzz_seeds" "$build/seeds"

fuzz() { # TARGET: its report in build/fuzz/TARGET.txt, with the exit code in the last line
  local target=$1 max_bytes=65536 status=0
  # Long enough for crashes by depth and length, short enough for many inputs per second.
  case "$target" in urdf) max_bytes=262144 ;; checkpoint) max_bytes=4096 ;; esac
  mkdir -p "$build/corpus/$target" "$build/found/$target"
  # URDFs of 10 000 links take a second to reject under the sanitizers; a minute is a hang.
  THRONG_FUZZ_TARGET=$target "$build/fuzzer" -max_total_time="$seconds" -max_len="$max_bytes" -timeout=60 \
    -rss_limit_mb=2048 -print_final_stats=1 -artifact_prefix="$build/found/$target/" \
    "$build/corpus/$target" "$build/seeds/$target" >"$build/$target.txt" 2>&1 || status=$?
  echo "exit code $status" >>"$build/$target.txt"
}
export -f fuzz
export build seconds
printf '%s\n' "${targets[@]}" | xargs -P "$(nproc)" -I TARGET bash -c 'fuzz TARGET'

status=0
printf '%-12s %12s %10s %8s\n' target inputs corpus broken
for target in "${targets[@]}"; do
  [ "$(tail -n 1 "$build/$target.txt")" = "exit code 0" ] || status=1
  inputs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$build/$target.txt")
  printf '%-12s %12s %10s %8s\n' "$target" "${inputs:-0}" \
    "$(find "$build/corpus/$target" -type f | wc -l)" \
    "$(find "$build/found/$target" -type f | wc -l)"
done
[ "$status" -eq 0 ] || echo "failing inputs: $build/found; reports: $build/TARGET.txt" >&2
exit "$status"
