#!/usr/bin/env bash
# Whole runs: the speed of one hour of one robot in virtual time relative to real time, with and without
# the report, and the CPU of a live lab with 20 robots.
#   run_benchmark.sh FOLDER_OF_PROGRAMS EXPERIMENTS RESULT.csv
set -euo pipefail
programs=$1 experiments=$2 result=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export XDG_RUNTIME_DIR=$work
ticks=$(getconf CLK_TCK)

cpu_seconds() {  # of a finished command
  local TIMEFORMAT='%U %S'
  { time "$@" >/dev/null 2>&1; } 2>&1 | awk '{print $1 + $2}'
}

mkdir -p "$(dirname "$result")"
echo "what,value,unit" >"$result"
note() { echo "$1,$2,$3" | tee -a "$result"; }

hour() {  # more arguments...
  cpu_seconds taskset -c 0 "$programs/lab" run "$experiments/abp.toml" --virtual-time \
    --out "$work/virtual" "$@"
}
note "1 robot 1 h 50 fps with log and report, times real time on one core" \
  "$(hour | awk '{printf "%.0f", 3600 / $1}')" 1
note "the same without report, times real time on one core" \
  "$(hour --no-report | awk '{printf "%.0f", 3600 / $1}')" 1

# CPU of every process of a live run between its 5th and its 25th second.
"$programs/lab" run "$experiments/swarm.toml" --set duration_s=30 --no-report \
  --out "$work/live" >/dev/null &
lab=$!
sample() {
  for pid in $lab $(pgrep -P $lab); do
    awk -v pid="$pid" '{sub(/.*\) /, ""); print pid, $12 + $13}' "/proc/$pid/stat"
  done
}
sleep 5
sample >"$work/before"
sleep 20
sample >"$work/after"
total=0
while read -r pid used; do
  name=$(tr -d '\0' <"/proc/$pid/comm")
  percent=$(awk -v pid="$pid" -v used="$used" -v hz="$ticks" \
    '$1 == pid {printf "%.1f", ($2 - used) * 100 / hz / 20}' "$work/after")
  note "20 robots live: $name" "$percent" "% of one core"
  total=$(awk -v a="$total" -v b="$percent" 'BEGIN {print a + b}')
done <"$work/before"
note "20 robots live: all processes" "$total" "% of one core"
wait $lab
