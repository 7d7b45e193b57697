#!/usr/bin/env bash
# Hours in small: scripts/soak.sh [MINUTES] (default 5; by hand 60). A crowd runs with LCM and a log
# in real work, is killed by nobody, and is watched: memory must not grow after warm-up, and no
# event may be lost between the simulation and the log.
set -euo pipefail
cd "$(dirname "$0")/.."

minutes=${1:-5}
throng=$PWD/build/release/throng
[ -x "$throng" ] || bash scripts/build.sh release throng
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

"$throng" run plaza --avatars 300 --seconds 1000000 --lcm memq:// --log soak.lcmlog \
  --json soak.json >table 2>notes &
run=$!
# Resident kilobytes, once a second; the first fifth is warm-up.
seconds=$((minutes * 60))
: >memory
for _ in $(seq "$seconds"); do
  sleep 1
  awk '/^VmRSS/ {print $2}' "/proc/$run/status" >>memory
done
kill -TERM "$run"
wait "$run"
"$throng" check soak.lcmlog >check || { cat check >&2; exit 1; }

# Numbers of the summary, of the judge, and of the memory's first and last third after warm-up.
number() { sed -n "s/.*\"$1\": *\([0-9]*\).*/\1/p" soak.json | head -n 1; }
said=$(($(number begin) + $(number end)))
found=$(awk '$1 == "events" {print $2 + $4}' check)
dropped=$(number dropped) frames=$(number frames)
read -r early late < <(awk '{kb[NR] = $1} END {
  warm = int(NR / 5); third = int((NR - warm) / 3); if (third < 1) third = 1
  for (i = warm + 1; i <= warm + third; ++i) if (kb[i] > early) early = kb[i]
  for (i = NR - third + 1; i <= NR; ++i) if (kb[i] > late) late = kb[i]
  print early, late }' memory)
echo "[ soak ] $seconds s, $frames frames; resident $early kB early, $late kB late;" \
  "$said events said, $found in the log, $((said - found)) lost; LCM dropped $dropped messages"
# A page or two may still be touched for the first time; a leak of a kilobyte a frame may not pass.
if [ $((late - early)) -gt 1024 ] || [ "$said" -ne "$found" ] || [ "$dropped" -ne 0 ]; then
  echo "scripts/soak.sh: memory grew or events were lost" >&2
  exit 1
fi
