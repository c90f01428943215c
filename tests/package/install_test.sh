#!/usr/bin/env bash
# Packs the build, installs the packages in clean roots, and uses them there. Usage: install_test.sh BUILD_DIR WORK_DIR
# The daemon's package is installed without the simulator's, and upgraded while its service runs. Exit status 77 when this machine permits no new root.
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
mkdir -p "$work/debs"
cpack -G DEB --config "$build/CPackConfig.cmake" -B "$work/debs" >"$work/cpack.log" 2>&1 || { cat "$work/cpack.log"; exit 1; }
for deb in "$work"/debs/*.deb; do
  dpkg-deb -f "$deb" Package Version Architecture Depends Installed-Size
done
common=$(echo "$work"/debs/lanternfish-common_*.deb) desktop=$(echo "$work"/debs/lanternfish_*.deb) daemon=$(echo "$work"/debs/lanternfishd_*.deb)

# clean_root DEB...: $root, with what they depend on and nothing else, and the packages installed in it.
clean_root() {
  root=$work/root
  mkdir -p "$root"
  /usr/bin/python3 "$here/clean_root.py" "$root" "$@"
  mount --rbind /dev "$root/dev"
  mount --rbind /proc "$root/proc"
  mount -t tmpfs tmpfs "$root/tmp"
  in_root ldconfig
  dpkg --root="$root" -i "$@"
}
in_root() { env -i PATH=/usr/sbin:/usr/bin HOME=/root LC_ALL=C.UTF-8 chroot "$root" "$@"; }
# remove PACKAGE...: nothing of theirs is left, and the root is gone.
remove() {
  dpkg --root="$root" --purge "$@"
  local left
  # From within the root: a checkout in a folder named lanternfish is no leftover.
  left=$(cd "$root" && find usr etc -path '*lanternfish*' -print)
  [ -z "$left" ] || { echo "left behind: $left"; exit 1; }
  umount -l "$root/tmp" "$root/proc" "$root/dev"
  rm -rf "$root"
}

if [ -e "$daemon" ]; then
  echo "--- lanternfishd, without the simulator"
  clean_root "$common" "$daemon"
  for file in usr/bin/lanternfish 'usr/lib/*/libembree3.so*' 'usr/lib/*/libBulletDynamics*'; do
    [ -z "$(compgen -G "$root/$file")" ] || { echo "the daemon's package brings the simulator's $file"; exit 1; }
  done
  in_root lanternfishd --help >/dev/null
  # The files are valid; that this machine has no CAN interface is status 3.
  for file in /etc/lanternfish/vehicle.yaml /usr/share/lanternfish/vehicle/vcan.yaml; do
    in_root lanternfishd --config "$file" --check || [ $? = 3 ]
  done
  in_root getent passwd lanternfish
  for file in usr/share/man/man8/lanternfishd.8.gz usr/share/man/man5/lanternfish-vehicle.5.gz usr/share/man/man5/vehicle.yaml.5.gz \
              usr/share/lanternfish/vehicle/vehicle.schema.json usr/share/bash-completion/completions/lanternfishd usr/share/zsh/vendor-completions/_lanternfishd; do
    [ -s "$root/$file" ] || { echo "not installed: /$file"; exit 1; }
  done
  # Every page that the configuration and the units name is there.
  for page in $(grep -oh '[a-z-]*\.md' "$root/etc/lanternfish/vehicle.yaml" "$root"/usr/lib/systemd/system/lanternfish*.service | sort -u); do
    [ -s "$root/usr/share/doc/lanternfishd/$page" ] || { echo "the package names $page and has it not"; exit 1; }
  done
  in_root lanternfishd --config /etc/lanternfish/vehicle.yaml doctor --machine || [ $? = 3 ]
  in_root lanternfishd --print-config >"$work/printed.yaml"
  for file in usr/lib/systemd/system/lanternfishd.service usr/lib/systemd/system/lanternfish-can.service usr/lib/udev/rules.d/70-lanternfishd.rules \
              usr/lib/lanternfish/lanternfish-can etc/lanternfish/lanternfish-can.conf; do
    [ -s "$root/$file" ] || { echo "not installed: /$file"; exit 1; }
  done

  grep -q '^ExecStart=/usr/bin/lanternfishd ' "$root/usr/lib/systemd/system/lanternfishd.service" || { echo "the unit names another program than the package's"; exit 1; }

  echo "--- upgrade while the service runs"
  # A systemctl that writes down what it is told; the service is active.
  mkdir -p "$root/run/systemd/system"
  printf '#!/bin/sh\necho "$*" >>/run/told\n' >"$root/usr/bin/systemctl"
  chmod 755 "$root/usr/bin/systemctl"
  ln -sf /bin/true "$root/usr/bin/udevadm"
  dpkg --root="$root" -i "$daemon"
  told=$(tr '\n' ';' <"$root/run/told")
  [[ $told == *"stop lanternfishd.service"*"start lanternfishd.service"* ]] || { echo "an upgrade leaves the old program running: $told"; exit 1; }
  # It was not running: it is not started.
  printf '#!/bin/sh\necho "$*" >>/run/told\ncase "$*" in *is-active*) exit 3 ;; esac\n' >"$root/usr/bin/systemctl"
  rm "$root/run/told"
  dpkg --root="$root" -i "$daemon"
  ! grep -qE '(^| )(re)?start' "$root/run/told" || { echo "an upgrade starts a daemon that did not run"; cat "$root/run/told"; exit 1; }
  remove lanternfishd lanternfish-common
fi

echo "--- lanternfish"
clean_root "$common" "$desktop"
in_root lanternfish version
in_root lanternfish doctor
in_root lanternfish scenarios
in_root lanternfish run buttons_only --seed 1 --set 'tasks=[press_buttons: {order: [left]}]' --out /tmp/run --json | tail -n 3
for file in result.json report.html cloud.pcd can0.log; do
  [ -s "$root/tmp/run/$file" ] || { echo "the run left no $file"; exit 1; }
done
gzip -t "$root"/usr/share/man/man?/lanternfish*.gz
for file in bash-completion/completions/lanternfish zsh/vendor-completions/_lanternfish; do
  cmp "$root/usr/share/$file" <(in_root lanternfish completion "${file%%[-/]*}") || { echo "not what the program prints: /usr/share/$file"; exit 1; }
done
remove lanternfish lanternfish-common
echo "installed, used, upgraded and removed"
