#!/usr/bin/env bash
# Installs what is missing, builds everything and runs every test.
# Usage: ./test.sh [PRESET [ctest arguments]]    PRESET: release (default), debug, asan, tsan; aarch64: the vehicle's side for 64-bit ARM, its unit tests under qemu-user
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
preset=${1:-release}
[ $# -eq 0 ] || shift
if [ "$preset" = aarch64 ]; then
  toolchain/setup.sh --aarch64
  toolchain/aarch64/make_sysroot.sh build/aarch64-sysroot
else
  toolchain/setup.sh --tests
fi
cmake --preset "$preset"
cmake --build --preset "$preset" -- --quiet
exec ctest --preset "$preset" "$@"
