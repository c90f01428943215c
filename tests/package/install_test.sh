#!/usr/bin/env bash
# Packs the build, installs the packages in a clean root, and uses them there. Usage: install_test.sh BUILD_DIR WORK_DIR
# Exit status 77 when this machine permits no new root.
set -euo pipefail
build=$1
work=$2
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

if [ "${3:-}" != inside ]; then
  user=()
  [ "$(id -u)" -eq 0 ] || user=(--map-root-user)
  unshare --mount "${user[@]}" true 2>/dev/null || { echo "skipped: no mount namespace permitted here (unshare --mount)"; exit 77; }
  exec unshare --mount "${user[@]}" "$0" "$build" "$work" inside
fi

rm -rf "$work"
mkdir -p "$work/debs" "$work/root"
cpack -G DEB --config "$build/CPackConfig.cmake" -B "$work/debs" >"$work/cpack.log" 2>&1 || { cat "$work/cpack.log"; exit 1; }
debs=("$work"/debs/*.deb)
for deb in "${debs[@]}"; do
  dpkg-deb -f "$deb" Package Version Architecture Depends Installed-Size
done
/usr/bin/python3 "$here/clean_root.py" "$work/root" "${debs[@]}"

root=$work/root
mount --rbind /dev "$root/dev"
mount --rbind /proc "$root/proc"
mount -t tmpfs tmpfs "$root/tmp"
in_root() { env -i PATH=/usr/sbin:/usr/bin HOME=/root LC_ALL=C.UTF-8 chroot "$root" "$@"; }
in_root ldconfig
dpkg --root="$root" -i "${debs[@]}"

echo "--- lanternfish"
in_root lanternfish version
in_root lanternfish doctor
in_root lanternfish scenarios
in_root lanternfish run buttons_only --seed 1 --set 'tasks=[press_buttons: {order: [left]}]' --out /tmp/run --json | tail -n 3
for file in result.json report.html cloud.pcd can0.log; do
  [ -s "$root/tmp/run/$file" ] || { echo "the run left no $file"; exit 1; }
done
gzip -t "$root"/usr/share/man/man?/lanternfish*.gz
if [ -e "$root/usr/bin/lanternfishd" ]; then
  echo "--- lanternfishd"
  in_root lanternfishd --help >/dev/null
  in_root lanternfishd --config /etc/lanternfish/vehicle.yaml --check
  in_root lanternfishd --config /usr/share/lanternfish/vehicle/vcan.yaml --check
  in_root getent passwd lanternfish
  for file in lib/systemd/system/lanternfishd.service lib/udev/rules.d/70-lanternfishd.rules; do
    [ -s "$root/usr/$file" ] || { echo "not installed: /usr/$file"; exit 1; }
  done
fi

echo "--- removal"
dpkg --root="$root" --purge lanternfishd lanternfish
left=$(find "$root/usr" "$root/etc" -path '*lanternfish*' -print)
[ -z "$left" ] || { echo "left behind: $left"; exit 1; }
echo "installed, used and removed"
umount -l "$root/tmp" "$root/proc" "$root/dev"
rm -rf "$root"
