#!/usr/bin/env bash
# Configures a preset. Usage: toolchain/configure.sh [--in CHECKOUT] PRESET [cmake arguments]
# A build folder remembers where it was made, and CMake refuses one of another place. In a checkout that was copied or moved it is configured anew.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
if [ "${1:-}" = --in ]; then
  cd "$2"
  shift 2
fi
preset=$1
shift
cache=build/$preset/CMakeCache.txt
fresh=()
if [ -e "$cache" ]; then
  made_in=$(sed -n 's/^CMAKE_HOME_DIRECTORY:INTERNAL=//p' "$cache")
  if [ ! "$made_in" -ef . ]; then
    echo "configure: build/$preset was made in $made_in: it is made anew here" >&2
    fresh=(--fresh)
    # What its commands wrote names that place, too.
    rm -rf "build/$preset/CMakeFiles" "build/$preset/build.ninja"
  fi
fi
exec cmake "${fresh[@]}" --preset "$preset" "$@"
