#!/usr/bin/env bash
# Runs the checks that take too long for every change: scripts/nightly.sh [STEP...], all steps by default, for
# example `scripts/nightly.sh docs soak`. The output of a step is stored in build/nightly/STEP.txt. Ends with a
# table of steps, times and last lines; exit code 1 if a step failed or could not run.
set -uo pipefail
cd "$(dirname "$0")/.."

declare -A what=(
  [docs]="every figure in the documents whose command takes up to a minute, and the shown commands"
  [long]="every seed and setting of tests that run a part of them at every change"
  [no_miss]="no misses among ten million close pairs of parts, with the date as the seed"
  [determinism]="one hash for all compilers, optimisation levels, threads and SIMD targets"
  [meshes]="5000 mutated mesh files"
  [scenes]="10000 scenes with a changed field"
  [urdfs]="3000 mutated URDFs"
  [fuzz]="ten minutes of libFuzzer for each reader"
  [tidy]="clang-tidy on all sources"
  [lto]="one definition of every name: each program read as a whole, inline functions compared"
  [outside]="culling alone and the README's program in another project"
  [packages]="packages built and tried in a bare Debian 12, and the tests of the command and of Python with them"
  [extend]="a volume, a scene field, a steering model, a sink, a message and a run option added by patches"
  [soak]="an hour of people who walk and touch all the time"
  [asan]="the test suite under the address and undefined behaviour sanitizers"
  [tsan]="the test suite under the thread sanitizer"
)
order=(docs long no_miss determinism meshes scenes urdfs fuzz tidy lto outside packages extend soak asan tsan)

steps=("$@")
[ ${#steps[@]} -gt 0 ] || steps=("${order[@]}")
for step in "${steps[@]}"; do
  if [ -z "${what[$step]:-}" ]; then
    echo "scripts/nightly.sh: expected ${order[*]}, found '$step'" >&2
    exit 2
  fi
done

generator() { # PROGRAM COUNT: a test program that generates its inputs
  bash scripts/build.sh release throng "$1" && "build/release/$1" "$2"
}

no_miss() { # SEED: for parts, for walking, standing and avoiding people, for pairs within a margin, for hulls
  bash scripts/build.sh release no_miss no_miss_people no_miss_proximity degenerate_hulls_sweep && echo "seed $1" &&
    build/release/no_miss 10000000 "$1" && build/release/no_miss_people 10000000 "$1" touching &&
    build/release/no_miss_people 100000 "$1" &&
    build/release/no_miss_proximity 2000000 "$1" && build/release/degenerate_hulls_sweep 100000 "$1"
}

long() ( # tests that use tests/nightly.h
  bash scripts/build.sh release culling_tests crowd_tests scenes_tests apps_tests || exit
  export THRONG_NIGHTLY=1
  build/release/culling_tests \
    --gtest_filter='AgainstFcl.*:*ProximityBounds.*:ProximityRows.ChangeNoEvents*' &&
    build/release/crowd_tests \
      --gtest_filter='Crowd.KeepsAPlazaMovingForEverySeed:NavMesh.OpensGaps*' &&
    build/release/scenes_tests \
      --gtest_filter='ProximityRun.RowsDependOnTheirOwnMarginOnly:*ResumeScenes*' &&
    build/release/apps_tests --gtest_filter='OutputPlan.RejectsTwoOutputsInOneFile'
)

outside() {
  local what
  for what in culling scenes; do
    bash tests/outside/outside_test.sh "$what" "$PWD" "$PWD/build/outside/$what" || return
  done
}

packages() {
  local status=0
  bash scripts/package.sh || return
  bash tests/install/bare_debian_test.sh "$PWD" "$PWD/build/release/packages" "$PWD/build/bare" || status=$?
  [ "$status" -eq 0 ] || [ "$status" -eq 77 ] || return "$status"
  # The command, examples built by another project, and the Python module.
  local tried=$PWD/build/release/tests/install/tried
  bash tests/install/install_test.sh "$PWD" "$PWD/build/release" "$tried" || return
  THRONG_TESTED=$tried/programs build/release/apps_tests --gtest_brief=1 || return
  THRONG_NIGHTLY=1 THRONG_TESTED=$tried/programs build/release/docs_tests --gtest_brief=1 \
    --gtest_filter='Documents.*' || return
  THRONG_TESTED=$tried/programs build/release/culling_tests --gtest_brief=1 --gtest_filter='CustomBodies.*' || return
  python_tests "$tried"
}

python_tests() { # INSTALLED: the folder of tests/install/install_test.sh
  local test
  [ -d "$1/python" ] || { echo "no Python module is installed"; return; }
  for test in tests/python/*_test.py; do
    PYTHONPATH=$1/python PYTHONDONTWRITEBYTECODE=1 MPLBACKEND=Agg THRONG_COMMAND=$1/programs/throng \
      THRONG_SOURCE_DIR=$PWD /usr/bin/python3 "$test" || return
  done
}

run_step() {
  local seed
  seed=$(date +%Y%m%d)
  case $1 in
    docs) bash scripts/docs.sh --nightly ;;
    long) long ;;
    no_miss) no_miss "$seed" ;;
    determinism) bash scripts/determinism.sh release clang checked debug ;;
    meshes) generator mutated_meshes 5000 ;;
    scenes) generator mutated_scenes 10000 ;;
    urdfs) generator mutated_urdfs 3000 ;;
    fuzz) bash scripts/fuzz.sh 600 ;;
    tidy) bash scripts/tidy.sh ;;
    lto) python3 scripts/one_definition.py ;;
    outside) outside ;;
    packages) packages ;;
    extend) bash tests/extend/extend_test.sh build "$PWD" "$PWD/build/extend" ;;
    soak) bash scripts/soak.sh 60 ;;
    asan | tsan) bash scripts/sanitize.sh "$1" ;;
  esac
}

out=build/nightly
mkdir -p "$out"
status=0 table=
for step in "${steps[@]}"; do
  echo "== $step: ${what[$step]}"
  begun=$SECONDS
  if run_step "$step" >"$out/$step.txt" 2>&1; then
    verdict=fine
  else
    verdict=BROKEN status=1
    tail -n 20 "$out/$step.txt" >&2
  fi
  last=$(tail -n 1 "$out/$step.txt" | cut -c1-90)
  echo "   $verdict after $((SECONDS - begun)) s: $last"
  table+=$(printf '%-12s %-7s %6d s  %s' "$step" "$verdict" $((SECONDS - begun)) "$last")$'\n'
done
printf '\n%s' "$table"
[ "$status" -eq 0 ] || echo "failed; the output is in $out/STEP.txt" >&2
exit "$status"
