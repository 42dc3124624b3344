#!/bin/sh
# Runs a command in a private network namespace: only the loopback interface, with multicast routed over it.
# Messages of the command cannot leave, and messages of others cannot reach it.
#   in_private_network.sh COMMAND [ARGUMENTS]
# The command replaces this script, so exit status and signals are those of the command. 125: it could
# not be started.
if [ $# -eq 0 ]; then
  echo "usage: $0 COMMAND [ARGUMENTS]" >&2
  exit 125
fi
for new in -n -Urn; do # as root, or with a user namespace in which we are root
  if unshare $new true 2>/dev/null; then
    # shellcheck disable=SC2016
    exec unshare $new sh -c '
      if ip link set dev lo up && ip route add 224.0.0.0/4 dev lo; then exec "$@"; fi
      echo "in_private_network.sh: cannot route multicast over lo (package iproute2)" >&2
      exit 125' sh "$@"
  fi
done
echo "in_private_network.sh: this system allows no network namespace (unshare -n, unshare -Urn);" \
  "run as root, or set sysctl kernel.unprivileged_userns_clone=1 / user.max_net_namespaces" >&2
exit 125
