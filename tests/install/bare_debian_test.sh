#!/usr/bin/env bash
# Tries the packages in a bare Debian 12:
# tests/install/bare_debian_test.sh SOURCE PACKAGES FOLDER [PART...], where PACKAGES is the output folder of
# scripts/package.sh, FOLDER stores the bare Debian, and PART is archive, debs or culling (default: all). Needs root,
# debootstrap and the network; otherwise exits with 77 and a reason.
set -euo pipefail

if [ "${THRONG_BARE:-}" != yes ]; then
  skip() {
    echo "skipped: $*"
    exit 77
  }
  [ "$(id -u)" -eq 0 ] || skip "a bare Debian needs root"
  command -v debootstrap >/dev/null || skip "no debootstrap (scripts/setup.sh package)"
  compgen -G "$2/throng_*.deb" >/dev/null || skip "no packages in $2 (scripts/package.sh)"
  unshare -m true 2>/dev/null || skip "private mounts are not allowed here"
  if [ ! -f "$3/base/whole" ]; then
    rm -rf "$3/base"
    mkdir -p "$3"
    # From the mirror of this machine.
    mirror=$(apt-get indextargets --format '$(RELEASE) $(SITE)' | sed -n 's/^bookworm //p' | head -n 1)
    debootstrap --variant=minbase bookworm "$3/base" ${mirror:+"$mirror"} >"$3/debootstrap.log" 2>&1 ||
      skip "debootstrap could not fetch a Debian: $(tail -n 1 "$3/debootstrap.log")"
    touch "$3/base/whole"
  fi
  THRONG_BARE=yes exec unshare -mpf --mount-proc --kill-child bash "$0" "$@"
fi

