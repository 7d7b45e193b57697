# Sourced by tests that need multicast: continues in a separate network namespace, where it works on
# any machine; skips the test if namespaces are not allowed.
if [ "${THRONG_IN_NAMESPACE:-}" != yes ]; then
  for flags in -n -rn; do
    if unshare $flags true 2>/dev/null; then
      THRONG_IN_NAMESPACE=yes exec unshare $flags "$0" "$@"
    fi
  done
  echo "skipped: no network namespaces here (unshare -n, unshare -rn)"
  exit 77
fi
ip link set lo up
ip link set lo multicast on
ip route add 224.0.0.0/4 dev lo
dir=$(mktemp -d)
pids=
trap 'kill $pids 2>/dev/null || true; rm -rf "$dir"' EXIT
