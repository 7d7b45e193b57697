#!/usr/bin/env bash
# Extends Throng by a bounding volume, a scene field, a steering model, a sink, a message and a run option, with a
# patch each.
#   tests/extend/extend_test.sh check SOURCE          checks that they apply and how many files they touch
#   tests/extend/extend_test.sh build SOURCE FOLDER   builds a patched copy in FOLDER, runs the tests of all
#                                                     volumes and models, and `throng run`; takes minutes
set -euo pipefail

declare -A files=([volume]=6 [scene_field]=3 [steering_model]=5 [sink]=5 [message]=3 [option]=4)

mode=${1:-} source=${2:-} folder=${3:-}
here=$(cd "$(dirname "$0")" && pwd)

fail() {
  echo "$*" >&2
  exit 1
}

check() {
  local name touched
  for name in "${!files[@]}"; do
    git -C "$source" apply --check "$here/$name.patch" ||
    fail "$name.patch: expected to apply; make the change again and store the output of git diff"
    touched=$(grep -c '^diff --git' "$here/$name.patch")
    [ "$touched" -eq "${files[$name]}" ] || fail "$name.patch: expected ${files[$name]} files, found $touched"
    echo "$name: $touched files"
  done
}

copy() {
  rm -rf "$folder/source"
  mkdir -p "$folder/source"
  git -C "$source" ls-files -z | (cd "$source" && xargs -0 tar -cf -) | tar -xf - -C "$folder/source"
}

run() {
  echo "+ throng $*"
  build/release/throng "$@"
}

has() { # FILE TEXT
  grep -qF -e "$2" "$1" || fail "$1: expected $2"
}

# The option is the same on the command line, in a study and in Python, and has an effect.
one_option_everywhere() {
  local scene=bottleneck plain given
  plain=$(run run $scene --seconds 5 --lcm off --log off | awk '$1 == "hash" {print $2}')
  given=$(run run $scene --seconds 5 --lcm off --log off --density-dependent-speed | awk '$1 == "hash" {print $2}')
  [ "$given" != "$plain" ] || fail "--density-dependent-speed: expected another hash than $plain"
  printf 'scenes: [%s]\nseconds: 5\ndensity_dependent_speed: true\n' $scene >"$folder/study.yaml"
  run study "$folder/study.yaml" --out "$folder/study.csv" >/dev/null
  grep -q "$given" "$folder/study.csv" || fail "study.csv: expected the hash $given"
  [ "$(PYTHONPATH=build/release/python /usr/bin/python3 -c \
    "import throng; print(throng.run('$scene', seconds=5, density_dependent_speed=True).hash)")" = "$given" ] ||
    fail "throng.run(density_dependent_speed=True): expected the hash $given"
}

build() {
  copy
  cd "$folder/source"
  local name
  for name in "${!files[@]}"; do patch --batch --quiet -p1 <"$here/$name.patch"; done
  bash scripts/build.sh release throng throng_module culling_tests crowd_tests scenes_tests docs_tests lcm_io_tests
  # The schema and the reference pages are generated from the tables of keys and options.
  build/release/throng scenes --schema >scenes/scene.schema.json
  python3 scripts/reference.py
  has scenes/scene.schema.json '"capsule"'
  has docs/reference/scene-keys.md '`headroom_m`'
  has docs/reference/cli.md '--heat-map'
  has docs/reference/lcm.md '`THRONG_PRESENCE`'
  has docs/reference/study-columns.md '`density_dependent_speed`'
  local test
  for test in culling_tests crowd_tests scenes_tests lcm_io_tests; do "build/release/$test" --gtest_brief=1; done
  build/release/docs_tests --gtest_brief=1 --gtest_filter='-*Document*'

  local few=(--avatars 100 --seconds 1 --lcm off --log off)
  run run plaza "${few[@]}" --part-volume capsule --heat-map "$folder/heat.csv" | tail -n 1
  run run corridor "${few[@]}" --steering force | tail -n 1
  awk -F, 'NR > 1 {sum += $3} END {if (sum < 99 || sum > 103) exit 1}' "$folder/heat.csv" ||
    fail "heat.csv: expected about 100 person-seconds"
  run run plaza --avatars 100 --seconds 1 --lcm off --log "$folder/presence.lcmlog" | tail -n 1
  run check "$folder/presence.lcmlog"
  run export "$folder/presence.lcmlog" --csv presence --out "$folder/presence.csv"
  awk -F, 'NR == 1 {if ($3 != "present") exit 1} NR > 1 && $3 == 100 {++frames} END {if (frames != 60) exit 1}' \
    "$folder/presence.csv" || fail "presence.csv: expected 60 frames of 100 people"
  printf '%s\n' 'ground: {min_m: [0, 0], max_m: [10, 10]}' \
    'groups: [{count: 1, spawn: {min_m: [1, 1], max_m: [2, 2]}, goals: [{min_m: [8, 8], max_m: [9, 9]}]}]' \
    'obstacles: [{kind: box, position_m: [5, 5], size_m: [1, 1, 1], bottom_m: 2, headroom_m: 1.9}]' >"$folder/low.yaml"
  run info "$folder/low.yaml" >/dev/null
  one_option_everywhere
  echo "all six are built in, and run"
}

case $mode in
  check) check ;;
  build) check && build ;;
  *)
    echo "extend_test.sh: expected check or build, found '$mode'" >&2
    exit 2
    ;;
esac
