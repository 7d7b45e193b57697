#!/bin/sh
# examples/read_log.py reads a log with generated classes only, and finds every event.
set -eu
write_log=$1 classes=$2 reader=$3
python=/usr/bin/python3
[ -x "$python" ] || { echo "skipped: no python3 here"; exit 77; }
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
expected=$("$write_log" "$dir/run.lcmlog")
PYTHONPATH=$classes PYTHONDONTWRITEBYTECODE=1 "$python" "$reader" "$dir/run.lcmlog" >"$dir/out"
found="begins $(grep -c ' touches ' "$dir/out") ends $(grep -c ' leaves ' "$dir/out")"
echo "in the log: $expected"
echo "read:       $found"
[ "$found" = "$expected" ]
