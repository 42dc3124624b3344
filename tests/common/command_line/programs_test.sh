#!/bin/sh
# Every program that users call by hand names an unknown option in one line, and prints its help whatever else
# is typed. Nothing is started: none of them opens a bus, a line or a window.
#   programs_test.sh PROGRAM...
set -eu
failed=0

refuses() {  # program what_is_said arguments...
  program=$1 name=$(basename "$1") said=$2 status=0
  shift 2
  found=$("$program" "$@" 2>&1) || status=$?
  expected="$name: $said"
  [ "$status $found" = "2 $expected" ] && return
  printf '%s %s: exit code %s, expected 2; found:\n%s\nexpected:\n%s\n' "$name" "$*" "$status" "$found" "$expected"
  failed=1
}

for program; do
  name=$(basename "$program")
  refuses "$program" "--frobnicate: no such option of \`$name\`; $name --help lists them" --frobnicate
  if ! "$program" --frobnicate --help | grep -q "^Usage: $name "; then
    echo "$name --frobnicate --help: no help"
    failed=1
  fi
  case $name in
    robot_bridge)
      refuses "$program" "--lst: no such option of \`$name\`; did you mean --list?" --lst
      refuses "$program" "--frobnicate: no such option of \`$name\`; $name --help lists them" --list --frobnicate
      ;;
    projector_ctl)
      refuses "$program" "--frobnicate: no such option of \`$name\`; $name --help lists them" \
        --list-displays --frobnicate
      ;;
    robot_emulator)
      refuses "$program" "--ports or --arena-socket is required; $name --help explains it" --robots 2
      ;;
  esac
done
exit $failed
