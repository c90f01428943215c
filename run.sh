#!/usr/bin/env bash
# Installs what is missing, builds, and runs the default mission in simulation. Arguments go to `lanternfish run`.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
toolchain/setup.sh
toolchain/configure.sh release >build-configure.log 2>&1 || { cat build-configure.log >&2; exit 3; }
rm -f build-configure.log
echo "run: building (the first time takes some minutes) ..."
cmake --build --preset release --target lanternfish -- --quiet
exec build/release/bin/lanternfish run "$@"
