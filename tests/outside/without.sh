#!/usr/bin/env bash
# Runs a command as on a machine where what it names first was never installed:
# tests/outside/without.sh "PACKAGE..." COMMAND... Debian packages lose their files, in a view of /usr that
# the command alone sees. Exit code 77 where the system gives nobody such a view.
set -euo pipefail

if [ "${THRONG_HIDING:-}" != yes ]; then
  [ "$(id -u)" -eq 0 ] && rights=-m || rights=-rm
  view=$(mktemp -d)
  trap 'rmdir "$view"' EXIT
  if ! unshare "$rights" true 2>/dev/null || ! command -v dpkg-query >/dev/null; then
    echo "skipped: no mounts of one's own here, or no Debian packages"
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
  echo "skipped: no overlay over /usr here"
  exit 77
fi
for package in $1; do
  # Folders stay: others have files in them.
  { dpkg-query -L "$package" 2>/dev/null || true; } | while IFS= read -r file; do
    if [ -f "$file" ] || [ -L "$file" ]; then printf '%s\0' "$file"; fi
  done
done | xargs -0 rm -f
shift
"$@"
