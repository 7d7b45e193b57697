#!/usr/bin/env bash
# Installs a build, uses it from outside, moves it and uses it again:
# tests/install/install_test.sh SOURCE BUILD FOLDER [short], where FOLDER is to try it in. short: the
# libraries alone, and one program of another project on culling, with every change.
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
quietly() { # COMMAND...: what it prints is shown where it fails
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
# Nothing that is installed tells where it was made or first put.
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

# Programs of others: by CMake with all libraries; on a machine that has what culling needs and no more.
try_project all "$prefix"
said=$("$build/hello")
expect_same "the program of the README" "$said" "$("$folder/all/readme")"
skeleton=$("$build/custom_bodies")
expect_same "custom_bodies" "$skeleton" "$("$folder/all/custom_bodies")"
# A volume of one's own, with the workbench: it keeps the law; too thin a one is caught, with the pair.
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
  try_project culling "$prefix" # nothing can be hidden here
elif [ "$status" -ne 0 ]; then
  fail "culling alone could not be used"
fi
expect_same "custom_bodies on culling alone" "$skeleton" "$("$folder/culling/custom_bodies")"
linked=$(ldd "$folder/culling/custom_bodies")
for library in liblcm liborocos-kdl liburdf libassimp libyaml-cpp libsqlite3 libhdf5; do
  ! grep -q "$library" <<<"$linked" || fail "custom_bodies: expected no $library"
done

# By pkg-config, after the package has moved; the command and CMake go along.
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
# A program that was told no place finds the data by the list of the base directories.
expect_same "the program of the README by pkg-config" "$said" "$(XDG_DATA_DIRS=$moved/share "$folder/second/readme")"
quietly cmake -S "$here/project" -B "$folder/all" -Dthrong_DIR="$(dirname "$(find "$moved" -name throng-config.cmake)")"
quietly cmake --build "$folder/all" --target readme
expect_same "the program of the README, moved" "$said" "$("$folder/all/readme")"
# For the tests of the command and of the examples, which take the programs that $THRONG_TESTED names.
mkdir "$folder/programs"
ln -s "$moved/bin/throng" "$folder/programs/throng"
ln -s "$folder/all/readme" "$folder/programs/hello"
ln -s "$folder/all/custom_bodies" "$folder/programs/custom_bodies"
# And for those of the Python module, which take it from $PYTHONPATH.
ln -s "$moved/lib/python3/dist-packages" "$folder/python"
echo "installed, used from outside, moved and used again"
