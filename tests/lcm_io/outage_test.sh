#!/bin/sh
# The network is lost in the middle of a run and returns: the run continues and reports dropped messages, and the
# monitor reports exactly the missing ones.
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
# Once the log is not empty, the run has loaded its people and runs in real time.
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
echo "dropped by LCM: $dropped; missing in the monitor: $lost; frames received: $frames of 360"
[ "$dropped" -gt 0 ] || { echo "no message was dropped"; exit 1; }
[ "$frames" -lt 360 ] && [ "$frames" -gt 200 ] || { echo "the network did not return"; exit 1; }
grep -q '"last_frame": 359' "$dir/seen.json" || { echo "the last frame was not received"; exit 1; }
[ "$lost" -eq "$dropped" ] || { echo "missing and dropped messages differ"; exit 1; }
grep -q 'rejected a message' "$dir/err" || { echo "no warning"; exit 1; }
