#!/usr/bin/env bash
# Configures and builds the programs for the Cortex-M7. Usage: build_m7.sh SOURCE_DIR BUILD_DIR TARGET
set -euo pipefail
[ -f "$2/build.ninja" ] || cmake -S "$1" -B "$2" -G Ninja --toolchain "$1/toolchain/cortex_m7.cmake" -DCMAKE_BUILD_TYPE=Release
exec cmake --build "$2" --target "$3" -- -j2
