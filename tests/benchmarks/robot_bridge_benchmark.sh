#!/usr/bin/env bash
# CPU of robot_bridge with 40 robots on pseudo terminals, which send telemetry at 20 Hz and their step log.
#   robot_bridge_benchmark.sh FOLDER_OF_PROGRAMS RESULT.csv
set -euo pipefail
programs=$1 result=$2
robots=40 seconds=30
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
url="udpm://239.255.76.67:7699?ttl=0"
ticks=$(getconf CLK_TCK)

{
  cat <<'TOML'
fileversion = 1
name = "farm"
duration_s = 60
program = "abp"
[robot]
status_rate_hz = 20
[programs.abp]
model = "abp"
v_cm_s = 3
epsilon_s = 0.5
eta_rad_s = 3
[[robots]]
id = 1
body = "wire"
TOML
  echo "count = $robots"
} >"$work/farm.toml"

"$programs/robot_bridge_farm" $robots "$work/ports" "$work/farm.toml" "$url" $((seconds + 8)) &
farm=$!
"$programs/robot_bridge" --experiment "$work/farm.toml" --lcm-url "$url" --ports "$work/ports" &
bridge=$!
cpu() { awk '{sub(/.*\) /, ""); print $12 + $13}' "/proc/$bridge/stat"; }
sleep 6 # until all robots are found and configured
before=$(cpu)
sleep $seconds
after=$(cpu)
wait $farm
kill $bridge
wait $bridge || true
mkdir -p "$(dirname "$result")"
percent=$(awk -v a="$before" -v b="$after" -v hz="$ticks" -v s=$seconds \
  'BEGIN {printf "%.1f", (b - a) * 100 / hz / s}')
{
  echo "what,value,unit"
  echo "robot_bridge: $robots robots at 20 Hz,$percent,% of one core"
} | tee "$result"
