#!/usr/bin/env bash
# Installs the Debian packages of toolchain/packages.txt that are missing, says what it does, and does nothing the second time.
# Usage: toolchain/setup.sh
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

if ! command -v dpkg-query >/dev/null; then
  echo "setup: this is no Debian machine. Install the equivalents of $here/packages.txt yourself; continuing." >&2
  exit 0
fi

missing=()
while read -r package; do
  [ -n "$package" ] || continue
  status=$(dpkg-query -W -f '${Status}' "$package" 2>/dev/null || true)
  [ "$status" = "install ok installed" ] || missing+=("$package")
done < <(sed 's/#.*//; s/[[:space:]]*$//' "$here/packages.txt")
[ ${#missing[@]} -gt 0 ] || exit 0

echo "setup: installing ${#missing[@]} missing Debian packages: ${missing[*]}"
as_root=()
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v sudo >/dev/null; then
    echo "setup: not root, and there is no sudo. As root, run: apt-get install --no-install-recommends ${missing[*]}" >&2
    exit 3
  fi
  echo "setup: apt-get needs root, so sudo may ask for your password now."
  as_root=(sudo)
fi
"${as_root[@]}" apt-get update -qq
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
echo "setup: done."
