#!/usr/bin/env bash
# Which packages the script `lab` asks for, on Debian and on Ubuntu. Nothing is installed: here no
# package is present, the user is not root, and there is no sudo.
#   script_packages.sh SOURCE
set -euo pipefail
source=$(readlink -f "$1")
failed=0
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/bin" "$work/clone"
cp "$source/lab" "$work/clone/"
for tool in awk bash cat dirname env flock grep mkdir readlink sed; do
  ln -s "$(command -v $tool)" "$work/bin/"
done
printf '#!/bin/sh\n' >"$work/bin/dpkg-query"
printf '#!/bin/sh\necho 1000\n' >"$work/bin/id"
chmod +x "$work/bin/dpkg-query" "$work/bin/id"
echo 'ID=debian' >"$work/debian"
printf 'PRETTY_NAME="Ubuntu 24.04 LTS"\nID=ubuntu\nID_LIKE=debian\n' >"$work/ubuntu"

asked_for() {  # os-release command...: the packages, one per line
  local output status=0
  output=$(PATH=$work/bin LAB_OS_RELEASE=$work/$1 "$work/clone/lab" "${@:2}" 2>&1) || status=$?
  [ "$status" -eq 2 ] || { echo "exit code $status: $output" >&2; return 1; }
  sed -n 's/.*apt-get install -y --no-install-recommends //p' <<<"$output" | tr ' ' '\n'
}
expect() {  # what found wanted
  [ "$2" = "$3" ] && return
  printf '%s: found\n%s\nexpected\n%s\n' "$1" "$2" "$3" >&2
  failed=1
}

debian=$(asked_for debian test)
ubuntu=$(asked_for ubuntu test)
[ "$(wc -l <<<"$debian")" -gt 40 ] || { echo "few packages: $debian" >&2; failed=1; }
expect "only on Debian" "$(grep -vxF "$ubuntu" <<<"$debian")" $'chromium\nchromium-driver'
expect "only on Ubuntu" "$(grep -vxF "$debian" <<<"$ubuntu")" \
  $'chromium-browser\nchromium-chromedriver'
expect "for a run" "$(asked_for ubuntu build)" "$(asked_for debian build)"
exit "$failed"
