#!/usr/bin/env bash
# The daemon's packages in a root with systemd, booted in User Mode Linux. Usage: systemd_test.sh BUILD_DIR WORK_DIR GUESTS PRELOAD
# Exit status 77 where that cannot be; there it is a failure when CI=true.
set -euo pipefail
build=$1 work=$2 guests=$3 preload=$4
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
if [ "${5:-}" != inside ]; then
  user=()
  [ "$(id -u)" -eq 0 ] || user=(--map-root-user)
  unshare --mount "${user[@]}" true 2>/dev/null || { echo "skipped: no mount namespace permitted here (unshare --mount)"; exit 77; }
  exec unshare --mount "${user[@]}" "$0" "$build" "$work" "$guests" "$preload" inside
fi
rm -rf "$work"
mkdir -p "$work/debs"
cpack -G DEB --config "$build/CPackConfig.cmake" -D CPACK_COMPONENTS_ALL="lanternfish-common;lanternfishd" -B "$work/debs" >"$work/cpack.log" 2>&1 ||
  { cat "$work/cpack.log"; exit 1; }
root=$work/root
with=()
for package in systemd systemd-sysv iproute2 can-utils kmod util-linux; do with+=(--with "$package"); done
/usr/bin/python3 "$here/clean_root.py" "$root" "${with[@]}" "$work"/debs/*.deb
env -i PATH=/usr/sbin:/usr/bin chroot "$root" ldconfig
dpkg --root="$root" -i "$work"/debs/*.deb
cp "$here/systemd_in_guest.sh" "$root/test"
for joint in slew shoulder elbow roll jaw; do echo "$joint: {zero_counts: 0, found: \"in a test\"}"; done >"$root/homing.yaml"
status=0
"$guests/run_systemd_in_uml.sh" --root "$root" --time-limit 400 --preload "$preload" /test || status=$?
rm -rf "$root"
if [ "$status" -eq 3 ]; then
  [ "${CI:-}" != true ] || exit 1
  echo "skipped: no guest on this machine"
  exit 77
fi
exit "$status"
