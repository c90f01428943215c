#!/usr/bin/env bash
# Makes what run_in_qemu.sh boots: Debian's kernel, and an initramfs with the drivers of a CAN card, of the V4L2 loopback device and of vivid, a V4L2
# camera that can be told to fail.
# Usage: make_qemu_guest.sh FOLDER
#
# Nothing is installed and root is not needed: the kernel and its headers are downloaded with apt-get and unpacked in FOLDER, and v4l2loopback is
# built there from Debian's v4l2loopback-source. Done once: a finished FOLDER is left alone. Exit status: 0, or 3 when something has to be installed.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
PATH=$PATH:/usr/sbin:/sbin
[ $# -eq 1 ] || { sed -n '2,/^set/s/^# \{0,1\}//p' "$0" >&2; exit 2; }
mkdir -p "$1"
cd "$1"

fingerprint=$(cat "$here/make_qemu_guest.sh" "$here/qemu_init.sh" | sha256sum)
[ "$(cat done 2>/dev/null)" != "$fingerprint" ] || exit 0

lacks() {
  echo "run_in_qemu: no $1" >&2
  exit 3
}
for need in busybox:busybox-static depmod:kmod bzip2:bzip2 make:build-essential gcc:build-essential; do
  command -v "${need%%:*}" >/dev/null || lacks "${need%%:*}: apt-get install ${need##*:}"
done
[ -e /usr/src/v4l2loopback.tar.bz2 ] || lacks "v4l2loopback: apt-get install v4l2loopback-source"

# depends PACKAGE PATTERN: the package that a meta-package stands for.
depends() { apt-cache depends "$1" | awk -v pattern="$2" '$1 == "Depends:" && $2 ~ pattern { print $2; exit }'; }

if [ ! -e unpacked ]; then
  image=$(depends linux-image-amd64 '^linux-image-[0-9]')
  headers=${image/image/headers}
  [ -n "$image" ] || lacks "list of packages: apt-get update"
  rm -rf debs root && mkdir debs root
  kbuild=$(depends "$headers" '^linux-kbuild')
  (cd debs && apt-get download -qq "$image" "$headers" "${headers%-amd64}-common" "$kbuild" 2>download.log) ||
    lacks "kernel to download ($(tail -n 1 debs/download.log)): apt-get update"
  for deb in debs/*.deb; do dpkg -x "$deb" root; done
  rm -rf debs
  touch unpacked
fi
version=$(basename root/lib/modules/*)

# The headers' makefiles name each other by absolute path.
headers=$PWD/root/usr/src/linux-headers-$version
sed -i "s|[^ ]*/usr/src/linux-headers|$PWD/root/usr/src/linux-headers|" "$headers/Makefile" "$headers/.kernelvariables"
rm -rf modules && tar -xjf /usr/src/v4l2loopback.tar.bz2
make -s -C "$headers" M="$PWD/modules/v4l2loopback" CC="$(command -v gcc-12 || command -v gcc)" modules >v4l2loopback.log 2>&1 ||
  { tail -n 5 v4l2loopback.log >&2; lacks "v4l2loopback for $version, see $PWD/v4l2loopback.log"; }
mkdir -p "root/lib/modules/$version/extra"
cp modules/v4l2loopback/v4l2loopback.ko "root/lib/modules/$version/extra/"
depmod -b root "$version"

rm -rf initramfs && mkdir -p initramfs/{bin,proc,sys,dev,root} "initramfs/lib/modules"
cp "$(command -v busybox)" initramfs/bin/busybox
cp "$here/qemu_init.sh" initramfs/init
for module in virtio_pci 9pnet_virtio 9p can-raw can-gw vcan vxcan sch_tbf kvaser_pci v4l2loopback vivid; do
  # In the order of insmod; each once.
  modprobe -d root -S "$version" --show-depends "$module" | awk '$1 == "insmod" { print $2 }'
done | awk '!seen[$0]++' | while read -r file; do
  cp "$file" initramfs/lib/modules/
  basename "$file"
done >initramfs/lib/modules/order
(cd initramfs && find . | busybox cpio -o -H newc 2>/dev/null | gzip -1) >initramfs.gz
cp "root/boot/vmlinuz-$version" vmlinuz
rm -rf initramfs modules root unpacked
echo "$fingerprint" >done
