#!/bin/sh
# A command whose output a file has not taken ends with exit code 1 and a line.
#   full_disk_output_test.sh LAB_PROGRAM
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
truncate -s 8M "$folder/output"
for command in "program list" "program show abp" "--version" "theory bp"; do
  status=0
  # A limit of 1 MiB, which the output has exceeded, stands for the full disk: programs with TSan write
  # a smaller file when they start. The line goes through a pipe.
  # shellcheck disable=SC2086
  line=$( (ulimit -f 2048 && exec "$1" $command 2>&1 >>"$folder/output") ) || status=$?
  case "$status $line" in
    "1 lab: "*) ;;
    *)
      echo "lab $command: exit code $status, expected 1 and a line; found: $line"
      exit 1
      ;;
  esac
  # A reader that ends early is no fault.
  "$1" $command | true
done
