#!/bin/sh
# Java finds lcm-spy and all message types on the class path of scripts/spy.sh.
set -eu
spy=$1 jar=$2
shift 2
[ -f "$jar" ] && [ -f /usr/share/java/jchart2d.jar ] || {
  echo "skipped: no JDK, liblcm-java or libjchart2d-java here"
  exit 77
}
[ "$jar" -ef "$(dirname "$spy")/../build/release/throng_types.jar" ] || {
  echo "skipped: scripts/spy.sh is for the release build"
  exit 77
}
cd "$(dirname "$spy")/.."
class_path=$("$spy" --class-path)
classes=$(javap -cp "$class_path" lcm.spy.Spy $(printf 'throng.%s ' "$@"))
echo "$classes" | grep -q 'void main'
found=$(echo "$classes" | grep -c 'LCM_FINGERPRINT;')
[ "$found" -eq $# ] || { echo "$found types, expected $#"; exit 1; }
