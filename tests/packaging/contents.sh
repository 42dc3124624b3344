#!/usr/bin/env bash
# What is in the Debian packages: every file that should be, nothing else, nobody's paths; and what
# they bring works from wherever it was unpacked.
#   contents.sh FOLDER_OF_PACKAGES SOURCE BUILD
set -euo pipefail
packages=$1 source=$2 build=$3
here=$(dirname "$(readlink -f "$0")")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0
fail() {
  echo "FAILED: $*"
  failed=1
}
expect() {  # what, text, pattern that it contains
  grep -qE -- "$3" <<<"$2" || fail "$1: found \"$2\", expected a match of $3"
}

version=$(sed -n 's/.*kVersion = "\(.*\)".*/\1/p' "$source/common/process/version.hpp")
architecture=$(dpkg --print-architecture)
cd "$work"

for name in active-lab active-lab-gateway active-lab-emulator python3-active-lab; do
  deb=$packages/${name}_${version}_$architecture.deb
  [ -e "$deb" ] || { [[ $name =~ emulator|python3 ]] && continue; fail "$deb is not there"; exit 1; }
  mkdir -p "$name"
  dpkg-deb -x "$deb" "$name"

  # Files: of expected_files.txt, and the texts of the source.
  {
    sed -n "s#^$name ##p" "$here/expected_files.txt"
    if [ $name = active-lab ]; then
      (cd "$source" && find experiments programs -type f -printf '0644 usr/share/active-lab/%p\n')
      (cd "$source" && find docs -type f -perm /100 -printf '0755 usr/share/doc/active-lab/%p\n')
      (cd "$source" && find docs -type f ! -perm /100 -printf '0644 usr/share/doc/active-lab/%p\n')
    fi
    if [ $name = python3-active-lab ]; then
      (cd "$source/python" && find examples -type f -printf '0644 usr/share/doc/python3-active-lab/%p\n')
    fi
  } | sort -k 2 >expected
  (cd "$name" && find . ! -type d -printf '%04m %P\n') | sed 's/^0777 usr.bin/link usr\/bin/; s/_core\.cpython-[0-9]*-.*\.so$/_core.so/' |
    sort -k 2 >found
  # What is built where its libraries are there may be absent elsewhere.
  sed -n 's/^?//p' expected | while read -r line; do
    grep -qxF "$line" found || sed -i "\#^?$line\$#d" expected
  done
  sed -i 's/^?//' expected
  diff <(sort -k 2 expected) found >difference ||
    fail "$name: <: expected and not there, >: there and not expected: $(cat difference)"

  # Rights.
  dpkg-deb -c "$deb" | awk '$2 != "root/root"' >owners
  [ ! -s owners ] || fail "$name: not root's: $(cat owners)"
  (cd "$name" && find . -type d ! -perm 0755) >folders
  [ ! -s folders ] || fail "$name: folders that are not 0755: $(cat folders)"

  # Nobody's machine.
  for path in "$source" "$build"; do
    grep -rlaF "$path" "$name" >paths || true
    [ ! -s paths ] || fail "$name: the path $path is in $(cat paths)"
  done
  for program in "$name"/usr/lib/active-lab/bin/* "$name"/usr/lib/python3/dist-packages/active_lab/*.so; do
    [ -e "$program" ] || continue
    case $(LC_ALL=C file -b "$program") in *not\ stripped*AVR* | *Atmel*) continue ;;
      *not\ stripped*) fail "$program is not stripped" ;; esac
    ! LC_ALL=C objdump -p "$program" 2>/dev/null | grep -qE 'RPATH|RUNPATH|gtest|gmock' ||
      fail "$program has a RUNPATH or needs a test library"
  done

  expect "$name: Version" "$(dpkg-deb -f "$deb" Version)" "^$version\$"
  depends=$(dpkg-deb -f "$deb" Depends)
  expect "$name: Depends" "$depends" 'libc6'
  if [ $name = active-lab ]; then
    for needed in liblcm1 gnuplot-nox libqpdf libsdl2; do
      expect "$name: Depends" "$depends" "$needed"
    done
    expect "$name: Recommends" "$(dpkg-deb -f "$deb" Recommends)" liblcm-bin
    ! grep -q simavr <<<"$depends" || fail "$name: depends on the GPL's libsimavr"
  elif [ $name = python3-active-lab ]; then
    for needed in 'python3 \(>= 3\.' 'python3 \(<< 3\.' python3-numpy python3-pandas; do
      expect "$name: Depends" "$depends" "$needed"
    done
    ! grep -qE '(^|, )active-lab' <<<"$depends" || fail "$name: needs a lab to read a run"
  else
    expect "$name: Depends" "$depends" "active-lab \(= $version\)"
  fi
  if [ $name = active-lab-emulator ]; then
    expect "$name: Depends" "$depends" libsimavr
    expect "$name: licence" "$(cat $name/usr/share/doc/$name/copyright)" common-licenses/GPL-3
  fi
  for page in "$name"/usr/share/man/man1/*.gz; do
    [ -e "$page" ] || continue
    expect "$page" "$(zcat "$page")" "^\.TH .*Active Lab $version"
  done
done

# No text tells a package's user to type what is in a clone alone.
grep -rnE "\./lab\b" active-lab/usr/share/active-lab active-lab/usr/share/doc | grep -vE "\./lab (test|package|build)" >clones || true
[ ! -s clones ] || fail "./lab in $(cat clones)"

# The command, from where it lies: what is shipped, and what only other packages bring.
lab=$work/active-lab/usr/bin/active-lab
mkdir -p "$work/home"
cd "$work/home"
facts=$("$lab" --version)
expect "--version" "$facts" "^Active Lab $version"
expect "--version" "$facts" "^contract +[0-9]+"
expect "--version" "$facts" "^compiler +[A-Z]"
expect "--help" "$("$lab" --help)" '^Usage: active-lab '
expect "check NAME" "$("$lab" check light_switching)" 'light_switching'
expect "a run by name" "$("$lab" run light_switching --virtual-time --no-report --set duration_s=3)" '^run '
[ -e runs/light_switching-*/log.lcmlog ] || fail "no log of the run in $(find . | head -n 20)"
refused() {  # pattern, arguments: exit code 2, and its text
  local said code=0
  said=$("$lab" "${@:2}" 2>&1) || code=$?
  [ "$code" -eq 2 ] || fail "$* ended with $code, expected 2"
  expect "${*:2}" "$said" "$1"
}
refused 'looked for .*no_such.*light_switching' run no_such
refused 'dds_gateway.*active-lab-gateway_' run ros2
refused 'robot_emulator.*active-lab-emulator_' run mixed_bodies --virtual-time
refused 'clone of the source' test --long
refused 'clone of the source' package

