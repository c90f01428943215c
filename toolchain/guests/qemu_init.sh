#!/bin/busybox sh
# The first process of the guest that run_in_qemu.sh starts: modules, can0 and can1 on one bus, the machine's files over 9p, the command, power off.
busybox=/bin/busybox
$busybox mount -t proc proc /proc
$busybox mount -t sysfs sys /sys
$busybox mount -t devtmpfs dev /dev
while read -r module; do
  case $module in
    v4l2loopback.ko) options="video_nr=0,1 exclusive_caps=0,0" ;;
    vivid.ko) continue ;;  # a test's own to load
    *) options= ;;
  esac
  # shellcheck disable=SC2086  # options are words
  $busybox insmod "/lib/modules/$module" $options || echo "qemu_init: no module $module"
done </lib/modules/order

mount_host="$busybox mount -t 9p -o trans=virtio,version=9p2000.L,msize=262144,cache=loose"
$mount_host,ro hostroot /root
for folder in proc sys dev; do $busybox mount -o move "/$folder" "/root/$folder"; done
for folder in tmp var/tmp run dev/shm; do
  $busybox mkdir -p "/root/$folder"
  $busybox mount -t tmpfs -o mode=1777 tmpfs "/root/$folder"
done
$busybox mkdir -p /root/run/lanternfish_guest /root/run/modules
$busybox cp /lib/modules/vivid.ko /root/run/modules/
$mount_host private /root/run/lanternfish_guest

exec $busybox chroot /root /bin/bash /run/lanternfish_guest/start
