#!/bin/sh
# Runs a command with private hosts: network namespaces, joined by a router that forwards no multicast.
# No traffic leaves them, and they end with the command.
#
#   two_hosts.sh [--hosts N] [--loss PERCENT] [--seed N] [--router] COMMAND [ARGUMENTS]
#     --hosts N        2 (A and B) or 3 (A, B and C)
#     --loss PERCENT   loss of frames between A and the others, in each direction
#     --seed N         random seed of the losses
#     --router         accepted for compatibility; there is always a router
#
# The command runs on the router with the environment variables
#   HOST_A HOST_B HOST_C             a process in each namespace: nsenter -t "$HOST_A" -n COMMAND
#   ADDRESS_A ADDRESS_B ADDRESS_C    10.77.1.1, 10.77.2.1, 10.77.3.1
#   TWO_HOSTS                        this script:
#     "$TWO_HOSTS" on A COMMAND...     runs a command on A (replaces the shell: exec, signals)
#     "$TWO_HOSTS" cut [B]             unplugs the cable of a host (default B)
#     "$TWO_HOSTS" restore [B]         plugs it in again
#     "$TWO_HOSTS" mute B / unmute B   the router drops all packets to and from B; the cable stays plugged in
# On each host multicast is routed over lo, as on a lab computer. The exit status is that of the command;
# 125: setup failed, 77: this system allows no network namespaces (skipped).

address_of() {
  case $1 in
    A) echo 10.77.1.1 ;;
    B) echo 10.77.2.1 ;;
    C) echo 10.77.3.1 ;;
    *) echo "two_hosts.sh: no host $1" >&2 && return 1 ;;
  esac
}

# ---- commands within the running networks -------------------------------------------------------
case ${TWO_HOSTS:+$1} in
  on)
    eval "pid=\$HOST_$2"
    shift 2
    # shellcheck disable=SC2154
    exec nsenter -t "$pid" -n "$@"
    ;;
  cut) exec ip link set dev "leg${2:-B}" down ;;
  restore) exec ip link set dev "leg${2:-B}" up ;;
  mute)
    address=$(address_of "$2") || exit 125
    ip route add blackhole "$address/32" && exec ip rule add pref 10 from "$address" blackhole
    ;;
  unmute)
    address=$(address_of "$2") || exit 125
    ip route del blackhole "$address/32" && exec ip rule del pref 10 from "$address" blackhole
    ;;
esac

# ---- outside: enter private network and, if possible, process namespaces ---------------------------
if [ "${TWO_HOSTS_STAGE:-}" != inside ]; then
  if [ $# -eq 0 ]; then
    echo "usage: $0 [--hosts N] [--loss PERCENT] [--seed N] COMMAND [ARGUMENTS]" >&2
    exit 125
  fi
  folder=$(cd "$(dirname "$0")" && pwd)
  export TWO_HOSTS_FOLDER="$folder"
  for new in "-n -m -p -f --kill-child --mount-proc" "-Urn -m -p -f --kill-child --mount-proc" -n -Urn; do
    # shellcheck disable=SC2086
    if unshare $new unshare -n true 2>/dev/null; then
      # shellcheck disable=SC2086
      TWO_HOSTS_STAGE=inside exec unshare $new "$folder/two_hosts.sh" "$@"
    fi
  done
  echo "two_hosts.sh: skipped, this system allows no network namespaces (unshare -n, unshare -Urn)" >&2
  exit 77
fi
unset TWO_HOSTS_STAGE

# ---- inside: build the networks --------------------------------------------------------------------
hosts=2
loss=0
seed=1
while [ $# -gt 0 ]; do
  case $1 in
    --hosts) hosts=$2 && shift 2 ;;
    --loss) loss=$2 && shift 2 ;;
    --seed) seed=$2 && shift 2 ;;
    --router) shift ;;
    *) break ;;
  esac
done

children=
# shellcheck disable=SC2317,SC2064
finish() {
  # shellcheck disable=SC2086
  kill $children 2>/dev/null
}
trap finish EXIT
trap 'exit 143' TERM
trap 'exit 130' INT

fail() {
  echo "two_hosts.sh: $1" >&2
  exit 125
}

# Starts a process in a new network namespace; its id is in $made.
network() {
  unshare -n sleep 1000000 &
  made=$!
  children="$children $made"
  # unshare executes sleep once it is in the namespace
  until [ "$(cat "/proc/$made/comm" 2>/dev/null)" = sleep ]; do
    kill -0 "$made" 2>/dev/null || fail "cannot create a network namespace"
  done
}

ip link set dev lo up
ip route add 224.0.0.0/4 dev lo || fail "multicast cannot be routed over lo (package iproute2)"
echo 1 >/proc/sys/net/ipv4/ip_forward || fail "no forwarding"

number=1
for host in A B C; do
  [ "$number" -gt "$hosts" ] && break
  network
  pid=$made
  export "HOST_$host=$pid" "ADDRESS_$host=10.77.$number.1"
  ip link add "leg$host" type veth peer name eth0 netns "$pid" || fail "cannot create a veth pair"
  if [ "$host" = A ] && [ "$loss" != 0 ]; then
    # A -- eth0 | near, wire, far | legA -- router: lossy_wire.py in "wire" loses frames.
    network
    wire=$made
    nsenter -t "$pid" -n ip link set dev eth0 netns "$wire" name far
    nsenter -t "$wire" -n sh -c "ip link add near type veth peer name eth0 netns $pid &&
      ip link set dev near up && ip link set dev far up" || fail "cannot create the wire"
    ready=$(mktemp)
    nsenter -t "$wire" -n python3 "$TWO_HOSTS_FOLDER/lossy_wire.py" near far "$loss" "$seed" >"$ready" &
    children="$children $!"
    lossy=$!
    until grep -q ready "$ready"; do
      kill -0 "$lossy" 2>/dev/null || fail "the lossy wire does not work (python3)"
    done
    rm -f "$ready"
  fi
  nsenter -t "$pid" -n sh -c "
    ip link set dev lo up && ip address add 10.77.$number.1/24 dev eth0 && ip link set dev eth0 up &&
    ip route add default via 10.77.$number.254 && ip route add 224.0.0.0/4 dev lo" ||
    fail "host $host has no network"
  ip address add "10.77.$number.254/24" dev "leg$host" && ip link set dev "leg$host" up ||
    fail "no router"
  number=$((number + 1))
done
if [ "$loss" != 0 ]; then
  # lossy_wire.py needs frames with checksums and of normal size, so offloads are switched off.
  python3 "$TWO_HOSTS_FOLDER/lossy_wire.py" --whole-frames legA || fail "offloads of legA"
  nsenter -t "$HOST_A" -n python3 "$TWO_HOSTS_FOLDER/lossy_wire.py" --whole-frames eth0 ||
    fail "offloads of eth0"
fi

# A new veth pair needs up to a second until it is up.
for host in A B C; do
  eval "pid=\${HOST_$host:-}"
  [ -n "$pid" ] || continue
  until ip -brief link show "leg$host" | grep -q ' UP ' &&
    nsenter -t "$pid" -n ip -brief link show eth0 | grep -q ' UP '; do sleep 0.05; done
done

export TWO_HOSTS="$TWO_HOSTS_FOLDER/two_hosts.sh"
"$@" &
command=$!
trap 'kill -TERM $command 2>/dev/null' TERM INT
wait "$command"
status=$?
# A signal to this script ends the first wait, but not the command.
while kill -0 "$command" 2>/dev/null; do
  wait "$command"
  status=$?
done
exit "$status"
