#!/usr/bin/env bash
# Builds packages in build/release/packages: scripts/package.sh [deb|archive], both by default. deb: packages for
# Debian 12. archive: throng-VERSION-linux-ARCHITECTURE.tar.xz with its libraries, which runs wherever it is
# unpacked, on any Linux with glibc 2.36 or newer.
set -euo pipefail
cd "$(dirname "$0")/.."

what=${1:-both}
case $what in
  both | deb | archive) ;;
  *)
    echo "scripts/package.sh: expected deb or archive, found '$what'" >&2
    exit 2
    ;;
esac

bash scripts/setup.sh
bash scripts/setup.sh package
bash scripts/build.sh release
build=$(pwd)/build/release
# Without MPI, which depends on the cluster: users with a cluster build Throng there.
with_mpi=$(sed -n 's/^THRONG_MPI:BOOL=//p' "$build/CMakeCache.txt")
configure() { cmake "$build" -DTHRONG_MPI="$1" >/dev/null && cmake --build "$build" --target throng >/dev/null; }
configure OFF
trap 'configure "$with_mpi"' EXIT
packages=$build/packages
mkdir -p "$packages"

make_debs() {
  rm -f "$packages"/*.deb
  (cd "$build" && cpack -G DEB) >"$packages/cpack.log" || { cat "$packages/cpack.log" >&2; exit 1; }
  rm -rf "$packages/_CPack_Packages"
}

# Libraries of the system that runs the program: the C library and its loader.
is_of_the_system() { # LIBRARY
  case $(basename "$1") in
    ld-linux*.so.* | libc.so.* | libm.so.* | libmvec.so.* | libpthread.so.* | libdl.so.* | librt.so.* | libresolv.so.* | libutil.so.*) ;;
    *) return 1 ;;
  esac
}

make_archive() {
  local name work root library file package licences
  name=throng-$("$build/throng" --version | awk '{print $2}')-linux-$(uname -m)
  work=$(mktemp -d)
  root=$work/$name
  cmake --install "$build" --prefix "$root" --component throng --strip >/dev/null
  cmake --install "$build" --prefix "$root" --component python --strip >/dev/null # nothing if it is not built

  # Built programs must find the libraries, and libraries must find each other.
  local own=("$root/bin/throng")
  while IFS= read -r file; do own+=("$file"); done < <(find "$root" -name '*.so')
  mkdir -p "$root/lib/throng"
  ldd "${own[@]}" | awk '$2 == "=>" && $3 ~ /^\// {print $3}' | sort -u | while IFS= read -r library; do
    is_of_the_system "$library" || cp -L "$library" "$root/lib/throng/"
  done
  for file in "${own[@]}"; do
    patchelf --set-rpath "\$ORIGIN/$(realpath --relative-to="$(dirname "$file")" "$root/lib/throng")" "$file"
  done
  for library in "$root"/lib/throng/*.so*; do
    chmod 755 "$library"
    patchelf --set-rpath "\$ORIGIN" "$library"
  done

  # Adds the libraries' licences.
  licences=$root/share/doc/throng/licences
  mkdir -p "$licences"
  for library in "$root"/lib/throng/*.so*; do
    package=$(dpkg-query -S "*/$(basename "$library")*" 2>/dev/null | grep -v ' diversion ' | sed 's/[:,].*//; q')
    [ -f "/usr/share/doc/$package/copyright" ] || {
      echo "scripts/package.sh: no licence of $(basename "$library")" >&2
      exit 1
    }
    cp -L "/usr/share/doc/$package/copyright" "$licences/$package"
  done
  tar -C "$work" --owner=0 --group=0 --numeric-owner --sort=name -cJf "$packages/$name.tar.xz" "$name"
  rm -rf "$work"
}

if [ "$what" != archive ]; then make_debs; fi
if [ "$what" != deb ]; then make_archive; fi
ls -l "$packages" | awk 'NF > 8 && $9 ~ /(deb|xz)$/ {printf "%s, %.1f MB\n", $9, $5 / 1e6}'
