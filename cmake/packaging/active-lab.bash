# Completion for bash: `active-lab` where it is installed, `./lab` in a clone (. cmake/packaging/active-lab.bash).
# Each TAB reads the --help of the program, so that completion and program never differ.

_active_lab_help() {  # program command...: its help; nothing where it is not built yet
  local program=$1
  shift
  # Calls the built program instead of ./lab, which would build first.
  [[ ${program##*/} != lab ]] ||
    program=$(dirname "$(readlink -f "$program")")/build/release/bin/lab
  [[ ! -e $program && $program == */* ]] || "$program" "$@" --help 2>/dev/null
}

_active_lab_experiments() {  # program: the folder of the shipped experiments
  local program
  program=$(readlink -f "$(command -v "$1")") || return
  if [[ $program == */lib/active-lab/bin/lab ]]; then
    echo "${program%/lib/active-lab/bin/lab}/share/active-lab/experiments"
  else
    echo "${program%/*}/experiments"
  fi
}

_active_lab() {
  local program=${COMP_WORDS[0]/#\~/$HOME} word=${COMP_WORDS[COMP_CWORD]}
  local before=${COMP_WORDS[COMP_CWORD - 1]} help file i
  # The words before this one that are not options; `calibrate` has sub-commands.
  local commands=()
  for ((i = 1; i < COMP_CWORD && i < 3; ++i)); do
    [[ ${COMP_WORDS[i]} =~ ^[a-z-]+$ && ${COMP_WORDS[i]} != -* ]] || break
    [[ $i -eq 1 || ${COMP_WORDS[1]} == calibrate ]] || break
    commands+=("${COMP_WORDS[i]}")
  done
  help=$(_active_lab_help "$program" "${commands[@]}")
  COMPREPLY=()
  if [[ $word == -* ]]; then
    # "--figures,--no-figures{false} ..." holds two options.
    mapfile -t COMPREPLY < <(compgen -W "$(sed -n 's/^  \(-[^ ]*\).*/\1/p' <<<"$help" |
      tr ',' '\n' | sed 's/{.*//')" -- "$word")
    return
  fi
  if grep -q '^Subcommands:' <<<"$help"; then
    mapfile -t COMPREPLY < <(compgen -W "$(sed -n '/^Subcommands:/,$ s/^  \([a-z-]*\) .*/\1/p' \
      <<<"$help")" -- "$word")
    return
  fi
  # Files; for a command that takes an experiment, also the names of the shipped ones.
  compopt -o filenames
  mapfile -t COMPREPLY < <(compgen -f -- "$word")
  if [[ $before != --* ]] && grep -q '^  FILE .*Experiment' <<<"$help"; then
    for file in "$(_active_lab_experiments "$program")"/*.toml; do
      file=${file##*/}
      [[ -e $file || ${file%.toml} != "$word"* ]] || COMPREPLY+=("${file%.toml}")
    done
  fi
}

complete -F _active_lab active-lab ./lab
