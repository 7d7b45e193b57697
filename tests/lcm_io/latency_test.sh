#!/bin/sh
# A robot receives its proximity rows and contacts on separate channels, with stamps for their latency. The log is the
# same as without them.
set -eu
. "$(dirname "$0")/in_namespace.sh"
throng=$1 latency=$2 scene=$3
fail() { echo "$*"; cat "$dir/table" "$dir/err" "$dir/latency" 2>/dev/null; exit 1; }
run() { "$throng" run "$scene" --seconds 1 --closest-parts 0.3 "$@" >"$dir/table" 2>"$dir/err" || fail "the run failed"; }

timeout 60 "$latency" ROBOT >"$dir/latency" &
pids=$!
sleep 0.3 # the listener prints nothing at its start
run --publish-for picker:ROBOT --publish-for all:ALL_BODIES --log "$dir/published.lcmlog"
wait $pids || fail "the listener failed"
pids=
cat "$dir/latency"
grep -q '^60 frames, 0 missing' "$dir/latency" || fail "some frames were not received"
grep '^published  *picker by ROBOT: 1 bodies' "$dir/table" || fail "the run does not report the published rows"
rows=$(sed -n 's/^published  *all by ALL_BODIES:.* \([0-9]*\) proximity rows/\1/p' "$dir/table")
grep -q "^proximity .* $rows of closest parts" "$dir/table" || fail "expected all rows, found $rows"
run --lcm off --log "$dir/quiet.lcmlog"
cmp "$dir/published.lcmlog" "$dir/quiet.lcmlog" || fail "the logs differ"
for wrong in "--publish-for nobody:ROBOT" "--publish-for picker" "--publish-for picker:ROBOT --lcm off"; do
  code=0
  # shellcheck disable=SC2086
  "$throng" run "$scene" $wrong --log off >"$dir/table" 2>"$dir/err" || code=$?
  [ $code -eq 2 ] && grep -q '^--publish-for: expected ' "$dir/err" || fail "$wrong: exit code $code"
done
