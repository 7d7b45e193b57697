#!/usr/bin/env bash
# Runs clang-tidy on all sources, or `scripts/tidy.sh --changed [COMMIT]` on those that differ from COMMIT (default:
# the branch point from main, on main the previous commit), uncommitted changes included. A changed header stands for
# the .cpp next to it. Exit code 1 if it reports a problem.
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

folders='(analysis|apps|avatars|base|bench|crowd|culling|examples|geometry|kinematics|lcm_io|python|recordings|scenes|tests|viewer)'
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
    echo "scripts/tidy.sh: no commit to compare with; run scripts/tidy.sh for all sources" >&2
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
  # Half a minute per source: many of them would delay a change by more than the tests do.
  if [ ${#files[@]} -gt 12 ]; then
    echo "scripts/tidy.sh: ${#files[@]} sources differ from ${since:0:12}; scripts/nightly.sh tidy checks them"
    exit 0
  fi
  echo "scripts/tidy.sh: at most ${#files[@]} sources that differ from ${since:0:12}"
fi

# A separate build folder, because clang cannot read g++'s precompiled headers. It needs only generated headers.
bash scripts/build.sh tidy throng_lcm_headers throng_version
run-clang-tidy -quiet -p build/tidy -j "$(nproc)" "${files[@]}"
