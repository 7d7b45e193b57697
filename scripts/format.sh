#!/usr/bin/env bash
# Formats all C++ sources with clang-format 14; `scripts/format.sh --check` only lists files that differ.
set -euo pipefail
cd "$(dirname "$0")/.."

case "${1:-}" in
  "") action=(-i) ;;
  --check) action=(--dry-run --Werror) ;;
  *) echo "scripts/format.sh: expected no argument or --check, found '$1'" >&2; exit 2 ;;
esac

# The result depends on the version: Debian 12's is decisive.
clang_format=$(command -v clang-format-14 || command -v clang-format)
find . \( -path ./build -o -path ./out -o -name node_modules -o -name .git \) -prune -o \
  \( -name '*.cpp' -o -name '*.h' \) -print0 |
  xargs -0 -P "$(nproc)" -n 20 "$clang_format" "${action[@]}"
