#!/usr/bin/env bash
# Installs the Debian 12 packages that Throng needs, as root or with sudo; does nothing if all are installed.
# `scripts/setup.sh bench` adds the engines that bench/ compares with, `scripts/setup.sh test` packages of tests only,
# `scripts/setup.sh page` the browser that tests the page, `scripts/setup.sh reliability` packages of scripts/fuzz.sh
# and scripts/coverage.sh, `scripts/setup.sh package` packages of scripts/package.sh. Prints the download size, then
# the progress; output of apt-get and dpkg is shown if they fail.
set -euo pipefail

packages=(
  # tools
  build-essential cmake ninja-build pkg-config python3 git ccache clang-format
  # geometry, kinematics, meshes
  libeigen3-dev liburdfdom-dev liburdfdom-headers-dev liborocos-kdl-dev libassimp-dev libfcl-dev
  # scenes, speed, command line, pictures
  libyaml-cpp-dev libtbb-dev libhwy-dev libcli11-dev libfmt-dev nlohmann-json3-dev libpng-dev zlib1g-dev
  libwebp-dev
  # trajectories: the file format, and polygons of the walkable area
  libsqlite3-dev libboost-dev
  # recordings of the archive of experiments
  libhdf5-dev
  # optional: ranks of studies; GNU parallel for its test
  libopenmpi-dev openmpi-bin parallel
  # navigation meshes
  librecast-dev
  # figures of `throng paper --out`
  gnuplot-nox
  # messages; iproute2 reports whether multicast has a route
  liblcm-dev liblcm-bin libglib2.0-dev iproute2
  # the Python module
  pybind11-dev python3-dev python3-numpy
  # optional: compressed MCAP files
  libzstd-dev
  # tests
  libgtest-dev libgmock-dev
)
# The page of `throng view` needs node 18 or newer and npm, from any source.
if ! command -v node >/dev/null || ! command -v npm >/dev/null; then packages+=(nodejs npm); fi
# Message types for Java, and lcm-spy; data frames and plots of the notebooks; types of the Python module.
test_packages=(openjdk-17-jdk-headless liblcm-java libjchart2d-java python3-pandas python3-matplotlib
  python3-shapely mypy)
# The page in a real browser.
page_packages=(chromium)
# clang with libFuzzer, the coverage reader
reliability_packages=(clang libclang-rt-14-dev llvm gcovr)
# The manual, packages, and a bare Debian for trying them.
package_packages=(help2man patchelf dpkg-dev xz-utils debootstrap)
bench_packages=(libembree-dev libbullet-dev libcgal-dev libode-dev libbenchmark-dev)

case "${1:-}" in
  "") ;;
  bench) packages+=("${bench_packages[@]}") ;;
  test) packages+=("${test_packages[@]}") ;;
  page) packages+=("${page_packages[@]}") ;;
  package) packages+=("${package_packages[@]}") ;;
  reliability) packages+=("${reliability_packages[@]}") ;;
  *)
    echo "scripts/setup.sh: expected no argument, bench, test, page, package or reliability, found '$1'" >&2
    exit 2
    ;;
esac

if ! command -v dpkg-query >/dev/null; then
  echo "scripts/setup.sh: expected Debian 12 or a system with its packages; install the packages listed in this file" >&2
  exit 3
fi

present=$(dpkg-query -W -f '${db:Status-Status} ${Package}\n' "${packages[@]}" 2>/dev/null |
  sed -n 's/^installed //p' || true)
missing=()
for package in "${packages[@]}"; do
  grep -qxF "$package" <<<"$present" || missing+=("$package")
done
[ ${#missing[@]} -eq 0 ] && exit 0

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v sudo >/dev/null; then
    echo "scripts/setup.sh: run as root: apt-get install ${missing[*]}" >&2
    exit 3
  fi
  as_root=(sudo)
fi

log=$(mktemp)
trap 'rm -f "$log"' EXIT
begun=$SECONDS
# Descriptor 3 receives apt-get's status. apt-get closes it for its children, so it cannot be 1, which packages
# print to. It is opened after sudo, which closes it as well.
apt=("${as_root[@]}" sh -c 'exec "$@" 3>&1' sh env DEBIAN_FRONTEND=noninteractive LC_ALL=C apt-get -q -o Acquire::Retries=3
  -o Dpkg::Use-Pty=0)
install=(install -y --no-install-recommends "${missing[@]}")

say() { # TEXT: replaces the last text on a terminal, otherwise prints a line
  if [ -t 2 ]; then printf '\r\033[K%s' "$1" >&2; else printf '%s\n' "$1" >&2; fi
}

# Progress lines in apt-get's output: (dl|pm)status:PACKAGE:PERCENT:TEXT
show_progress() {
  local line phase percent shown=
  while IFS= read -r line; do
    case $line in
      dlstatus:*) phase="downloading" ;;
      pmstatus:*) phase="unpacking and setting up" ;;
      *) printf '%s\n' "$line" >>"$log"; continue ;;
    esac
    percent=$(sed -nE 's/^[a-z]+:[^:]*(:[a-z0-9]+)?:([0-9]+)[.0-9]*:.*/\2/p' <<<"$line")
    # Without a terminal a line per 25 %.
    [ -t 2 ] || percent=$((${percent:-0} / 25 * 25))
    [ "$shown" = "$phase $percent" ] && continue
    shown="$phase $percent"
    say "  $phase: ${percent:-0} %"
  done
}

fail() {
  [ ! -t 2 ] || printf '\n' >&2
  cat "$log" >&2
  echo "scripts/setup.sh: apt-get could not install: ${missing[*]}" >&2
  exit 3
}

"${apt[@]}" update </dev/null >>"$log" 2>&1 || fail
# Cost according to apt-get, which installs nothing yet.
cost=$("${apt[@]}" install --print-uris --no-install-recommends "${missing[@]}" -y </dev/null 2>>"$log" |
  sed -nE 's/^.* ([0-9]+) newly installed.*/\1 packages/p; s/^Need to get (.*) of archives.*/\1 to download/p
    s/^After this operation, (.*) of additional disk space.*/\1 on disk/p' | paste -sd ';' | sed 's/;/, /g') || true
echo "Installing ${#missing[@]} packages and their dependencies${cost:+ ($cost)}: ${missing[*]}" >&2
"${apt[@]}" -o APT::Status-Fd=3 "${install[@]}" </dev/null 2>&1 | show_progress || fail
say "  installed in $((SECONDS - begun)) s"
[ ! -t 2 ] || printf '\n' >&2
