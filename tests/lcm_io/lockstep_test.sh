#!/bin/sh
# A robot in lockstep: the hash does not depend on its controller's delays and language, and a dead controller gives
# one line of error.
set -eu
. "$(dirname "$0")/in_namespace.sh"
throng=$1 controller=$2 examples=$3 classes=$4
scene=$examples/keep_distance.yaml
python=/usr/bin/python3
fail() { echo "$*"; cat "$dir/err"; exit 1; }

# Starts a controller in the background: drive LANGUAGE SLEEP_S.
drive() {
  if [ "$1" = python ]; then
    PYTHONPATH=$classes PYTHONDONTWRITEBYTECODE=1 "$python" "$examples/keep_distance.py" "$2" &
  else
    "$controller" "$2" &
  fi
  pids=$!
}
hash_of() { sed -n 's/^hash *//p' "$dir/table"; }

languages="c++ c++ c++ c++ c++"
if [ -x "$python" ]; then languages="$languages python python python python python"; fi
first=
for language in $languages; do
  drive "$language" 0.01
  "$throng" run "$scene" --seconds 3 --lockstep --log "$dir/a.lcmlog" >"$dir/table" 2>"$dir/err" || fail "the run failed"
  wait $pids || fail "the controller in $language failed"
  pids=
  : "${first:=$(hash_of)}"
  echo "$language: $(hash_of); $(grep '^lockstep' "$dir/table")"
  [ "$(hash_of)" = "$first" ] || fail "the hash in $language differs from $first"
  grep -q '18[01] replies' "$dir/table" || fail "some frames have no reply"
done
"$throng" check "$dir/a.lcmlog" >/dev/null || fail "the log is not sound"

# No controller: no file is touched.
code=0
"$throng" run "$scene" --lockstep --lockstep-timeout 0.5 --log "$dir/none.lcmlog" >"$dir/table" 2>"$dir/err" || code=$?
[ $code -eq 3 ] && [ ! -e "$dir/none.lcmlog" ] || fail "exit code $code without a controller"
grep -q "no reply to the request before the first frame within 0.5 s for avatar 0 of group 'picker' (PICKER_REPLY)" \
  "$dir/err" || fail "no error that names the missing avatar"

# Dead controller: the log ends properly.
drive c++ 0
"$throng" run "$scene" --seconds 600 --lockstep --lockstep-timeout 2 --log "$dir/b.lcmlog" \
  >"$dir/table" 2>"$dir/err" &
run=$!
tries=0
until [ "$(stat -c %s "$dir/b.lcmlog" 2>/dev/null || echo 0)" -gt 1000000 ]; do
  tries=$((tries + 1))
  [ $tries -lt 600 ] || fail "the run does not begin"
  sleep 0.1
done
kill -9 $pids
pids=
code=0
wait $run || code=$?
[ $code -eq 3 ] || fail "exit code $code after the controller died"
grep "no reply to frame [0-9]* within 2 s for avatar 0 of group 'picker' (PICKER_REPLY); check the controller" \
  "$dir/err" || fail "no error that names the late avatar"
[ "$(grep -c 'no reply' "$dir/err")" -eq 1 ] || fail "several errors"
"$throng" check "$dir/b.lcmlog" >/dev/null || fail "the log did not end properly"

# Invalid input.
for wrong in "$scene --lcm off" plaza; do
  code=0
  # shellcheck disable=SC2086
  "$throng" run $wrong --lockstep --log off >"$dir/table" 2>"$dir/err" || code=$?
  [ $code -eq 2 ] && grep '^throng: --lockstep: expected \|--lockstep: expected ' "$dir/err" || fail "$wrong: exit code $code"
done
"$throng" run "$scene" --seconds 0.1 --log off >"$dir/table" 2>"$dir/err"
[ "$(grep -c '^warning: .*--lockstep' "$dir/err")" -eq 1 ] ||
  fail "no warning for a run that does not wait"
