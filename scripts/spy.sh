#!/usr/bin/env bash
# Starts lcm-spy, LCM's view of every channel, with Throng's types: scripts/spy.sh [LCM-URL]. Starts its class
# directly, because Debian's launcher passes an option that Java 17 does not have. `scripts/spy.sh --class-path`
# prints the class path.
set -euo pipefail
cd "$(dirname "$0")/.."

types=build/${THRONG_PRESET:-release}/throng_types.jar
jars=/usr/share/java
for jar in "$jars/lcm.jar" "$jars/jchart2d.jar" "$types"; do
  if [ ! -f "$jar" ]; then
    echo "scripts/spy.sh: expected $jar; install liblcm-java, libjchart2d-java and default-jdk, then scripts/build.sh" >&2
    exit 3
  fi
done
class_path=$jars/lcm.jar:$jars/jchart2d.jar:$types
if [ "${1:-}" = --class-path ]; then
  echo "$class_path"
  exit 0
fi
url=${1:-udpm://239.255.76.67:7684?ttl=0&recv_buf_size=2097152}
exec java -Djava.net.preferIPv4Stack=true -cp "$class_path" lcm.spy.Spy "--lcm-url=$url"
