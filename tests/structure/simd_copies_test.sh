#!/usr/bin/env bash
# SIMD kernels copy and clear memory with vector instructions only: simd_copies_test.sh OBJECT...
# `rep movs` and `rep stos` take tens of cycles to start, in loops of a few cycles.
set -euo pipefail

kernels=0 found=0
for object in "$@"; do
  listing=$(objdump -dC --no-show-raw-insn "$object")
  kernels=$((kernels + $(grep -cE '^[0-9a-f]+ <.*N_(SSE4|AVX2|AVX3)::.*>:$' <<<"$listing" || true)))
  copies=$(awk '/^[0-9a-f]+ <.*>:$/ { name = $0 }
    /rep (movs|stos)/ && name ~ /N_(SSE4|AVX2|AVX3)::/ { count[name]++ }
    END { for (name in count) print count[name] " times in " substr(name, 19) }' <<<"$listing")
  [ -z "$copies" ] && continue
  found=1
  printf '%s: expected copies by vector instructions, found rep movs or rep stos\n%s\n' "$object" "$copies" >&2
done
if [ "$kernels" -lt 30 ]; then
  echo "expected at least 30 kernels in $# objects, found $kernels" >&2
  exit 1
fi
echo "$kernels kernels in $# objects"
exit "$found"
