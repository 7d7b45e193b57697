#!/usr/bin/env bash
# Measures this machine: bench/run.sh [SIZE...] (default 500 5000 20000 100000) at 1 and 4 people
# per m2, on one thread and on all, and the steering crowd of `plaza` on one thread.
# Writes results.csv, plaza.csv, comparison.svg, ageing and micro-benchmarks into
# bench/results/<cpu>/. Takes an hour; on a busy machine the times are noise.
# FRAMES (default 20) frames are measured per size. Engines that take many seconds per frame for
# 100 000 people (bullet, ode) are omitted there; SLOW=1 includes them.
set -euo pipefail
cd "$(dirname "$0")/.."

sizes=("$@")
[ ${#sizes[@]} -gt 0 ] || sizes=(500 5000 20000 100000)
scripts/build.sh bench throng throng_micro
throng=build/bench/throng

model=$(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1)
cpu=$(tr -cs 'A-Za-z0-9' '_' <<<"${model:-unknown}" | sed 's/_*$//')
out=bench/results/$cpu
mkdir -p "$out"
{
  echo "cpu: ${model:-unknown}"
  echo "cores: $(nproc)"
  echo "flags: $(grep -m 1 -owE 'avx2|avx512f|sse4_2' /proc/cpuinfo | sort -u | tr '\n' ' ')"
  echo "compiler: $(c++ --version | head -n 1)"
  echo "load before: $(cut -d ' ' -f 1-3 /proc/loadavg)"
  echo "commit: $(git rev-parse --short HEAD 2>/dev/null || echo unknown)"
} >"$out/machine.txt"

rm -f "$out/results.csv"
threads=(1)
[ "$(nproc)" -eq 1 ] || threads+=("$(nproc)")
for n in "${sizes[@]}"; do
  all=fcl,embree,cgal,bullet,ode
  if [ "$n" -gt 20000 ] && [ -z "${SLOW:-}" ]; then all=fcl,embree,cgal; fi
  for density in 1 4; do
    for t in "${threads[@]}"; do
      engines=$all
      [ "$t" -eq 1 ] || engines=embree  # the only one with threads
      "$throng" bench --avatars "$n" --density "$density" --threads "$t" \
        --frames "${FRAMES:-20}" --engines "$engines" --csv "$out/results.csv"
    done
  done
done
rm -f "$out/plaza.csv"
for n in "${sizes[@]}"; do
  if [ "$n" -gt 20000 ] && [ -z "${SLOW:-}" ]; then continue; fi
  "$throng" bench --avatars "$n" --crowd plaza --frames "${FRAMES:-20}" \
    --engines fcl,embree,cgal --csv "$out/plaza.csv"
done
echo "load after: $(cut -d ' ' -f 1-3 /proc/loadavg)" >>"$out/machine.txt"

if [ -z "${NO_AGEING:-}" ]; then
  for density in 1 4; do
    "$throng" bench --avatars 5000 --density "$density" --frames 5 --age 300 \
      --engines fcl,embree | tee "$out/ageing_$density.txt"
  done
fi
if [ -x build/bench/throng_micro ]; then
  build/bench/throng_micro --benchmark_format=json >"$out/micro.json"
fi
if command -v gnuplot >/dev/null; then
  gnuplot -e "results='$out/results.csv'; figure='$out/comparison.svg'; cpu='${model:-unknown}'" \
    bench/comparison.gp
fi
echo "$out written" >&2
