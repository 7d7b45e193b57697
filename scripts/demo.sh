#!/usr/bin/env bash
# Demonstrates Throng: installs missing packages, builds `throng` and `hello`, simulates 500 people on a plaza and
# draws them. Arguments go to `throng run plaza`, for example: scripts/demo.sh --seconds 3
set -euo pipefail
cd "$(dirname "$0")/.."

bash scripts/setup.sh
if [ ! -x build/release/throng ]; then
  echo "Building throng and hello once: nine minutes of processor time on $(nproc) cores" >&2
fi
bash scripts/build.sh release throng hello

log=out/plaza.lcmlog picture=out/plaza.png
mkdir -p out
build/release/throng run plaza --exact --log "$log" "$@"
frames=$(build/release/throng info "$log" | awk '$1 == "THRONG_FRAME_STATS" {print $2}')
build/release/throng render "$log" --frame "$((frames - 1))" --eye 7,-14,5.5 --target 0.5,-2,0.6 \
  --out "$picture"

cat <<TEXT

The last frame is drawn in $picture; parts with touching triangles are red. $log contains all contacts.
What to try next:
  build/release/throng view $log        # the run in 3-D, in the browser: http://127.0.0.1:7684/
  build/release/throng info $log        # the contents of the log
  build/release/throng monitor $log     # the contacts
  build/release/hello                             # the smallest program on the library
  build/release/throng scenes                     # the other scenes
  lcm-logplayer --lcm-url='udpm://239.255.76.67:7684?ttl=0&recv_buf_size=2097152' $log
                                                  # replays it; build/release/throng monitor listens
TEXT
