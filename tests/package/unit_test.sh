#!/bin/sh
# The daemon's systemd units, with the programs where they were built: unit_test.sh SYSTEMD_ANALYZE UNIT_FOLDER LANTERNFISHD SERVICE_FOLDER WORK_DIR
# Every directive is known and makes sense, what the daemon needs is not taken from it again, and its exposure stays under a threshold.
set -eu
analyze=$1 units=$2 daemon=$3 service=$4 work=$5

# systemd's sum of what a service could do, 0 to 10. 1.8 is what is left: real time, locked memory, the camera, the CAN controller's restart, the operator's
# socket; and 0.5 for a network that offline analysis takes for the machine's, though NetworkNamespacePath is set (systemd 252, 2026-11-22).
threshold=19

mkdir -p "$work"
unit=$work/lanternfishd.service
sed "s#^ExecStart=[^ ]*#ExecStart=$daemon#" "$units/lanternfishd.service" >"$unit"
sed "s#=[^ ]*/lanternfish-can #=$service/lanternfish-can #" "$units/lanternfish-can.service" >"$work/lanternfish-can.service"
grep -q "^ExecStart=$daemon --config /etc/lanternfish/vehicle.yaml$" "$unit"
said=$("$analyze" verify --man=no "$unit" "$work/lanternfish-can.service" 2>&1) || { echo "$said"; exit 1; }
if echo "$said" | grep lanternfish; then exit 1; fi
"$analyze" security --offline=true --no-pager --threshold=$threshold "$unit" >"$work/security.txt" || { cat "$work/security.txt"; exit 1; }
tail -n 1 "$work/security.txt"

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
needs "RuntimeDirectory=lanternfishd$" "the operator's socket, the lock"
needs "RuntimeDirectoryMode=0750$" "the socket is its group's"
needs "LogsDirectory=lanternfishd$" "can0.log, log.jsonl"
needs "NetworkNamespacePath=/run/netns/lanternfish$" "no other program reaches the bus"
needs "Requires=lanternfish-can.service$" "that network"
needs "RestrictAddressFamilies=.*AF_CAN" "the bus"
needs "DeviceAllow=char-video4linux rw" "the camera"
needs "SupplementaryGroups=.*video" "the camera"
needs_no "(RestrictRealtime|PrivateDevices|PrivateUsers|PrivateNetwork)=(yes|true|1|on)" "SCHED_FIFO, the camera, capabilities, the bus"
echo "good"
