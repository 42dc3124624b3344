#!/usr/bin/env bash
# Builds and runs the fuzzers of tests/fuzz (libFuzzer, clang):
#   tests/fuzz/run_fuzzer.sh --build        builds all
#   tests/fuzz/run_fuzzer.sh KIND [OPTION]  runs one for LAB_FUZZ_SECONDS (300), with libFuzzer's options
# What it learns stays in build/fuzz/corpus/KIND; a crash becomes a file in build/fuzz/findings.
set -euo pipefail
root=$(dirname "$(dirname "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")")")
build=$root/build/fuzz

if ! command -v clang++ >/dev/null; then
  echo "run_fuzzer.sh: found no clang++; install the packages clang and libclang-rt-dev" >&2
  [ -z "${LAB_TEST_NO_SKIP-}" ] && exit 77
  exit 1
fi
[ $# -ge 1 ] || { sed -n '2,5s/^# //p' "$0"; exit 2; }

if [ ! -e "$build/build.ninja" ]; then (cd "$root" && cmake --preset fuzz); fi
if [ "$1" = --build ]; then exec ninja -C "$build" fuzzers; fi
kind=$1
shift
ninja -C "$build" --quiet "fuzz_$kind"
mkdir -p "$build/corpus/$kind" "$build/findings"
seconds=${LAB_FUZZ_SECONDS:-300}
# libFuzzer looks at the time only after it has read the whole corpus, and between inputs: `timeout`
# bounds that, too.
options=(-max_total_time="$seconds" -timeout=10 -rss_limit_mb=1024
  -print_final_stats=1 -artifact_prefix="$build/findings/$kind-")
status=0
SECONDS=0
LCM_DEFAULT_URL=memq:// timeout --foreground --preserve-status --signal=INT --kill-after=30 \
  $((seconds + 60)) "$build/bin/fuzz_$kind" "${options[@]}" "$@" \
  "$build/corpus/$kind" "$root/tests/fuzz/corpus/$kind" || status=$?
interrupted=72
if [ "$status" -eq "$interrupted" ] && [ "$SECONDS" -ge "$seconds" ]; then status=0; fi
if [ "$status" -ne 0 ]; then
  echo "run_fuzzer.sh: mend the fault, then keep the input: mv build/fuzz/findings/$kind-... tests/fuzz/corpus/$kind/" >&2
  exit 1  # libFuzzer's 77 for a crash means "skipped" to CTest
fi
