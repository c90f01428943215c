#!/usr/bin/env bash
# Runs clang-tidy over the sources changed since a base (default: the last commit's parent), or over all with `--all`.
# Needs a configured build/release for the compile commands.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
if [ "${1:-}" = "--all" ]; then
  files=$(git ls-files -- 'firmware/*.cpp' 'hal/*.cpp' 'host_sim/*.cpp' 'shared/*.cpp')
else
  base=${1:-$(git rev-parse --verify -q HEAD~1 || git hash-object -t tree /dev/null)}
  files=$(git diff --name-only --diff-filter=d "$base" -- 'firmware/*.cpp' 'hal/*.cpp' 'host_sim/*.cpp' 'shared/*.cpp')
fi
if [ -z "$files" ]; then
  echo "lint: no source changed"
  exit 0
fi
# Generated headers have to be there before a file that includes them can be read.
cmake --build build/release --target lf_arm_geometry_header lf_can_map_files >/dev/null
# Clang cannot read GCC's precompiled headers: it gets the same commands without them.
mkdir -p build/release/lint
sed -E 's/-Winvalid-pch//g; s/-fpch-preprocess//g; s/-include [^ ]*cmake_pch\.hxx//g' build/release/compile_commands.json >build/release/lint/compile_commands.json
echo "$files" | xargs -n 1 -P 2 clang-tidy --quiet -p build/release/lint --extra-arg=-Wno-unknown-warning-option
echo "lint: clean"