# The Python package, from where it lies.
python=$work/python3-active-lab/usr/lib/python3/dist-packages
if [ -e "$python" ] && /usr/bin/python3 -c 'import numpy, pandas' 2>/dev/null; then
  expect "active_lab" "$(PYTHONPATH=$python /usr/bin/python3 -c '
import active_lab, glob
run = active_lab.open(glob.glob("runs/*")[0])
print(active_lab.__version__, len(run.poses) > 100)')" "^$version True\$"
fi

# Completion, in a shell of its own.
complete_line() {  # words...: what is offered for the last one
  PATH=$work/active-lab/usr/bin:$PATH bash --norc -c '
    compopt() { :; }
    . "$1"
    shift
    COMP_WORDS=("$@") COMP_CWORD=$(($# - 1))
    _active_lab
    printf "%s\n" "${COMPREPLY[@]}"' completion \
    "$work/active-lab/usr/share/bash-completion/completions/active-lab" "$@"
}
expect 'TAB after "active-lab"' "$(complete_line active-lab re)" '^replay$'
expect 'TAB after "run li"' "$(complete_line active-lab run light_s)" '^light_switching$'
expect 'TAB after "run x --v"' "$(complete_line active-lab run x --v)" '^--virtual-time$'
expect 'TAB after "calibrate"' "$(complete_line active-lab calibrate cam)" '^camera$'
expect 'TAB after "calibrate camera --bo"' "$(complete_line active-lab calibrate camera --bo)" '^--board$'
[ "$(complete_line active-lab run --nosuch)" = "" ] || fail "an option that nobody has is completed"

if command -v desktop-file-validate >/dev/null; then
  desktop-file-validate "$work"/active-lab/usr/share/applications/*.desktop || fail "desktop entry"
fi
[ $failed -ne 0 ] || echo "every file, right and text of $(ls "$packages"/*.deb | wc -l) packages as expected"
exit $failed
