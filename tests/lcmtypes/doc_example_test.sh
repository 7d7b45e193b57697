#!/bin/sh
# The C++ example in the documentation is the program that is built and run here, to the letter.
set -eu
doc=$1 program=$2
awk '/^```cpp$/ { inside = 1; next } /^```$/ { inside = 0 } inside' "$doc" | diff - "$program" || {
  echo "$doc and $program differ"
  exit 1
}
