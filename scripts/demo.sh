#!/usr/bin/env bash
# Throng from nothing: installs what is missing, builds `throng` and `hello`, sends 500 people across a
# plaza and draws a picture of them. Further arguments go to `throng run plaza`, for example:
# scripts/demo.sh --seconds 3
set -euo pipefail
cd "$(dirname "$0")/.."

bash scripts/setup.sh
if [ ! -x build/release/throng ]; then
  echo "Building throng and hello: nine minutes of processor time, shared by $(nproc) cores; once" >&2
fi
bash scripts/build.sh release throng hello

log=out/plaza.lcmlog picture=out/plaza.png
mkdir -p out
build/release/throng run plaza --exact --log "$log" "$@"
frames=$(build/release/throng info "$log" | awk '$1 == "THRONG_FRAME_STATS" {print $2}')
build/release/throng render "$log" --frame "$((frames - 1))" --eye 7,-14,5.5 --target 0.5,-2,0.6 \
  --out "$picture"

cat <<TEXT

The last frame is drawn in $picture; parts whose triangles touch are red. All contacts are in $log.
What to try next:
  build/release/throng view $log        # the run in 3-D, in the browser: http://127.0.0.1:7684/
  build/release/throng info $log        # what the log holds
  build/release/throng monitor $log     # who touches whom
  build/release/hello                             # the smallest program on the library
  build/release/throng scenes                     # the other scenes
  lcm-logplayer --lcm-url='udpm://239.255.76.67:7684?ttl=0&recv_buf_size=2097152' $log
                                                  # sends it again; build/release/throng monitor listens
TEXT
