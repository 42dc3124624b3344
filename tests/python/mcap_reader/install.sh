#!/bin/sh
# Installs the packages of package-lock.json. 77: there is no npm, or no network.
#   install.sh FOLDER
cd "$1" || exit 1
if [ -d node_modules/@mcap/core ]; then exit 0; fi
if ! command -v npm >/dev/null || ! command -v node >/dev/null; then
  echo "skipped: node and npm are not installed; with them, MCAP is also read by the libraries of Foxglove"
  exit 77
fi
# The packages need none of their install scripts.
npm ci --ignore-scripts --no-audit --no-fund 2>&1 | tail -n 5
if [ -d node_modules/@mcap/core ]; then exit 0; fi
echo "skipped: npm cannot reach its registry"
exit 77
