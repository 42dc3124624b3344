#!/bin/sh
# Compiles every source by itself, without unity builds and precompiled headers, and links nothing.
#   build_without_unity.sh SOURCE BUILD
set -eu
source=$1 build=$2
cmake -G Ninja -S "$source" -B "$build" -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG=-O0 \
  -DLAB_UNITY_BUILD=OFF -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON -DLAB_BENCHMARKS=OFF >/dev/null
objects=$(ninja -C "$build" -t targets all | sed -n 's/^\(.*\.cpp\.o\): .*/\1/p')
ninja -k 0 -C "$build" lcmtypes/all dds_gateway/all >/dev/null
printf '%s\n' "$objects" | xargs ninja -k 0 -C "$build"
rm -rf "$build"
