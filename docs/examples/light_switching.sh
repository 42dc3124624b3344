#!/bin/sh
# BP, ABP and RTP in turn by rising light, commanded from outside of a running lab.
#   sh docs/examples/light_switching.sh [SECONDS]       with ./lab as LAB, another one: LAB=...
set -eu
hold=${1:-30}
lab=${LAB:-./lab}
for light in 0.2 0.5 0.9; do
  "$lab" light "$light"
  sleep "$hold"
done
"$lab" light --release
