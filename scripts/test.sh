#!/usr/bin/env bash
# Installs missing packages, builds, and runs every test: scripts/test.sh [PRESET [CTEST OPTION...]], for example
# `scripts/test.sh debug` or `scripts/test.sh release -R culling`. The last line counts passed, failed and skipped
# tests; exit code 1 if one failed.
set -euo pipefail
cd "$(dirname "$0")/.."

preset=${1:-release}
bash scripts/setup.sh test
bash scripts/setup.sh page || echo "scripts/test.sh: no browser: the page is tested in node only" >&2
bash scripts/build.sh "$preset"

export GTEST_COLOR=no

report=$PWD/build/$preset/tests.xml
rm -f "$report"
status=0
# One more job than cores, because some tests wait for a paced run.
ctest --test-dir "build/$preset" -j "$(($(nproc) + 1))" --output-on-failure --no-tests=error \
  --output-junit "$report" "${@:2}" </dev/null || status=$?

count() { sed -n "s/^[[:space:]]*$1=\"\([0-9]*\)\".*/\1/p" "$report" | head -n 1; }
if [ ! -f "$report" ]; then
  echo "0 passed, 0 failed: no test ran"
  exit 1
fi
total=$(count tests) failed=$(count failures) skipped=$(count skipped) disabled=$(count disabled)
skipped=$((skipped + disabled))
echo "$((total - failed - skipped)) passed, $failed failed, $skipped skipped"
if [ "$failed" -gt 0 ]; then status=1; fi
exit "$status"
