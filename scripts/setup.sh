#!/usr/bin/env bash
# Installs the Debian 12 packages that Throng builds on, as root or through sudo. Does nothing when
# all are there. `scripts/setup.sh bench` adds the engines that bench/ compares with, `scripts/setup.sh
# test` what only tests need, `scripts/setup.sh page` the browser that tests the page,
# `scripts/setup.sh reliability` what scripts/fuzz.sh and scripts/coverage.sh need.
set -euo pipefail

packages=(
  # tools
  build-essential cmake ninja-build pkg-config git ccache clang-format
  # geometry, kinematics, meshes
  libeigen3-dev liburdfdom-dev liburdfdom-headers-dev liborocos-kdl-dev libassimp-dev libfcl-dev
  # scenes, speed, command line, pictures
  libyaml-cpp-dev libtbb-dev libhwy-dev libcli11-dev libfmt-dev nlohmann-json3-dev libpng-dev zlib1g-dev
  libwebp-dev
  # trajectories: the file format, and polygons of the walkable area
  libsqlite3-dev libboost-dev
  # navigation meshes
  librecast-dev
  # figures of `throng paper --out`
  gnuplot-nox
  # messages; iproute2 tells whether multicast has a route
  liblcm-dev liblcm-bin libglib2.0-dev iproute2
  # tests
  libgtest-dev libgmock-dev
)
# The page of `throng view` is built with node 18 or newer and npm, from whichever source they come.
if ! command -v node >/dev/null || ! command -v npm >/dev/null; then packages+=(nodejs npm); fi
# The message types for Python and Java, and lcm-spy.
test_packages=(python3-minimal openjdk-17-jdk-headless liblcm-java libjchart2d-java)
# The page in a real browser.
page_packages=(chromium)
# clang with libFuzzer, the reader of coverage counts
reliability_packages=(clang libclang-rt-14-dev llvm gcovr)
bench_packages=(libembree-dev libbullet-dev libcgal-dev libode-dev libbenchmark-dev)

case "${1:-}" in
  "") ;;
  bench) packages+=("${bench_packages[@]}") ;;
  test) packages+=("${test_packages[@]}") ;;
  page) packages+=("${page_packages[@]}") ;;
  reliability) packages+=("${reliability_packages[@]}") ;;
  *)
    echo "scripts/setup.sh: expected no argument, bench, test, page or reliability, found '$1'" >&2
    exit 2
    ;;
esac

if ! command -v dpkg-query >/dev/null; then
  echo "scripts/setup.sh: expected Debian 12 or a system with its packages; install what the list in this file names" >&2
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

echo "Installing ${#missing[@]} packages: ${missing[*]}" >&2
apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -o Acquire::Retries=3
  -o Dpkg::Use-Pty=0)
if ! { "${apt[@]}" update && "${apt[@]}" install -y --no-install-recommends "${missing[@]}"; } \
    </dev/null >&2; then
  echo "scripts/setup.sh: apt-get could not install: ${missing[*]}" >&2
  exit 3
fi
