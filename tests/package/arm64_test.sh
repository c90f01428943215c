#!/usr/bin/env bash
# Packs the arm64 build, unpacks the packages, and runs the program in them under qemu-user. Usage: arm64_test.sh WORK_DIR SYSROOT
set -euo pipefail
work=$1 sysroot=$2
rm -rf "$work"
"$(dirname "${BASH_SOURCE[0]}")/../../toolchain/aarch64/make_packages.sh" "$work/debs" >"$work.log" 2>&1 || { cat "$work.log"; exit 1; }
expect() { [[ $2 == *"$3"* ]] || { echo "$1: '$2', not '$3'"; exit 1; }; }
daemon=$(echo "$work"/debs/lanternfishd_*_arm64.deb)
expect architecture "$(dpkg-deb -f "$daemon" Architecture)" arm64
# By name: what Debian 12 calls what the program is linked with.
for package in libc6 libyaml-cpp0.7 libopencv-calib3d406 libpcl-segmentation1.13 iproute2; do
  expect "what it depends on" "$(dpkg-deb -f "$daemon" Depends)" "$package"
done
for deb in "$work"/debs/*.deb; do dpkg-deb -x "$deb" "$work/root"; done
export LANTERNFISH_SHARE=$work/root/usr/share/lanternfish
run() { qemu-aarch64 -L "$sysroot" "$work/root/usr/bin/lanternfishd" "$@"; }
expect version "$(run --version)" aarch64
# The file is valid; that this machine has no such CAN interface is status 3.
said=$(run --config "$LANTERNFISH_SHARE/vehicle/vcan.yaml" --check 2>&1) || [ $? = 3 ] || { echo "$said"; exit 1; }
expect check "$said" "vcan.yaml is valid"
