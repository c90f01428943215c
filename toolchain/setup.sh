#!/usr/bin/env bash
# Installs the Debian packages of toolchain/packages.txt that are missing, says what it does, and does nothing the second time.
# Usage: toolchain/setup.sh [--tests] [--browser] [--aarch64]
#   --tests    those of packages_tests.txt, too; without one of these its tests are skipped
#   --browser  those of packages_browser.txt, too; the same
#   --aarch64  those of packages_aarch64.txt, too
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

if ! command -v dpkg-query >/dev/null; then
  echo "setup: this is no Debian machine. Install the equivalents of $here/packages.txt yourself; continuing." >&2
  exit 0
fi

# missing_of LIST: its packages that are not installed.
missing_of() {
  local package status
  while read -r package; do
    [ -n "$package" ] || continue
    status=$(dpkg-query -W -f '${Status}' "$package" 2>/dev/null || true)
    [ "$status" = "install ok installed" ] || echo "$package"
  done < <(sed 's/#.*//; s/[[:space:]]*$//' "$1")
}

# install PACKAGE...: 3 when that cannot be asked for.
install() {
  echo "setup: installing $# missing Debian packages: $*"
  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null; then
      echo "setup: not root, and there is no sudo. As root, run: apt-get install --no-install-recommends $*" >&2
      return 3
    fi
    echo "setup: apt-get needs root, so sudo may ask for your password now."
    as_root=(sudo)
  fi
  "${as_root[@]}" apt-get update -qq &&
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "$@" >/dev/null || return
  echo "setup: done."
}

mapfile -t missing < <(missing_of "$here/packages.txt")
[ ${#missing[@]} -eq 0 ] || install "${missing[@]}"
for word in "$@"; do
  case $word in
    --tests)
      mapfile -t missing < <(missing_of "$here/packages_tests.txt")
      [ ${#missing[@]} -eq 0 ] || install "${missing[@]}" || echo "setup: without them, the tests that need them are skipped." >&2
      ;;
    --browser)
      mapfile -t missing < <(missing_of "$here/packages_browser.txt")
      [ ${#missing[@]} -eq 0 ] || install "${missing[@]}" || echo "setup: without them, the tests that need them are skipped." >&2
      ;;
    --aarch64)
      mapfile -t missing < <(missing_of "$here/packages_aarch64.txt")
      [ ${#missing[@]} -eq 0 ] || install "${missing[@]}"
      ;;
    *)
      sed -n 's/^# Usage: /usage: /p' "$0" >&2
      exit 2
      ;;
  esac
done
