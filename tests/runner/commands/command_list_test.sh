#!/bin/sh
# The commands that ./lab lists are those of the built program, and `test` and `package`, which are the
# script's own.
#   every_command_is_listed.sh LAB_SCRIPT LAB_PROGRAM
set -eu
names() { sed -n 's/^  \([a-z]*\) .*/\1/p' | sort; }
listed=$("$1" help | names | grep -vxE 'test|package')
built=$("$2" --help | sed '1,/^Subcommands:/d' | names)
[ "$listed" = "$built" ] && exit
printf '%s\n' "./lab help lists:" "$listed" "the program has:" "$built"
exit 1
