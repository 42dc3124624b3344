#!/usr/bin/env bash
# The packages on a bare root of the Debian that they were made on: installs them with apt, runs the lab
# as an ordinary user, takes them away again, and looks at what is left.
#   smoke.sh FOLDER_OF_PACKAGES [FOLDER_FOR_THE_RUN]
# Needs root, mmdebstrap and a Debian mirror; 77 where one of them is not to be had. LAB_MIRROR names
# another mirror.
set -euo pipefail
packages=$(readlink -f "$1")
here=$(dirname "$(readlink -f "$0")")
skip() {
  echo "skipped: $*"
  exit 77
}
[ "$(id -u)" -eq 0 ] || skip "not root: a chroot cannot be entered"
command -v mmdebstrap >/dev/null || skip "no mmdebstrap: apt-get install mmdebstrap"
# Mounts of our own, which end with us.
[ -n "${LAB_SMOKE_INSIDE-}" ] || LAB_SMOKE_INSIDE=1 exec unshare --mount --propagation private "$0" "$@"

work=$(mktemp -d "${2:-${TMPDIR:-/tmp}}/active-lab-smoke.XXXXXX")
root=$work/root
trap 'umount -l "$root/proc" "$root/sys" 2>/dev/null; rm -rf --one-file-system "$work"' EXIT
failed=0
fail() {
  echo "FAILED: $*"
  failed=1
}
step() { printf '== %s\n' "$*"; }
inside() { chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 "$@"; }
as_user() {  # in a network of its own, as somebody with no rights who is logged in
  "$here/../in_private_network.sh" chroot --userspec=1000:1000 "$root" env -i HOME=/home/user \
    XDG_RUNTIME_DIR=/run/user/1000 \
    PATH=/usr/bin:/bin LC_ALL=C.UTF-8 sh -c "cd ~ && $1"
}
expect() {  # what, text, pattern that it contains
  grep -qE -- "$3" <<<"$2" || fail "$1: expected a match of $3, found: $2"
}
everything() { (cd "$root" && find . -xdev \( -path ./proc -o -path ./sys -o -path ./deb \) -prune -o -print) | sort; }

suite=$(. /etc/os-release && echo "${VERSION_CODENAME-}")
[ -n "$suite" ] || skip "/etc/os-release names no VERSION_CODENAME"
step "a bare $suite"
mmdebstrap --quiet --variant=apt --dpkgopt='force-unsafe-io' --include=passwd "$suite" "$root" \
  ${LAB_MIRROR:+"$LAB_MIRROR"} >"$work/bootstrap.log" 2>&1 || {
  tail -n 3 "$work/bootstrap.log"
  skip "no bare root could be made: is a mirror reachable?"
}
mount -t proc proc "$root/proc"
mount -t sysfs sys "$root/sys" 2>/dev/null || true
cp /etc/resolv.conf "$root/etc/resolv.conf"
printf '#!/bin/sh\nexit 101\n' >"$root/usr/sbin/policy-rc.d"
chmod 755 "$root/usr/sbin/policy-rc.d"
inside useradd -m -u 1000 user
install -d -o 1000 -g 1000 -m 700 "$root/run/user/1000"  # a session's; it ends with it
inside apt-get update -qq
echo "$(inside dpkg-query -f '.\n' -W | wc -l) packages: no compiler, no $(
  for name in gcc python3 gnuplot lcm-logger ip; do inside sh -c "command -v $name" >/dev/null || printf '%s ' $name; done)"
everything >"$work/before"

step "apt install ./active-lab*.deb"
mkdir "$root/deb"
cp "$packages"/active-lab*.deb "$root/deb"
inside sh -c 'cd /deb && apt-get install -y -q ./active-lab*.deb' >"$work/install.log" 2>&1 ||
  { tail -n 20 "$work/install.log"; fail "apt install"; exit 1; }
