#!/bin/sh
# What programs say of names that contain control characters: they are shown as text. Nothing is started.
#   errors_test.sh SIM_SVC ROBOT_BRIDGE PROJECTOR_CTL
set -eu
failed=0
escape=$(printf '\033')
odd="odd$escape[2J"

shows() {  # what_is_said command...
  said=$1 status=0
  shift
  found=$("$@" 2>&1) || status=$?
  case $found in
    *"$escape"*) ;;
    *"$said"*) [ "$status" = 2 ] && return ;;
  esac
  echo "$*: exit code $status, expected 2 and \"$said\"; found:" | cat -v
  echo "$found" | cat -v
  failed=1
}

shows 'odd\x1b[2J.toml: found no such file' "$1" --experiment "$odd.toml"
shows 'odd\x1b[2J: not there' "$2" --set-uid 7 "$odd"
shows 'odd\x1b[2J not available' env SDL_VIDEODRIVER="$odd" "$3" --list-displays
exit $failed
