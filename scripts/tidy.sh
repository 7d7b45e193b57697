#!/usr/bin/env bash
# clang-tidy over all sources, or `scripts/tidy.sh --changed [COMMIT]` over those that differ from COMMIT
# (default: where this branch left main, and on main the commit before); a changed header stands for the
# .cpp beside it. What is not committed counts, too. Exit code 1 if it finds something.
set -euo pipefail
cd "$(dirname "$0")/.."

case "${1:-}" in
  "" | --changed) ;;
  *) echo "scripts/tidy.sh: expected no argument or --changed, found '$1'" >&2; exit 2 ;;
esac
if ! command -v run-clang-tidy >/dev/null; then
  echo "scripts/tidy.sh: expected run-clang-tidy; apt-get install clang-tidy" >&2
  exit 3
fi

folders='(analysis|apps|avatars|base|bench|crowd|culling|examples|kinematics|lcm_io|python|recordings|scenes|tests|viewer)'
files=("^$PWD/$folders/")
if [ "${1:-}" = --changed ]; then
  since=${2:-}
  head=$(git rev-parse HEAD)
  for main in origin/main main; do
    [ -n "$since" ] || since=$(git merge-base "$main" HEAD 2>/dev/null) || true
    [ "$since" != "$head" ] || since=
  done
  [ -n "$since" ] || since=$(git rev-parse -q --verify HEAD~1) || true
  if [ -z "$since" ]; then
    echo "scripts/tidy.sh: no commit to compare with; scripts/tidy.sh looks at everything" >&2
    exit 0
  fi
  files=()
  while IFS= read -r file; do
    [ "${file##*.}" != h ] || file=${file%.h}.cpp
    [ ! -f "$file" ] || files+=("^$PWD/${file//+/\\+}\$")
  done < <({ git diff --name-only --diff-filter=d "$since"; git ls-files -o --exclude-standard; } |
    grep -E "^$folders/.*\.(cpp|h)$" | sort -u)
  if [ ${#files[@]} -eq 0 ]; then
    echo "scripts/tidy.sh: no source differs from ${since:0:12}"
    exit 0
  fi
  # Half a minute each: a move of everything would hold up every change behind it.
  if [ ${#files[@]} -gt 40 ]; then
    echo "scripts/tidy.sh: ${#files[@]} sources differ from ${since:0:12}: left to scripts/nightly.sh tidy"
    exit 0
  fi
  echo "scripts/tidy.sh: at most ${#files[@]} sources that differ from ${since:0:12}"
fi

# A build folder of its own: clang takes no header that g++ has precompiled. All it needs are the headers
# that the build makes.
bash scripts/build.sh tidy throng_lcm_headers throng_version
run-clang-tidy -quiet -p build/tidy -j "$(nproc)" "${files[@]}"
