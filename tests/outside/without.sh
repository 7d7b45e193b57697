#!/usr/bin/env bash
# Runs a command as on a machine without some packages: tests/outside/without.sh "PACKAGE..." COMMAND... Files of
# these Debian packages are removed in a view of /usr that only the command sees. Exit code 77 if the system allows
# no such view.
set -euo pipefail

if [ "${THRONG_HIDING:-}" != yes ]; then
  [ "$(id -u)" -eq 0 ] && rights=-m || rights=-rm
  view=$(mktemp -d)
  trap 'rmdir "$view"' EXIT
  if ! unshare "$rights" true 2>/dev/null || ! command -v dpkg-query >/dev/null; then
    echo "skipped: private mounts are not allowed here, or there are no Debian packages"
    exit 77
  fi
  status=0
  THRONG_HIDING=yes THRONG_VIEW=$view unshare "$rights" bash "$0" "$@" || status=$?
  exit "$status"
fi

view=$THRONG_VIEW
unset THRONG_HIDING THRONG_VIEW
if ! mount -t tmpfs view "$view" || ! mkdir "$view/upper" "$view/work" ||
    ! mount -t overlay view -o "lowerdir=/usr,upperdir=$view/upper,workdir=$view/work" /usr; then
  echo "skipped: /usr cannot be overlaid here"
  exit 77
fi
for package in $1; do
  # Folders stay, because they contain files of other packages.
  { dpkg-query -L "$package" 2>/dev/null || true; } | while IFS= read -r file; do
    if [ -f "$file" ] || [ -L "$file" ]; then printf '%s\0' "$file"; fi
  done
done | xargs -0 rm -f
shift
"$@"
