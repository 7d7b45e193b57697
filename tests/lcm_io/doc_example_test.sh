#!/bin/sh
# A block ```LANGUAGE NAME of the documentation equals the program that is built and tested.
set -eu
doc=$1 block=$2 program=$3
awk -v fence='```'"$block" '$0 == fence { inside = 1; next } /^```$/ { inside = 0 } inside' "$doc" |
  diff - "$program" || {
  echo "$doc: the block '$block' and $program differ"
  exit 1
}
