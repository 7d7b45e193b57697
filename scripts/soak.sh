#!/usr/bin/env bash
# Soak test: scripts/soak.sh [MINUTES [PACE]] (default 5 minutes; by hand 60). 300 people walk up and down the plaza
# with LCM and a log. Memory must not grow after warm-up, no event may be lost between the simulation and the log,
# and in every simulated minute all are present, most walk and contacts begin. PACE is the real-time factor
# (default 4: some five hundredths of a core, and 4 GB of log per hour, deleted afterwards); 0: unlimited, 1 GB per
# minute.
set -euo pipefail
cd "$(dirname "$0")/.."

minutes=${1:-5} pace=${2:-4}
bash scripts/build.sh release throng throng_python
throng=$PWD/build/release/throng
minutes_of=$PWD/scripts/minutes.py
export PYTHONPATH=$PWD/build/release/python
folder=$(mktemp -d)
run=
trap '[ -z "$run" ] || kill "$run" 2>/dev/null || true; rm -rf "$folder"' EXIT
cd "$folder"

fail() { echo "scripts/soak.sh: $1" >&2; exit 1; }

paced=()
[ "$pace" = 0 ] || paced=(--pace "$pace")
people=300
"$throng" run plaza --avatars $people --seconds 1000000 --states-hz 10 "${paced[@]}" --lcm memq:// \
  --log soak.lcmlog --json soak.json >table 2>notes &
run=$!
# Resident kilobytes, once a second; the first fifth is warm-up.
seconds=$((minutes * 60))
: >memory
for _ in $(seq "$seconds"); do
  sleep 1
  awk '/^VmRSS/ {print $2}' "/proc/$run/status" >>memory 2>/dev/null ||
    { cat notes >&2; fail "the run ended by itself"; }
done
kill -TERM "$run"
code=0
wait "$run" || code=$?
run=
# Stopped as requested, with its summary.
[ "$code" -eq 143 ] || { cat notes >&2; fail "expected exit code 143, found $code"; }
"$throng" check soak.lcmlog >check || { cat check >&2; fail "the log is not sound"; }

# Numbers of the summary, of `throng check`, and of memory in the first and last third after warm-up.
number() { sed -n "s/.*\"$1\": *\([0-9]*\).*/\1/p" soak.json | head -n 1; }
reported=$(($(number begin) + $(number end)))
found=$(awk '$1 == "events" {print $2 + $4}' check)
dropped=$(number dropped) frames=$(number frames)
read -r early late < <(awk '{kb[NR] = $1} END {
  warm = int(NR / 5); third = int((NR - warm) / 3); if (third < 1) third = 1
  for (i = warm + 1; i <= warm + third; ++i) if (kb[i] > early) early = kb[i]
  for (i = NR - third + 1; i <= NR; ++i) if (kb[i] > late) late = kb[i]
  print early, late }' memory)
echo "[ soak ] $seconds s, $frames frames; resident $early kB early, $late kB late;" \
  "$reported events written, $found in the log, $((reported - found)) lost; LCM dropped $dropped messages;" \
  "log $(($(stat -c %s soak.lcmlog) / 1000000)) MB"

# The last minute is incomplete.
python3 "$minutes_of" soak.lcmlog | sed '$d' >by_minute
[ -s by_minute ] || fail "less than a simulated minute; increase MINUTES or PACE"
echo "[ soak ] $(wc -l <by_minute) simulated minutes;" "$(awk '
  {if (NR == 1 || $4 < walk) walk = $4; if (NR == 1 || $6 < begin) begin = $6; if (NR == 1 || $2 < there) there = $2}
  END {print "in each at least " there " people there, " walk " walking, " begin " contacts begun"}' by_minute)"

# Some pages may be touched for the first time, and at unlimited pace 16 MB may wait for the disk. A leak of a
# kilobyte per frame must not pass.
growth=1024
[ "$pace" != 0 ] || growth=$((growth + 16 * 1024))
[ $((late - early)) -le "$growth" ] || fail "memory grew by $((late - early)) kB, allowed $growth"
[ "$reported" -eq "$found" ] || fail "events were lost"
[ "$dropped" -eq 0 ] || fail "LCM dropped messages"
awk -v all=$people '$2 < all || $4 < all / 2 || $6 == 0 {print "scripts/soak.sh: " $0; bad = 1} END {exit bad}' \
  by_minute >&2 || fail "people left, stood still or stopped touching"
