#!/bin/bash
# The installed units under a real systemd, as root of a guest (toolchain/guests/run_systemd_in_uml.sh): what they grant, what they deny, and what happens when
# the daemon is killed, hangs, or is asked to stop.
set -u
failed=0
check() {
  local what=$1
  shift
  if "$@"; then echo "ok      $what"; else echo "FAILED  $what"; failed=1; fi
}
denied() { ! "$@" >/tmp/denied 2>&1; }
# soon SECONDS COMMAND...: it succeeds within so long.
soon() {
  local end=$((SECONDS + $1))
  shift
  until "$@" >/dev/null 2>&1; do [ "$SECONDS" -lt "$end" ] || return 1; sleep 0.2; done
}
for module in /lib/modules/can/*.ko; do insmod "$module"; done
ip link add dev vcan0 type vcan
sed -i 's/^CAN_INTERFACE=.*/CAN_INTERFACE=vcan0/' /etc/lanternfish/lanternfish-can.conf
sed -i 's/interface: can0 .*/interface: vcan0/; s/source: device .*/source: none/; s/cpu: 1 .*/cpu: 0/' \
  /etc/lanternfish/vehicle.yaml
mkdir -p /var/lib/lanternfish
cp /homing.yaml /var/lib/lanternfish/homing.yaml
useradd --no-create-home --groups lanternfish pilot
useradd --no-create-home stranger
as() { setpriv --reuid "$1" --regid "$1" --init-groups "${@:2}"; }
ask() { lanternfishd "$1" --socket /run/lanternfishd/operator.sock; }
main_pid() { systemctl show --property=MainPID --value lanternfishd; }
new_pid() { local now; now=$(main_pid); [ "$now" != 0 ] && [ "$now" != "$pid" ] && systemctl --quiet is-active lanternfishd; }

check "the unit starts and says that it is ready" timeout 60 systemctl start lanternfishd
systemctl --no-pager --lines=20 status lanternfishd | sed 's/^/        /'
pid=$(main_pid)
if [ "$pid" = 0 ]; then
  journalctl --no-pager --lines=40
  exit 1
fi
check "it runs as the user lanternfish" test "$(stat -c %U "/proc/$pid")" = lanternfish
check "it is in the namespace lanternfish" test "$(stat -Lc %i "/proc/$pid/ns/net")" = "$(stat -c %i /run/netns/lanternfish)"
check "the bus is not in the machine's network" denied ip link show dev vcan0
check "a program outside cannot send on it" denied cansend vcan0 201#0F00000000000000
check "it can gain no privileges" grep -q 'NoNewPrivs:\s*1' "/proc/$pid/status"
check "its system calls are filtered" grep -q 'Seccomp:\s*2' "/proc/$pid/status"
# CAP_NET_ADMIN 12, CAP_IPC_LOCK 14, CAP_SYS_NICE 23.
check "it has three capabilities" grep -q 'CapEff:\s*0000000000805000' "/proc/$pid/status"
check "no more can be added" grep -q 'CapBnd:\s*0000000000805000' "/proc/$pid/status"
check "its memory is locked" test "$(awk '/VmLck/ { print $2 }' "/proc/$pid/status")" -gt 1000
check "a thread of it is SCHED_FIFO" grep -qE '^(1|2)$' <(for task in "/proc/$pid"/task/*; do awk '{ print $41 }' "$task/stat"; done)
check "it can write nowhere but in its folders" denied nsenter -t "$pid" -m touch /etc/written /usr/written /home/written
check "the runtime folder is its group's" test "$(stat -c '%U:%G %a' /run/lanternfishd)" = "lanternfish:lanternfish 750"
check "the log is not everybody's" test "$(stat -c '%U %a' /var/log/lanternfishd)" = "lanternfish 750"
check "a user of the group sees the status" as pilot lanternfishd status --socket /run/lanternfishd/operator.sock
check "and may press the emergency stop" as pilot lanternfishd estop --socket /run/lanternfishd/operator.sock
check "a stranger does not reach the socket" denied as stranger lanternfishd status --socket /run/lanternfishd/operator.sock
check "a stranger cannot read the log" denied as stranger cat /var/log/lanternfishd/log.jsonl
check "a stranger cannot enter the namespace" denied as stranger nsenter --net=/run/netns/lanternfish true

kill -KILL "$pid"
check "killed, it is started again" soon 20 new_pid
check "and answers" soon 20 ask status
pid=$(main_pid)
kill -STOP "$pid"
check "hanging, it is ended by the watchdog and started again" soon 30 new_pid
check "and answers" soon 20 ask status

check "it stops when it is asked to" timeout 30 systemctl stop lanternfishd
check "in order" test "$(systemctl show --property=Result --value lanternfishd)" = success
check "and takes its runtime folder away" test ! -e /run/lanternfishd
systemctl stop lanternfish-can
check "and its namespace" test ! -e /run/netns/lanternfish
rm /var/lib/lanternfish/homing.yaml /etc/lanternfish/vehicle.yaml
systemctl start lanternfishd >/dev/null 2>&1
sleep 5
check "without a configuration it fails once, and is not started for ever" test "$(systemctl show --property=NRestarts --value lanternfishd)" -le 2
exit $failed