grep -E '^Need to get|newly installed|additional disk' "$work/install.log" || true
dpkg --root="$root" --verify active-lab active-lab-gateway >"$work/verify" || true
[ ! -s "$work/verify" ] || fail "dpkg --verify: $(cat "$work/verify")"

step "as an ordinary user"
expect "--version" "$(as_user 'active-lab --version')" '^Active Lab [0-9]'
as_user 'active-lab --version'
expect "which" "$(as_user 'command -v active-lab')" '^/usr/bin/active-lab$'
said=$(as_user 'active-lab run light_switching --set duration_s=10' 2>&1) || fail "run: $said"
expect "a run in real time" "$said" '^web +http://127\.0\.0\.1:[0-9]+/#token='
expect "a run in real time" "$said" '^report .*/home/user/runs/light_switching-.*/report.html'
echo "$said" | tail -n 3
said=$(as_user 'active-lab run light_switching --virtual-time --set duration_s=60' 2>&1) || fail "run: $said"
expect "a run in virtual time" "$said" '^report '
if [ -e "$root/usr/lib/active-lab/bin/robot_emulator" ]; then
  said=$(as_user 'active-lab run mixed_bodies --virtual-time --no-report --set duration_s=2' 2>&1) || fail "chips: $said"
fi
said=$(as_user 'active-lab run ros2 --no-report --set duration_s=3' 2>&1) || fail "the gateway: $said"
said=$(as_user 'active-lab doctor' 2>&1) || true
expect "doctor" "$said" 'dds_gateway is there'
! grep -q '\./lab' <<<"$said" || fail "doctor speaks of a clone: $said"
code=0
said=$(as_user 'cd / && active-lab run light_switching --virtual-time' 2>&1) || code=$?
[ $code -eq 2 ] || fail "a folder that cannot be written: ended with $code"
expect "a folder that cannot be written" "$said" '--runs'
for page in active-lab active-lab-sim_svc active-lab-dds_gateway; do
  [ -s "$root/usr/share/man/man1/$page.1.gz" ] || fail "no man page $page"
done
[ -s "$root/usr/share/bash-completion/completions/active-lab" ] || fail "no completion"
expect "TAB" "$(inside bash -c 'compopt() { :; }; . /usr/share/bash-completion/completions/active-lab
  COMP_WORDS=(active-lab run light_s) COMP_CWORD=2; _active_lab; echo "${COMPREPLY[@]}"')" light_switching

step "without the two other packages"
inside apt-get purge -y -q active-lab-gateway active-lab-emulator >"$work/purge.log" 2>&1 || fail "purge: $(tail "$work/purge.log")"
for try in 'mixed_bodies --virtual-time:active-lab-emulator' 'ros2:active-lab-gateway'; do
  code=0
  said=$(as_user "active-lab run ${try%:*}" 2>&1) || code=$?
  [ $code -eq 2 ] || fail "${try%:*}: ended with $code, expected 2"
  expect "${try%:*}" "$said" "apt install ./${try#*:}_"
done

step "apt purge"
inside apt-get purge -y -q active-lab >>"$work/purge.log" 2>&1 || fail "purge: $(tail "$work/purge.log")"
inside apt-get autoremove --purge -y -q >>"$work/purge.log" 2>&1 || fail "autoremove: $(tail "$work/purge.log")"
inside apt-get clean
rm -rf "$root/run/user/1000"
everything >"$work/after"
comm -13 "$work/before" "$work/after" >"$work/left"
runs=$(grep -c '^./home/user/runs/' "$work/left" || true)
echo "left: $runs paths under /home/user/runs, and of the system's own books and the libraries':"
grep -v '^./home/user/runs' "$work/left" | sed 's/^/  /'
if ours=$(grep -v '^./home/user/runs' "$work/left" | grep -iE 'active.?lab'); then fail "left behind: $ours"; fi
[ "$runs" -gt 0 ] || fail "the runs are gone"
exit $failed
