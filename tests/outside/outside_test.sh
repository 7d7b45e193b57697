#!/usr/bin/env bash
# Another project includes Throng by add_subdirectory, on a machine without unused packages:
# tests/outside/outside_test.sh culling|scenes SOURCE FOLDER, which builds in FOLDER.
set -euo pipefail

what=$1 source=$2 folder=$3
here=$(cd "$(dirname "$0")" && pwd)
messages="liblcm-dev liblcm-bin liblcm-java"
page="nodejs npm"
tests="libgtest-dev libgmock-dev googletest libfcl-dev libbenchmark-dev"
apps="libcli11-dev libwebp-dev libglib2.0-dev"
crowds="liborocos-kdl-dev liburdfdom-dev liburdfdom-headers-dev libassimp-dev libyaml-cpp-dev
  nlohmann-json3-dev libpng-dev libsqlite3-dev libhdf5-dev librecast-dev libboost-dev libboost1.74-dev"
case $what in
  culling) missing="$messages $page $tests $apps $crowds" ;;
  scenes) missing="$messages $page $tests $apps" ;;
  *)
    echo "outside_test.sh: expected culling or scenes, found '$what'" >&2
    exit 2
    ;;
esac

if [ "${4:-}" != hidden ]; then
  exec bash "$here/without.sh" "$missing" bash "$0" "$what" "$source" "$folder" hidden
fi

fail() {
  echo "$*" >&2
  exit 1
}

for tool in lcm-gen npm; do
  ! command -v "$tool" >/dev/null || fail "expected no $tool, found $(command -v "$tool"): it is not hidden"
done
[ ! -e /usr/include/lcm/lcm.h ] || fail "expected no header of LCM"

rm -rf "$folder"
cmake -S "$here/project" -B "$folder" -G Ninja -DTHRONG_SOURCE="$source" -DWHAT="$what" \
  -DCMAKE_CXX_STANDARD=23 -DCMAKE_BUILD_TYPE=MinSizeRel
cmake --build "$folder" -j "$(nproc)"

# Shared libraries of the program, whether or not they were hidden.
linked=$(ldd "$folder/bin/program" | awk '{print $1}')
for library in liblcm libgtest libwebp; do
  ! grep -q "^$library" <<<"$linked" || fail "expected a program without $library"
done
if [ "$what" = culling ]; then
  for library in liborocos-kdl liburdf libassimp libyaml-cpp libpng libsqlite3 libhdf5; do
    ! grep -q "^$library" <<<"$linked" || fail "expected a program without $library"
  done
fi
found=$(cd "$folder" && ctest 2>&1)
grep -q "100% tests passed, 0 tests failed out of 1" <<<"$found" ||
  fail "expected the one test of the project to pass, found: $found"
echo "$what: built from outside, and runs"
