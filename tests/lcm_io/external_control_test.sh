#!/bin/sh
# The example controller moves a robot through people in real time, and the run reports the messages.
set -eu
. "$(dirname "$0")/in_namespace.sh"
throng=$1 controller=$2 urdf=$3

cat >"$dir/robot.yaml" <<SCENE
name: controlled robot
ground: {min_m: [-8, -8], max_m: [8, 8]}
groups:
  - name: robot
    model: $urdf
    count: 1
    control_channel: ROBOT
    radius_m: 0.35
    spawn: {min_m: [2.5, -0.5], max_m: [3.5, 0.5]}
  - name: people
    count: 40
    spawn: {min_m: [-7, -7], max_m: [2, 7]}
    goals:
      - {min_m: [5, -7], max_m: [7, 7]}
      - {min_m: [-7, -7], max_m: [-5, 7]}
SCENE

# Longer than the run on any machine; killed at the end of the test.
"$controller" ROBOT 0 600 &
pids=$!
"$throng" run "$dir/robot.yaml" --seconds 5 --pace 1 --log "$dir/a.lcmlog" --json "$dir/run.json" \
  >"$dir/table" 2>"$dir/err"
number() { sed -n "s/.*\"$1\": \([0-9]*\).*/\1/p" "$dir/run.json" | head -n 1; }
grep '^external' "$dir/table"
grep -q "'robot' is controlled through LCM channel ROBOT" "$dir/err" || {
  echo "the run does not report its external control"
  exit 1
}
# The controller sends 50 messages per second, the run has 60 frames.
[ "$(number messages)" -gt 0 ] && sed -n '/"external_control"/,$p' "$dir/run.json" >"$dir/external"
messages=$(sed -n 's/.*"messages": \([0-9]*\).*/\1/p' "$dir/external" | head -n 1)
[ "$messages" -gt 100 ] || { echo "$messages messages moved the robot"; exit 1; }
grep -q '"rejected": 0' "$dir/external" || { echo "messages were rejected"; exit 1; }
"$throng" check "$dir/a.lcmlog" >/dev/null
"$throng" info "$dir/a.lcmlog" | grep 'group robot: 1 avatar, controlled by ROBOT'
