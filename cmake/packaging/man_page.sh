#!/usr/bin/env bash
# Makes a man page from the --help of a program.
#   man_page.sh NAME VERSION SOURCE PROGRAM NAME.1.gz
# Each subcommand gets a section. The date is that of the commit in SOURCE.
set -euo pipefail
name=$1 version=$2 source=$3 program=$4
date=$(git -C "$source" log -1 --format=%cs 2>/dev/null) || date=

# CLI11's help as roff: its first line is the summary, lines with two spaces are options, and lines that
# are indented further describe them.
format() {  # whole|part
  awk -v mode="$1" '
    function escaped(text) {
      gsub(/\\/, "\\e", text)
      gsub(/-/, "\\-", text)
      return text ~ /^[.'"'"']/ ? "\\\&" text : text
    }
    FNR == 1 { summary = $0; next }
    /^Usage: / { usage = substr($0, 8); next }
    /^(Positionals|Options|Subcommands):$/ { section = substr($0, 1, length($0) - 1); head = 1; next }
    /^ *$/ { next }
    /^  [^ ]/ {
      if (head && mode == "whole") body = body ".SH " toupper(section) "\n"
      head = 0
      item = substr($0, 3)
      about = ""
      if (match(item, /  +/)) {
        about = substr(item, RSTART + RLENGTH)
        item = substr(item, 1, RSTART - 1)
      }
      body = body ".TP\n.B " escaped(item) "\n"
      if (about != "") body = body escaped(about) "\n"
      next
    }
    /^   +[^ ]/ { sub(/^ +/, ""); body = body escaped($0) "\n"; next }
    { body = body ".PP\n" escaped($0) "\n" }
    END {
      if (mode == "whole") {
        print escaped(summary) "\n.SH SYNOPSIS\n.B " escaped(usage)
      } else {
        print ".PP\n.B " escaped(usage) "\n.PP\n" escaped(summary) "."
      }
      printf "%s", body
    }'
}

print_help() {  # words: the help of a subcommand, without parts that depend on the user
  env -u LCM_DEFAULT_URL "$program" "$@" --help | sed -E "s#active-lab-ports-[0-9]+#active-lab-ports-UID#; s#\{false\}##g"
}

subcommands() {  # names of subcommands, from the help on stdin
  sed -n '/^Subcommands:/,$ s/^  \([a-z-]*\) .*/\1/p'
}

page() {
  printf '.TH %s 1 "%s" "Active Lab %s" "Active Lab"\n.SH NAME\n%s \\- ' \
    "$(tr '[:lower:]' '[:upper:]' <<<"$name")" "$date" "$version" "${name//-/\\-}"
  print_help | format whole
  print_help | subcommands | while read -r command; do
    printf '.SH "%s %s"\n' "${name//-/\\-}" "$command"
    print_help "$command" | format part
    print_help "$command" | subcommands | while read -r part; do
      printf '.SS "%s %s"\n' "$command" "$part"
      print_help "$command" "$part" | format part
    done
  done
  cat <<'END'
.SH FILES
.TP
.I /usr/share/active\-lab/experiments
the shipped experiments, which can be given by name
.TP
.I /usr/share/doc/active\-lab/docs
the manual
.SH "EXIT STATUS"
0 success; 2 bad input, nothing was started; 3 a run ended early, its data are kept and marked;
1 any other error.
END
  [ "$name" = active-lab ] || printf '.SH "SEE ALSO"\n.BR active\\-lab (1)\n'
}

page | gzip -9n >"$5"
