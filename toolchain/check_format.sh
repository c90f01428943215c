#!/usr/bin/env bash
# Fails when a C++ file is not as clang-format would write it. `--fix` rewrites them.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
mode=(--dry-run --Werror)
[ "${1:-}" != "--fix" ] || mode=(-i)
git ls-files -z -- '*.cpp' '*.hpp' | xargs -0 -n 40 -P 2 clang-format "${mode[@]}"
echo "format: clean"
