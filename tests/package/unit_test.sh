#!/bin/sh
# The daemon's systemd unit, with the daemon where it was built: unit_test.sh SYSTEMD_ANALYZE UNIT LANTERNFISHD WORK_DIR
# Every directive is known and makes sense, and what the daemon needs is not taken from it again.
set -eu
mkdir -p "$4"
unit=$4/lanternfishd.service
sed "s#^ExecStart=[^ ]*#ExecStart=$3#" "$2" >"$unit"
grep -q "^ExecStart=$3 --config /etc/lanternfish/vehicle.yaml$" "$unit"
said=$("$1" verify --man=no "$unit" 2>&1) || { echo "$said"; exit 1; }
if echo "$said" | grep lanternfishd; then exit 1; fi

needs() {
  grep -qE "^$1" "$unit" || { echo "the unit lacks $1: $2"; exit 1; }
}
needs_no() {
  if grep -E "^$1" "$unit"; then echo "the unit must not have it: $2"; exit 1; fi
}
for capability in CAP_SYS_NICE CAP_IPC_LOCK CAP_NET_ADMIN; do
  needs "AmbientCapabilities=.*$capability" "SCHED_FIFO, locked memory, a CAN controller's restart"
  needs "CapabilityBoundingSet=.*$capability" "the same"
done
needs "LimitMEMLOCK=infinity" "mlockall"
needs "LimitRTPRIO=9" "priority 80 and above"
needs "RuntimeDirectory=lanternfishd$" "the operator's socket"
needs "LogsDirectory=lanternfishd$" "can0.log, log.jsonl"
needs "ReadWritePaths=.*/run/lock" "the instance lock"
needs "RestrictAddressFamilies=.*AF_CAN" "the bus"
needs "DeviceAllow=char-video4linux rw" "the camera"
needs "SupplementaryGroups=.*video" "the camera"
needs_no "(RestrictRealtime|PrivateDevices|PrivateUsers|PrivateNetwork)=(yes|true|1|on)" "SCHED_FIFO, the camera, capabilities, the bus"
echo "sound"
