#!/usr/bin/env bash
# Feeds the readers of files and messages with damaged input under the address and undefined
# behaviour sanitizers: scripts/fuzz.sh [SECONDS [TARGET...]]; 60 seconds a target unless told, as
# many at a time as there are cores. Prints a line a target. What breaks one is kept in
# build/fuzz/found/TARGET; give it a name there that says what it is, move it to
# tests/fuzz/found/TARGET, and the test suite replays it for ever.
set -euo pipefail
cd "$(dirname "$0")/.."

seconds=${1:-60}
targets=("${@:2}")
[ ${#targets[@]} -gt 0 ] || targets=(tri urdf scene study study_table messages log culled_log checkpoint recording wkt mesh)

if ! command -v clang++ >/dev/null; then
  echo "scripts/fuzz.sh: expected clang++ with libFuzzer; scripts/setup.sh reliability installs it" >&2
  exit 3
fi
bash scripts/build.sh fuzz fuzz_seeds fuzzer
build=build/fuzz
"$build/fuzz_seeds" "$build/seeds"

fuzz() { # TARGET: its report in build/fuzz/TARGET.txt, with the exit code in the last line
  local target=$1 most_bytes=65536 status=0
  # Long enough for the crashers of depth and length, short enough to try many a second.
  case "$target" in urdf) most_bytes=262144 ;; checkpoint) most_bytes=4096 ;; esac
  mkdir -p "$build/corpus/$target" "$build/found/$target"
  # URDFs of 10 000 links take a second to refuse under the sanitizers; a minute is a hang.
  THRONG_FUZZ_TARGET=$target "$build/fuzzer" -max_total_time="$seconds" -max_len="$most_bytes" -timeout=60 \
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
[ "$status" -eq 0 ] || echo "broken by what lies in $build/found; the reports: $build/TARGET.txt" >&2
exit "$status"
