#!/usr/bin/env bash
# Throng from nothing: installs what is missing, builds, and sends 500 people across a plaza. Further
# arguments go to `throng run plaza`, for example: scripts/demo.sh --seconds 3
set -euo pipefail
cd "$(dirname "$0")/.."

bash scripts/setup.sh
bash scripts/build.sh release throng

log=out/plaza.lcmlog
mkdir -p out
build/release/throng run plaza --log "$log" "$@"

cat <<TEXT

The contacts of that run are in $log. What to try next:
  build/release/throng info $log
  build/release/throng view $log              # the 3-D page: http://127.0.0.1:7684/
  build/release/throng render $log --frame 300 --out out/plaza.png
  build/release/throng run corridor --exact
  build/release/throng scenes
  lcm-logplayer $log                            # replays it to any LCM listener
TEXT
