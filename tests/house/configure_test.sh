#!/usr/bin/env bash
# A checkout that was moved, and one that was copied, is configured anew in its own place, and uses its own files. Usage: configure_test.sh SOURCE_DIR
set -euo pipefail
configure=$1/toolchain/configure.sh
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/first"
cat >"$work/first/CMakePresets.json" <<'JSON'
{"version": 6, "configurePresets": [{"name": "release", "generator": "Ninja", "binaryDir": "${sourceDir}/build/${presetName}"}]}
JSON
cat >"$work/first/CMakeLists.txt" <<'CMAKE'
cmake_minimum_required(VERSION 3.25)
project(tiny LANGUAGES NONE)
add_custom_target(tell ALL COMMAND ${CMAKE_COMMAND} -E copy ${CMAKE_SOURCE_DIR}/text ${CMAKE_BINARY_DIR}/told)
CMAKE
told() { cmake --build "$1/build/release" >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }; cat "$1/build/release/told"; }
check() { [ "$2" = "$3" ] || { echo "$1: '$2', not '$3'"; exit 1; }; }

echo first >"$work/first/text"
"$configure" --in "$work/first" release >/dev/null
check "as it was made" "$(told "$work/first")" first

cp -r "$work/first" "$work/copy"
echo copy >"$work/copy/text"
said=$("$configure" --in "$work/copy" release 2>&1)
case $said in *"was made in $work/first: it is made anew here"*) ;; *) echo "says nothing of the other place: $said"; exit 1 ;; esac
check "the copy uses its own file" "$(told "$work/copy")" copy
check "and leaves the first's build alone" "$(told "$work/first")" first

mv "$work/copy" "$work/moved"
echo moved >"$work/moved/text"
"$configure" --in "$work/moved" release >/dev/null 2>&1
check "moved" "$(told "$work/moved")" moved

# Configured again where it was: nothing is made anew, by another name of the same folder neither.
ln -s moved "$work/link"
for place in moved link; do
  said=$("$configure" --in "$work/$place" release 2>&1)
  case $said in *anew*) echo "$place: made anew for nothing"; exit 1 ;; esac
done
echo "good"
