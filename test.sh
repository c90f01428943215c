#!/usr/bin/env bash
# Installs what is missing, builds everything and runs every test.
# Usage: ./test.sh [PRESET [ctest arguments]]    PRESET: release (default), debug, asan, tsan
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
preset=${1:-release}
[ $# -eq 0 ] || shift
toolchain/setup.sh --tests
cmake --preset "$preset"
cmake --build --preset "$preset" -- --quiet
exec ctest --preset "$preset" "$@"
