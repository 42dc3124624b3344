#!/usr/bin/env bash
# A clone on a bare Debian 13, with its g++ 14 and CMake 3.31: ./lab installs, builds and tests.
#   debian_13.sh SOURCE [FOLDER_FOR_THE_ROOT] [ARGUMENTS_OF_CTEST...]
# Needs root, mmdebstrap and a Debian mirror; 77 where one of them is missing. LAB_MIRROR names another
# mirror.
set -euo pipefail
source=$(readlink -f "$1")
skip() {
  echo "skipped: $*"
  exit 77
}
[ "$(id -u)" -eq 0 ] || skip "not root: a chroot cannot be entered"
command -v mmdebstrap >/dev/null || skip "no mmdebstrap: apt-get install mmdebstrap"
# The mounts belong to this mount namespace and end with it.
[ -n "${LAB_CHROOT_INSIDE-}" ] || LAB_CHROOT_INSIDE=1 exec unshare --mount --propagation private "$0" "$@"

work=$(mktemp -d "${2:-${TMPDIR:-/tmp}}/active-lab-debian13.XXXXXX")
root=$work/root
trap 'umount -l "$root/proc" "$root/sys" "$root/dev" 2>/dev/null; rm -rf --one-file-system "$work"' EXIT
mmdebstrap --quiet --variant=apt --dpkgopt='force-unsafe-io' --include=ca-certificates,mount trixie "$root" \
  ${LAB_MIRROR:+"$LAB_MIRROR"} >"$work/bootstrap.log" 2>&1 || {
  tail -n 3 "$work/bootstrap.log"
  skip "no bare root could be made: is a mirror reachable?"
}
mount -t proc proc "$root/proc"
mount -t sysfs sys "$root/sys" 2>/dev/null || true
mount --rbind /dev "$root/dev"
cp /etc/resolv.conf "$root/etc/resolv.conf"
printf '#!/bin/sh\nexit 101\n' >"$root/usr/sbin/policy-rc.d"
chmod 755 "$root/usr/sbin/policy-rc.d"

mkdir -p "$root/root/active-lab"
(cd "$source" && git ls-files -z | tar --null --files-from=- -cf -) | tar -xf - -C "$root/root/active-lab"
# pivot_root, because in a chroot nobody can make the user namespaces that tests need.
inside() {
  unshare --mount --propagation private bash -c '
    mount --rbind "$1" "$1" && cd "$1" && pivot_root . mnt && cd / && umount -l /mnt &&
    exec env -i HOME=/root PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 \
      sh -c "cd /root/active-lab && $2"' _ "$root" "$1"
}
inside "./lab test ${*:3}"
