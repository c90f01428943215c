#!/usr/bin/env bash
# hostile_test.py for so many seconds a phase, with the programs of build/release. Usage: tests/qemu/hostile.sh SECONDS
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
out=build/release/guest_out/hostile
mkdir -p "$out"
exec toolchain/guests/run_in_qemu.sh --guest build/release/qemu_guest --out "$out" --time-limit 8800 \
  env LANTERNFISH_GUEST_OUT="$PWD/$out" python3 tests/qemu/hostile_test.py build/release/bin build/release/tests/nodes_on_can "$1"
