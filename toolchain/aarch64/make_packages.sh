#!/usr/bin/env bash
# Packs the vehicle's program for arm64, of what `./test.sh aarch64` has built: lanternfish-common and lanternfishd.
# Usage: toolchain/aarch64/make_packages.sh FOLDER     the packages are left there
set -euo pipefail
[ $# -eq 1 ] || { sed -n 's/^# Usage: /usage: /p' "$0" >&2; exit 2; }
mkdir -p "$1"
out=$(cd "$1" && pwd)
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
build=build/aarch64 sysroot=build/aarch64-sysroot
[ -x "$build/bin/lanternfishd" ] || { echo "make_packages: no $build/bin/lanternfishd: \`./test.sh aarch64\` builds it" >&2; exit 1; }

# dpkg-shlibdeps knows this machine's packages only: the sysroot's say for themselves what a program needs of them.
packages=()
while read -r library; do
  name=${library%%.so*} version=${library##*.so.}
  package=$(awk -v name="$name" -v version="$version" '$1 == name && $2 == version {$1 = $2 = ""; sub(/^ +/, ""); print; exit}' "$sysroot/shlibs")
  [ -n "$package" ] || { echo "make_packages: no package of the sysroot has $library" >&2; exit 1; }
  packages+=("$package")
done < <(readelf -d "$build/bin/lanternfishd" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p' | grep -v '^ld-linux')
libraries=$(printf '%s\n' "${packages[@]}" | sort -u | paste -sd, | sed 's/,/, /g')
stated=$(sed -n 's/^set(CPACK_DEBIAN_LANTERNFISHD_PACKAGE_DEPENDS "\(.*\)")$/\1/p' "$build/CPackConfig.cmake")
cpack -G DEB --config "$build/CPackConfig.cmake" -B "$out" -D CPACK_DEBIAN_LANTERNFISHD_PACKAGE_DEPENDS="$stated, $libraries"
rm -rf "$out/_CPack_Packages"
