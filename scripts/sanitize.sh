#!/usr/bin/env bash
# Runs the test suite under sanitizers: scripts/sanitize.sh [asan|tsan [CTEST OPTION...]], both by default. asan finds
# invalid addresses, undefined behaviour and leaks, tsan data races. Prints a line per sanitizer; exit code 1 if a
# test failed or any program wrote a report, which includes killed programs. Reports are stored in
# build/PRESET/reports.
set -euo pipefail
cd "$(dirname "$0")/.."

presets=(asan tsan)
if [ $# -gt 0 ]; then
  case "$1" in
    asan | tsan) presets=("$1") ;;
    *) echo "scripts/sanitize.sh: expected asan or tsan, found '$1'" >&2; exit 2 ;;
  esac
fi

status=0
for preset in "${presets[@]}"; do
  folder=$PWD/build/$preset/reports
  rm -rf "$folder"
  mkdir -p "$folder"
  bash scripts/build.sh "$preset"
  begun=$SECONDS
  # Nightly tests are included. A report file per process: no report is overlooked.
  THRONG_NIGHTLY=1 ASAN_OPTIONS=log_path=$folder/report UBSAN_OPTIONS=log_path=$folder/report \
    TSAN_OPTIONS=log_path=$folder/report \
    bash scripts/test.sh "$preset" "${@:2}" 2>&1 | tee "build/$preset/tests.log" || status=1
  reports=$(find "$folder" -type f | wc -l)
  echo "[ $preset ] $(tail -n 1 "build/$preset/tests.log"), $reports reports, $((SECONDS - begun)) s"
  if [ "$reports" -gt 0 ]; then
    grep -h SUMMARY "$folder"/* | sort | uniq -c >&2 || true
    status=1
  fi
done
exit "$status"
