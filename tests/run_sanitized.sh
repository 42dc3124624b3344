#!/usr/bin/env bash
# Builds the tests with sanitizers and runs them (CMakePresets.json):
#   tests/run_sanitized.sh asan|tsan [ARGUMENT OF CTEST...]
# A test that fails, or a report of any process, is a failure. The reports are in build/PRESET/reports.
set -euo pipefail
root=$(dirname "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")")
preset=${1-}
case $preset in
  asan | tsan) shift ;;
  *) sed -n '2,4s/^# //p' "$0" >&2; exit 2 ;;
esac
reports=$root/build/$preset/reports

cd "$root"
cmake --preset "$preset" >/dev/null
cmake --build --preset "$preset"
rm -rf "$reports"
mkdir -p "$reports"
export ASAN_OPTIONS="log_path=$reports/asan" TSAN_OPTIONS="log_path=$reports/tsan"
export UBSAN_OPTIONS="print_stacktrace=1" LAB_UBSAN_REPORTS="$reports"
status=0
# As in ./lab: -j counts quarter cores.
ctest --preset "$preset" --no-tests=error -j "$((4 * $(nproc) + 2))" "$@" || status=1
found=$(find "$reports" -type f | wc -l)
if [ "$found" -gt 0 ]; then
  echo "run_sanitized.sh: $found processes reported a fault; the first report of $reports:" >&2
  head -n 40 "$(find "$reports" -type f | sort | head -n 1)" >&2
  exit 1
fi
exit "$status"
