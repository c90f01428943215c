# Run by the guest's root after qemu_init.sh: the folders to write, the CAN interfaces, the command, power off.
export PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin
private=/run/lanternfish_guest
: >"$private/booted"
ln -sf /proc/self/fd /dev/fd
mkdir -p /dev/pts && mount -t devpts devpts /dev/pts
# shellcheck source=/dev/null
source "$private/settings"

# machine_folder TAG FOLDER MODE: the machine's FOLDER, even where a tmpfs hides it.
machine_folder() {
  mkdir -p "$2"
  mount -t 9p -o "trans=virtio,version=9p2000.L,msize=262144,cache=loose,$3" "$1" "$2"
}
[ -e "$project" ] || machine_folder project "$project" ro
for i in "${!out[@]}"; do machine_folder "out$i" "${out[$i]}" rw; done

ip link set lo up
for interface in can0 can1; do
  ip link set "$interface" txqueuelen 1000
  ip link set "$interface" up type can bitrate 1000000
done

cd "$here" || cd /
"${command[@]}" </dev/null >/tmp/.stdout 2>/tmp/.stderr
status=$?
cp /tmp/.stdout "$private/stdout"
cp /tmp/.stderr "$private/stderr"
echo "$status" >"$private/status"
sync
/bin/busybox poweroff -f
