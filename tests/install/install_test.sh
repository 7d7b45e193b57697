#!/usr/bin/env bash
# Installs a build, uses it from another project, moves it and uses it again:
# tests/install/install_test.sh SOURCE BUILD FOLDER [short], in FOLDER. short, for every change: only the libraries,
# and one program of another project on culling.
set -euo pipefail

source=$1 build=$2 folder=$3
here=$(cd "$(dirname "$0")" && pwd)
unset THRONG_DATA XDG_DATA_DIRS PKG_CONFIG_PATH

fail() {
  echo "$*" >&2
  exit 1
}
expect_same() { # WHAT EXPECTED FOUND
  [ "$2" = "$3" ] || fail "$1: expected '$2', found '$3'"
}
quietly() { # COMMAND...: shows its output only if it fails
  "$@" >"$folder/log" 2>&1 || {
    cat "$folder/log" >&2
    fail "failed: $*"
  }
}
hash_of() { # THRONG
  (cd "$folder" && "$1" run plaza --seconds 1 --lcm off --log off | awk '$1 == "hash" {print $2}')
}
try_project() { # WHAT PREFIX [BUILD_TYPE TARGET]
  rm -rf "$folder/$1"
  quietly cmake -S "$here/project" -B "$folder/$1" -G Ninja -DCMAKE_PREFIX_PATH="$2" \
    -DTHRONG_SOURCE="$source" -DWHAT="$1" -DCMAKE_BUILD_TYPE="${3:-Release}"
  quietly cmake --build "$folder/$1" -j "$(nproc)" --target "${4:-all}"
}
# Installed files must not name the source, build or install folder.
expect_no_names() {
  local place named
  for place in "$source" "$build" "$prefix"; do
    named=$(grep -rlF -e "$place/" "$prefix" || true)
    expect_same "files that name $place" "" "$named"
  done
}

rm -rf "$folder"
mkdir -p "$folder"
prefix=$folder/first
if [ "${4:-}" = short ]; then
  quietly cmake --install "$build" --prefix "$prefix" --component dev
  expect_no_names
  try_project culling "$prefix" Debug custom_bodies
  expect_same "custom_bodies on culling alone" "$("$build/custom_bodies")" "$("$folder/culling/custom_bodies")"
  rm -rf "$folder"
  echo "the libraries are installed and used from outside"
  exit
fi
quietly cmake --install "$build" --prefix "$prefix"
expect_no_names

expected=$(hash_of "$build/throng")
[ -n "$expected" ] || fail "expected throng of the build to print a hash"
expect_same "hash by the installed command" "$expected" "$(hash_of "$prefix/bin/throng")"

# Programs of other projects: with CMake and all libraries; and with the packages of culling only.
try_project all "$prefix"
printed=$("$build/hello")
expect_same "the program of the README" "$printed" "$("$folder/all/readme")"
skeleton=$("$build/custom_bodies")
expect_same "custom_bodies" "$skeleton" "$("$folder/all/custom_bodies")"
# A custom volume on the workbench misses nothing; one that is too thin is detected, with the pair.
"$folder/all/custom_volume" 20000 1 "$folder/volume" >"$folder/log" || fail "custom_volume: $(cat "$folder/log")"
grep -q '^capsule: 0 of [0-9]* touching pairs missed' "$folder/log" || fail "custom_volume: $(head -n 1 "$folder/log")"
status=0
THICKNESS=0.95 "$folder/all/custom_volume" 20000 1 "$folder/volume" >"$folder/log" || status=$?
expect_same "exit code of a capsule too thin" 1 "$status"
grep -q 'first miss: [a-z]*, seed 1, frame' "$folder/log" || fail "custom_volume: expected the first miss"
grep -q 'a_to_b_m' "$folder/volume/miss.txt" || fail "custom_volume: expected the pair in miss.txt"

hidden="liblcm-dev liblcm-bin nodejs npm libgtest-dev libgmock-dev libfcl-dev libcli11-dev nlohmann-json3-dev
  libpng-dev libwebp-dev libglib2.0-dev liborocos-kdl-dev liburdfdom-dev liburdfdom-headers-dev libassimp-dev
  libyaml-cpp-dev libsqlite3-dev libhdf5-dev librecast-dev libboost-dev libboost1.74-dev"
export -f try_project quietly fail
export folder here source
status=0
bash "$source/tests/outside/without.sh" "$hidden" bash -c 'try_project culling "$1"' sh "$prefix" || status=$?
if [ "$status" -eq 77 ]; then
  try_project culling "$prefix" # packages cannot be hidden here
elif [ "$status" -ne 0 ]; then
  fail "culling alone could not be used"
fi
expect_same "custom_bodies on culling alone" "$skeleton" "$("$folder/culling/custom_bodies")"
linked=$(ldd "$folder/culling/custom_bodies")
for library in liblcm liborocos-kdl liburdf libassimp libyaml-cpp libpng libsqlite3 libhdf5; do
  ! grep -q "$library" <<<"$linked" || fail "custom_bodies: expected no $library"
done

# With pkg-config after the package was moved; the command and CMake work as well.
moved=$folder/second/place
mkdir -p "$folder/second"
mv "$prefix" "$moved"
expect_same "hash by the moved command" "$expected" "$(hash_of "$moved/bin/throng")"
pc() { PKG_CONFIG_PATH=$(dirname "$(find "$moved" -name throng-base.pc)") pkg-config "$@"; }
expect_same "version by pkg-config" "$("$moved/bin/throng" --version | awk '{print $2}')" "$(pc --modversion throng-scenes)"
read -ra flags <<<"$(pc --cflags --libs throng-culling)"
quietly g++ -std=c++20 -O1 "$source/examples/custom_bodies.cpp" "${flags[@]}" -o "$folder/by_pkg_config"
expect_same "custom_bodies by pkg-config" "$skeleton" "$("$folder/by_pkg_config")"
read -ra flags <<<"$(pc --cflags --libs throng-scenes)"
quietly g++ -std=c++20 -O1 "$folder/all/readme.cpp" "${flags[@]}" -o "$folder/second/readme"
# A program without a data folder finds the data through the base directories.
expect_same "the program of the README by pkg-config" "$printed" "$(XDG_DATA_DIRS=$moved/share "$folder/second/readme")"
quietly cmake -S "$here/project" -B "$folder/all" -Dthrong_DIR="$(dirname "$(find "$moved" -name throng-config.cmake)")"
quietly cmake --build "$folder/all" --target readme
expect_same "the program of the README, moved" "$printed" "$("$folder/all/readme")"
# For the tests of the command and of the examples, which use the programs in $THRONG_TESTED.
mkdir "$folder/programs"
ln -s "$moved/bin/throng" "$folder/programs/throng"
ln -s "$folder/all/readme" "$folder/programs/hello"
ln -s "$folder/all/custom_bodies" "$folder/programs/custom_bodies"
# For the tests of the Python module, which use the one in $PYTHONPATH.
ln -s "$moved/lib/python3/dist-packages" "$folder/python"
echo "installed, used from outside, moved and used again"
