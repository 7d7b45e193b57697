#!/bin/sh
# LCM's player replays a log of Throng, and listeners with generated code only count its events.
# Runs in a separate network namespace if allowed, so that multicast works on any machine.
set -eu
write_log=$1 listener=$2 example=$3
url='udpm://239.255.76.67:7684?ttl=0&recv_buf_size=2097152'

THRONG_IN_NAMESPACE=${THRONG_IN_NAMESPACE:-}
if [ "$THRONG_IN_NAMESPACE" != yes ]; then
  for flags in -n -rn; do
    if unshare $flags true 2>/dev/null; then
      THRONG_IN_NAMESPACE=yes exec unshare $flags "$0" "$@"
    fi
  done
  if ! ip route get 239.255.76.67 >/dev/null 2>&1; then
    echo "skipped: no network namespaces here (unshare -n, unshare -rn) and no multicast route"
    exit 77
  fi
fi

dir=$(mktemp -d)
pids=
trap 'kill $pids 2>/dev/null || true; rm -rf "$dir"' EXIT

if [ "$THRONG_IN_NAMESPACE" = yes ]; then
  ip link set lo up
  ip link set lo multicast on
  # Without a route the publisher prints one line with the remedy, and the run continues.
  "$write_log" /dev/null "$url" >/dev/null 2>"$dir/warning" || {
    echo "the run failed without a route"
    exit 1
  }
  warning=$(cat "$dir/warning")
  case $warning in
  *"
"*) echo "more than one line: $warning"; exit 1 ;;
  *"ip route add 224.0.0.0/4 dev lo"*) ;;
  *) echo "no remedy in: $warning"; exit 1 ;;
  esac
  ip route add 224.0.0.0/4 dev lo
fi

expected=$("$write_log" "$dir/run.lcmlog")

"$listener" "$url" >"$dir/listener" &
listener_pid=$!
"$example" >"$dir/example" &
pids="$listener_pid $!"
tries=0
until grep -q listening "$dir/listener"; do
  tries=$((tries + 1))
  [ $tries -lt 100 ] || { echo "the listener does not start"; exit 1; }
  sleep 0.05
done
sleep 0.2 # the example prints nothing at its start
lcm-logplayer --lcm-url="$url" "$dir/run.lcmlog" >"$dir/player" 2>&1
status=0
wait $listener_pid || status=$?
found=$(tail -n 1 "$dir/listener")
echo "in the log:  $expected"
echo "replayed:    $found"
[ "$found" = "$expected" ] || { echo "the replay differs"; exit 1; }
[ $status -eq 0 ] || { echo "the listener's counts differ from THRONG_END"; exit 1; }

sleep 0.2
touches=$(grep -c ' touches ' "$dir/example")
leaves=$(grep -c ' leaves ' "$dir/example")
[ "begins $touches ends $leaves" = "$expected" ] || {
  echo "subscriber_example printed begins $touches ends $leaves"
  exit 1
}
