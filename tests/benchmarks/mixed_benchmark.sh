#!/usr/bin/env bash
# Ten minutes of 24 robots of three kinds in real time: 2 on chips, 6 on serial lines, 16 on the bus.
# Counts lost messages and the CPU of every process.
#   mixed_benchmark.sh FOLDER_OF_PROGRAMS EXPERIMENTS RESULT.csv [SECONDS]
set -euo pipefail
programs=$1 experiments=$2 result=$3 seconds=${4:-600}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export XDG_RUNTIME_DIR=$work
ticks=$(getconf CLK_TCK)

mkdir -p "$(dirname "$result")"
echo "what,value,unit" >"$result"
note() { echo "$1,$2,$3" | tee -a "$result"; }

"$programs/lab" run "$experiments/mixed_bodies.toml" --set duration_s="$seconds" \
  --set 'robots[0].count=2' --set 'robots[1].id=3' --set 'robots[1].count=6' \
  --set 'robots[2].id=9' --set 'robots[2].count=16' --out "$work/runs" >"$work/output" &
lab=$!
family() { echo "$1"; for child in $(pgrep -P "$1"); do family "$child"; done; }
sample() {
  for pid in $(family $lab); do
    awk -v pid="$pid" '{sub(/.*\) /, ""); print pid, $12 + $13}' "/proc/$pid/stat"
  done
}
sleep 10
sample >"$work/before"
sleep $((seconds - 15))
sample >"$work/after"
total=0
while read -r pid used; do
  name=$(tr -d '\0' <"/proc/$pid/comm")
  percent=$(awk -v pid="$pid" -v used="$used" -v hz="$ticks" -v s=$((seconds - 15)) \
    '$1 == pid {printf "%.1f", ($2 - used) * 100 / hz / s}' "$work/after")
  note "24 robots live: $name" "$percent" "% of one core"
  total=$(awk -v a="$total" -v b="$percent" 'BEGIN {print a + b}')
done <"$work/before"
note "24 robots live: all processes" "$total" "% of one core"
wait $lab
cat "$work/output" >&2
lost=$(grep -o '"lost": *[0-9]*' "$work"/runs/*/summary.json | awk '{n += $NF} END {print n}')
note "24 robots live: messages lost in $seconds s" "$lost" 1
[ "$lost" -eq 0 ]
