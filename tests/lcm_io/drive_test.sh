#!/bin/sh
# The driver of docs/lcm.md moves a robot through people, live, and the run says how that went.
set -eu
. "$(dirname "$0")/in_namespace.sh"
throng=$1 driver=$2 urdf=$3

cat >"$dir/robot.yaml" <<SCENE
name: driven robot
ground: {min_m: [-8, -8], max_m: [8, 8]}
groups:
  - name: robot
    model: $urdf
    count: 1
    control_channel: ROBOT_DRIVE
    radius_m: 0.35
    spawn: {min_m: [2.5, -0.5], max_m: [3.5, 0.5]}
  - name: people
    count: 40
    spawn: {min_m: [-7, -7], max_m: [2, 7]}
    goals:
      - {min_m: [5, -7], max_m: [7, 7]}
      - {min_m: [-7, -7], max_m: [-5, 7]}
SCENE

# Longer than any machine takes for the run; it is ended with the test.
"$driver" ROBOT_DRIVE 0 600 &
pids=$!
"$throng" run "$dir/robot.yaml" --seconds 5 --pace 1 --log "$dir/a.lcmlog" --json "$dir/run.json" \
  >"$dir/table" 2>"$dir/err"
number() { sed -n "s/.*\"$1\": \([0-9]*\).*/\1/p" "$dir/run.json" | head -n 1; }
grep '^driven' "$dir/table"
grep -q "'robot' is driven by what comes on LCM channel ROBOT_DRIVE" "$dir/err" || {
  echo "the run does not say that it depends on the outside"
  exit 1
}
# The driver sends 50 a second, the run has 60 frames.
[ "$(number messages)" -gt 0 ] && sed -n '/"driven"/,$p' "$dir/run.json" >"$dir/driven"
messages=$(sed -n 's/.*"messages": \([0-9]*\).*/\1/p' "$dir/driven" | head -n 1)
[ "$messages" -gt 100 ] || { echo "$messages messages moved the robot"; exit 1; }
grep -q '"refused": 0' "$dir/driven" || { echo "messages were refused"; exit 1; }
"$throng" check "$dir/a.lcmlog" >/dev/null
"$throng" info "$dir/a.lcmlog" | grep 'group robot: 1 avatar, driven by ROBOT_DRIVE'
