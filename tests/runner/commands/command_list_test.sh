#!/bin/sh
# The commands that ./lab lists are those of the built program, and `test`, `package` and `build` of the
# script itself.
#   command_list_test.sh LAB_SCRIPT LAB_PROGRAM
set -eu
names() { sed -n 's/^  \([a-z]*\) .*/\1/p' | sort; }
listed=$("$1" help | names | grep -vxE 'test|package|build')
built=$("$2" --help | sed '1,/^Subcommands:/d' | names)
[ "$listed" = "$built" ] && exit
printf '%s\n' "./lab help lists:" "$listed" "the program has:" "$built"
exit 1