source=$1 packages=$2 folder=$3
parts=("${@:4}")
[ ${#parts[@]} -gt 0 ] || parts=(archive debs culling)
root=$folder/root

fail() {
  echo "$*" >&2
  exit 1
}
# A fresh view of the bare Debian; changes in it disappear with the next one.
fresh() {
  ! mountpoint -q "$root" || umount -R "$root"
  rm -rf "$folder/upper" "$folder/work"
  mkdir -p "$folder/upper" "$folder/work" "$root"
  mount -t overlay bare -o "lowerdir=$folder/base,upperdir=$folder/upper,workdir=$folder/work" "$root"
  mkdir -p "$root/throng/packages" "$root/throng/source"
  mount --bind "$packages" "$root/throng/packages"
  mount --bind "$source" "$root/throng/source"
  mount -t proc proc "$root/proc"
  mount --rbind /dev "$root/dev"
  cp -L /etc/resolv.conf /etc/hosts "$root/etc/"
  apt-config dump Acquire >"$root/etc/apt/apt.conf.d/as-outside"
}
inside() { # COMMAND LINE: runs in the bare Debian, without settings of this machine
  chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 \
    bash -euc "cd /root && $1"
}
quietly() { # COMMAND LINE: shows its output only if it fails
  inside "$1" >"$folder/log" 2>&1 </dev/null || {
    tail -n 40 "$folder/log" >&2
    fail "failed in the bare Debian: $1"
  }
}
hash_by() { # THRONG: hash of a short run
  inside "$1 run plaza --seconds 1 --exact --lcm off --log plaza.lcmlog" | awk '$1 == "hash" {print $2}'
}
expect_same() { # WHAT EXPECTED FOUND
  [ "$2" = "$3" ] || fail "$1: expected '$2', found '$3'"
  echo "  $1: $3"
}
files() { # all files except data of apt and dpkg
  (cd "$root" && find . -xdev \( -path ./proc -o -path ./dev -o -path ./throng -o -path ./root -o -path ./tmp \
    -o -path ./var/cache -o -path ./var/lib/apt -o -path ./var/lib/dpkg -o -path ./var/log \) -prune -o -print) | sort
}

# All packages and the archive must give the hash of the first one.
same_run() { # THRONG
  local found
  found=$(hash_by "$1")
  [ -n "$found" ] || fail "expected $1 run plaza to print a hash"
  expect_same "hash of plaza" "${expected:=$found}" "$found"
  quietly "$1 check plaza.lcmlog"
  quietly "$1 render plaza.lcmlog --frame 30 --out plaza.png && test -s plaza.png"
}

try_archive() {
  fresh
  mkdir -p "$root/opt/first"
  tar -C "$root/opt/first" -xf "$packages"/throng-*-linux-*.tar.xz
  mv "$root"/opt/first/throng-* "$root/opt/throng"
  same_run /opt/throng/bin/throng
  # Moved, and started through a link in PATH.
  mv "$root/opt/throng" "$root/srv/moved"
  ln -s /srv/moved/bin/throng "$root/usr/bin/throng"
  same_run throng
  local missing
  missing=$(inside "find /srv/moved -name '*.so*' -o -name throng -type f | while read -r file; do ldd \$file; done" |
    grep -c "not found" || true)
  expect_same "libraries that are missing" 0 "$missing"
  # Its Python module needs only an interpreter and numpy.
  [ -d "$root/srv/moved/lib/python3/dist-packages" ] || return 0
  quietly "apt-get update && apt-get install -y --no-install-recommends python3-numpy"
  quietly "PYTHONPATH=/srv/moved/lib/python3/dist-packages bash /throng/source/tests/install/python_installed.sh"
  echo "  the Python module: the same hash"
}

try_debs() {
  fresh
  quietly "apt-get update && apt-get install -y --no-install-recommends g++ cmake make"
  files >"$folder/before.txt"
  quietly "apt-get install -y /throng/packages/*throng*.deb"
  same_run throng
  quietly "dpkg -L throng | grep man1/throng-run.1.gz"
  quietly "cmake -S /throng/source/tests/install/project -B all -DTHRONG_SOURCE=/throng/source -DWHAT=all -DCMAKE_BUILD_TYPE=Release"
  quietly "cmake --build all -j $(nproc)"
  expect_same "the program of the README" "contacts last" "$(inside all/readme | tail -n 1 | sed 's/^[0-9]* //')"
  quietly "g++ -std=c++20 -O1 all/readme.cpp \$(pkg-config --cflags --libs throng-scenes) -o by_pkg_config && ./by_pkg_config"
  expect_same "custom_bodies" "$(printf '%s' "$skeleton" | tail -n 1)" "$(inside all/custom_bodies | tail -n 1)"
  for part in "$source"/tests/install/*_installed.sh; do
    [ ! -f "$part" ] || quietly "bash /throng/source/tests/install/$(basename "$part")"
  done
  # Purges recommended packages as well, which came with the same command.
  quietly "apt-get purge -y '.*throng.*' && apt-get autoremove -y --purge -o APT::AutoRemove::RecommendsImportant=false \
    -o APT::AutoRemove::SuggestsImportant=false"
  files >"$folder/after.txt"
  expect_same "files that stay behind" "" "$(comm -13 "$folder/before.txt" "$folder/after.txt" | head -n 20)"
}

try_culling() {
  fresh
  quietly "apt-get update && apt-get install -y --no-install-recommends g++ cmake make pkg-config /throng/packages/libthrong-dev_*.deb"
  quietly "cmake -S /throng/source/tests/install/project -B culling -DTHRONG_SOURCE=/throng/source -DWHAT=culling"
  quietly "cmake --build culling -j $(nproc)"
  expect_same "custom_bodies on culling alone" "$(printf '%s' "$skeleton" | tail -n 1)" "$(inside culling/custom_bodies | tail -n 1)"
  expect_same "libraries of crowds beside it" "" \
    "$(inside "dpkg-query -W -f '\${db:Status-Status} \${Package}\n' 'libassimp*' 'liborocos*' 'libhdf5*' 'liblcm*' throng 2>/dev/null" |
      sed -n 's/^installed //p')"
  # Missing packages are named.
  inside "cmake -S /throng/source/tests/install/project -B all -DTHRONG_SOURCE=/throng/source -DWHAT=all" \
    >"$folder/log" 2>&1 && fail "expected find_package to ask for what scenes need"
  expect_same "what find_package asks for" 1 "$(grep -c "component 'scenes': expected yaml-cpp (Debian: libyaml-cpp-dev)" "$folder/log")"
}

expected=
skeleton="frame 38: part 1 of 0 leaves part 0 of 1"
for part in "${parts[@]}"; do
  echo "$part"
  "try_$part"
done
umount -R "$root"
echo "tried in a bare Debian: ${parts[*]}"
