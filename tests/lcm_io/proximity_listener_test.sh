#!/bin/sh
# The example listener receives every proximity row of the run, and each row is of the robot.
# The run is limited to five times real time, because it would otherwise outpace the listener.
set -eu
. "$(dirname "$0")/in_namespace.sh"
throng=$1 listener=$2 scene=$3
fail() { echo "$*"; cat "$dir/table" "$dir/err" 2>/dev/null; exit 1; }

"$listener" >"$dir/heard" &
pids=$!
sleep 0.3 # the listener prints nothing at its start
"$throng" run "$scene" --seconds 5 --pace 5 --log off >"$dir/table" 2>"$dir/err" || fail "the run failed"
rows=$(sed -n 's/^proximity  *\([0-9]*\) rows of parts.*/\1/p' "$dir/table")
[ "${rows:-0}" -gt 0 ] || fail "no proximity rows"
tries=0
while [ "$(wc -l <"$dir/heard")" -lt "$rows" ] && [ $tries -lt 100 ]; do
  sleep 0.1
  tries=$((tries + 1))
done
[ "$(wc -l <"$dir/heard")" -eq "$rows" ] || fail "$(wc -l <"$dir/heard") rows received of $rows"
[ "$(grep -c '^[0-9.]* s: part [0-2] of 0 and part [0-9]* of [1-6] are ' "$dir/heard")" -eq "$rows" ] ||
  fail "some rows are not of the robot: $(grep -v ' of 0 and ' "$dir/heard" | head -n 1)"
