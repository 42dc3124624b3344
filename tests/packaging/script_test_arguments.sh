#!/usr/bin/env bash
# What `./lab test ARGUMENTS` asks CTest for. Nothing is built: all packages seem to be installed, and
# everything seems to be built.
#   script_test_arguments.sh SOURCE
set -euo pipefail
source=$(readlink -f "$1")
failed=0
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/bin" "$work/clone"
cp "$source/lab" "$source/CMakePresets.json" "$work/clone/"
for tool in awk bash cat dirname env flock grep mkdir readlink sed; do
  ln -s "$(command -v $tool)" "$work/bin/"
done
program() {  # name line...
  printf '#!/bin/bash\n' >"$work/bin/$1"
  printf '%s\n' "${@:2}" >>"$work/bin/$1"
  chmod +x "$work/bin/$1"
}
program dpkg-query "printf '= installed %s\n' \"\$@\""
program cmake
program ninja 'echo "ninja: no work to do."'
program nproc 'echo 2'
program ctest 'printf "<%s>" "$@"'

asks_for() {  # wanted arguments...
  local found status=0
  found=$(PATH=$work/bin LAB_OS_RELEASE=/dev/null "$work/clone/lab" test "${@:2}" 2>&1) || status=$?
  [ "$status $found" = "0 $1" ] && return
  printf 'lab test %s: exit code %s, found\n%s\nexpected\n%s\n' "${*:2}" "$status" "$found" "$1" >&2
  failed=1
}

asks_for "<--preset><test><--no-tests=error><-j><10>"
asks_for "<--preset><test><--no-tests=error><-j><10><-R><a test>" -R "a test"
asks_for "<--preset><long><--no-tests=error><-j><10><-L><realtime>" --long -L realtime
asks_for "<--preset><test><--no-tests=error><-j><10><-L><realtime>" -L realtime
# Without the tests of the long tier, as if the preset had this -LE, too.
asks_for "<--preset><long><--no-tests=error><-j><10><-R><x><-LE><long|realtime>" -R x -LE realtime
asks_for "<--preset><long><--no-tests=error><-j><10><--label-exclude><long|realtime>" --label-exclude realtime
asks_for "<--preset><long><--no-tests=error><-j><10><-LE><realtime>" --long -LE realtime
asks_for "<--preset><test><--no-tests=error><-j><10><-LE>" -LE
exit "$failed"
