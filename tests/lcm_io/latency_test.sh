#!/bin/sh
# A robot hears its own near rows and contacts on channels of its own, with stamps by which their latency is known; what
# the run computes and logs is as without them.
set -eu
. "$(dirname "$0")/in_namespace.sh"
throng=$1 latency=$2 scene=$3
fail() { echo "$*"; cat "$dir/table" "$dir/err" "$dir/latency" 2>/dev/null; exit 1; }
run() { "$throng" run "$scene" --seconds 1 --closest-parts 0.3 "$@" >"$dir/table" 2>"$dir/err" || fail "the run failed"; }

timeout 60 "$latency" ROBOT >"$dir/latency" &
pids=$!
sleep 0.3 # it says nothing when it starts
run --publish-for picker:ROBOT --publish-for all:EVERYBODY --log "$dir/told.lcmlog"
wait $pids || fail "the listener failed"
pids=
cat "$dir/latency"
grep -q '^60 frames, 0 missing' "$dir/latency" || fail "not every frame was heard"
grep '^told  *picker by ROBOT: 1 bodies' "$dir/table" || fail "the run does not say what it told"
rows=$(sed -n 's/^told  *all by EVERYBODY:.* \([0-9]*\) near rows/\1/p' "$dir/table")
grep -q "^near .* $rows of two people" "$dir/table" || fail "all is not all: $rows"
run --lcm off --log "$dir/quiet.lcmlog"
cmp "$dir/told.lcmlog" "$dir/quiet.lcmlog" || fail "the logs differ"
for wrong in "--publish-for nobody:ROBOT" "--publish-for picker" "--publish-for picker:ROBOT --lcm off"; do
  code=0
  # shellcheck disable=SC2086
  "$throng" run "$scene" $wrong --log off >"$dir/table" 2>"$dir/err" || code=$?
  [ $code -eq 2 ] && grep -q '^--publish-for: expected ' "$dir/err" || fail "$wrong: exit code $code"
done
