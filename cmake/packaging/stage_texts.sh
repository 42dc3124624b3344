#!/bin/sh
# Copies the texts of a package and replaces `./lab` by `active-lab`, except in the three commands that only
# a clone has.
#   stage_texts.sh SOURCE FOLDER
set -eu
source=$1 folder=$2
rm -rf "$folder"
mkdir -p "$folder"
cp -r --no-preserve=ownership,timestamps "$source/experiments" "$source/programs" \
  "$source/docs" "$source/CHANGELOG.md" "$folder"
find "$folder" -type d -exec chmod 755 {} +
find "$folder" -type f -exec chmod u=rwX,go=rX {} +
find "$folder" -type f \( -name '*.md' -o -name '*.toml' -o -name '*.sh' -o -name '*.py' \) \
  -exec sed -E -i -e '/^<!-- test:/d' \
  -e 's#\./lab (test|package|build)\b#@clone@ \1#g' \
  -e 's#\./lab ([a-z]+( [a-z]+)?) experiments/([a-z_0-9]+)\.toml#active-lab \1 \3#g' \
  -e 's#\./lab\b#active-lab#g' -e 's#@clone@#./lab#g' {} +
