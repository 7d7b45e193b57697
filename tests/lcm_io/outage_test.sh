#!/bin/sh
# The network goes away in the middle of a run and comes back: the run goes on, says what was not
# taken, and who listens knows exactly what is missing.
set -eu
. "$(dirname "$0")/in_namespace.sh"
throng=$1

"$throng" monitor --json --until-end --seconds 600 >"$dir/seen.json" &
monitor=$!
pids=$monitor
sleep 1
"$throng" run corridor --seconds 6 --pace 1 --log "$dir/run.lcmlog" --flush-s 0 --json "$dir/run.json" \
  >"$dir/table" 2>"$dir/err" &
run=$!
pids="$pids $run"
# Once something is written, the run has loaded its people and keeps to the clock.
for _ in $(seq 600); do
  [ "$(stat -c %s "$dir/run.lcmlog" 2>/dev/null || echo 0)" -gt 0 ] && break
  sleep 0.1
done
sleep 2
ip link set lo down
sleep 1
ip link set lo up
ip route add 224.0.0.0/4 dev lo
wait $run || { echo "the run failed:"; cat "$dir/err"; exit 1; }
wait $monitor || { echo "the monitor failed"; exit 1; }

number() { sed -n "s/.*\"$2\": \([0-9]*\).*/\1/p" "$dir/$1" | head -n 1; }
dropped=$(number run.json dropped)
lost=$(number seen.json lost)
frames=$(number seen.json frames)
echo "not taken by LCM: $dropped; lost for the monitor: $lost; frames heard: $frames of 360"
[ "$dropped" -gt 0 ] || { echo "the network was never away"; exit 1; }
[ "$frames" -lt 360 ] && [ "$frames" -gt 200 ] || { echo "it did not come back"; exit 1; }
grep -q '"last_frame": 359' "$dir/seen.json" || { echo "the last frame was not heard"; exit 1; }
[ "$lost" -eq "$dropped" ] || { echo "what is lost is not what was not taken"; exit 1; }
grep -q 'did not take a message' "$dir/err" || { echo "nobody was told"; exit 1; }
