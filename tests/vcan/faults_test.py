#!/usr/bin/env python3
"""What happens on a real CAN stack when something breaks while the arm moves: the reaction, its time, and that it is counted and named.

Usage: faults_test.py FOLDER_OF_PROGRAMS [FAULT]...; inside a guest (lanternfish_guest_test). Prints a table: docs/vehicle.md has one.

The daemon is on vcan0 and the drives on vcan1, joined by can-gw. Times are taken on the drives' side by a listener of its own: from the fault to the first
drive that is not under the master's command any more, and to the last drive's standstill. Where the master is gone, the listener asks the drives
over SDO.
"""
import signal
import struct
import subprocess
import sys
import time

import bus_watch
import rig
from rig import expect, expect_in_time, shell

# What the drives and the core are set to (shared/can/can_map.yaml, docs/canopen.md), and what a guest with one processor may add.
HEARTBEAT_TIMEOUT_S = 0.3
STALE_S = 0.012
GUEST_S = 0.06
# From the reaction to standstill: the drives' quick-stop ramp from deploy's speed and the swing on their compliance took 0.22 to 0.55 s (2026-11-21).
RAMP_S = 0.8

ROWS = []


class Trial:
    """A daemon that has just set the arm moving."""

    def __init__(self, programs, apart=None):
        self.bench = rig.Rig(programs, gateway=True, camera=False)
        if apart:
            self.bench.join(apart)
        self.daemon = self.bench.daemon()
        self.daemon.wait_ready()
        self.daemon.order("start")
        rig.wait_for("a moving arm", self.moving, 10, daemon=self.daemon)
        self.bench.settle(0.3)
        self.goes_on("before the fault")
        expect(self.moving(), "the arm does not move")

    def goes_on(self, when):
        """Nothing has stopped the mission."""
        self.bench.watch.poll()
        rig.expect_not_stopped(self.daemon.status(), self.bench.watch.longest_gap_s(), when)

    def moving(self):
        self.bench.watch.poll()
        return self.bench.watch.moves()

    def listen(self, seconds, ask=False):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            for index in (0x6041, 0x6064):
                if ask:
                    self.bench.watch.ask(index)
                time.sleep(0.005)
                self.bench.watch.poll()

    def judge(self, name, since, reaction_s, counted, fault, nodes=bus_watch.DRIVES):
        """The arm is stopped, by `nodes` first, and status and log name the fault: a function. How soon: time."""
        watch = self.bench.watch
        first, last = watch.left_operation(since, nodes)
        expect(last is not None, f"{name}: not every drive was stopped")
        still = watch.stood_still(since)
        expect(not watch.moves(), f"{name}: the arm still moves")
        expect_in_time(f"{name}: reaction", first - since, reaction_s)
        expect_in_time(f"{name}: standstill", still - since, reaction_s + RAMP_S)
        if fault:
            status = self.daemon.status()
            expect(status["standing"] in ("held", "ended"), f"{name}: the mission is {status['standing']}")
            expect(fault in status["counters"]["faults"], f"{name}: status counts {status['counters']['faults']}")
            expect(any(e["fault"] == fault for e in self.daemon.faults()), f"{name}: the log has {self.daemon.faults()}")
            for group, what in counted:
                expect(status["counters"].get(group, {}).get(what, 0) > 0, f"{name}: status counts no '{what}': {status['counters']}")
        stood = f"{1e3 * (still - since):.0f}" if still > since else "it had not moved"
        ROWS.append((name, fault or "the drives' own", ", ".join(what for _, what in counted), 1e3 * (first - since), stood))
        print(f"{name}: {1e3 * (first - since):.0f} ms, still after (ms): {stood}", flush=True)

    def recover(self, name):
        """After the fault is gone the same daemon takes the arm up again."""
        self.daemon.order("reset")
        self.daemon.order("home")
        rig.wait_for(f"{name}: ready again", lambda: self.daemon.status()["standing"] == "ready", 15, 0.1, self.daemon)

    def end(self):
        expect(self.daemon.process.poll() is None, f"the daemon ended by itself:\n{self.daemon.text()}")
        status = self.daemon.stop()
        expect(status in (0, 1), f"lanternfishd ended with {status}:\n{self.daemon.text()}")
        self.bench.sea.stop()


def last_sync(trial):
    """When the drives last heard of the master."""
    return trial.bench.watch.syncs[-1]


def killed(programs):
    trial = Trial(programs)
    trial.daemon.process.send_signal(signal.SIGKILL)
    trial.daemon.process.wait()
    trial.bench.watch.poll()
    since = last_sync(trial)
    trial.listen(1.2, ask=True)
    # The master's last heartbeat may be 100 ms old.
    trial.judge("daemon killed (SIGKILL)", since, HEARTBEAT_TIMEOUT_S + GUEST_S, [], None)
    again = trial.bench.daemon()
    again.wait_ready()
    again.order("home")
    rig.wait_for("a new daemon takes the arm up", lambda: again.status()["standing"] == "ready", 15, 0.1, again)
    expect(again.stop() == 0, again.text())
    trial.bench.sea.stop()


def dropped(programs):
    trial = Trial(programs, apart="182:7FF")
    ear = bus_watch.Ear("vcan0", [0x182])
    shell("cangw -D -s vcan1 -d vcan0 -e -f 182:7FF")
    trial.listen(1.0)
    since = max(t for t, _, _ in ear.frames())
    trial.judge("one drive's frames dropped", since, STALE_S + GUEST_S, [], "stale position")
    trial.bench.join()
    trial.recover("one drive's frames dropped")
    trial.end()


def changed(programs):
    trial = Trial(programs, apart="181:7FF")
    ear = bus_watch.Ear("vcan0", [0x181])
    shell("cangw -A -s vcan1 -d vcan0 -e -f 181:7FF -m SET:D:181.8.FFFF000000000000; cangw -D -s vcan1 -d vcan0 -e -f 181:7FF")
    trial.listen(1.0)
    since = min(t for t, _, data in ear.frames() if data == b"\xff\xff\0\0\0\0\0\0")
    trial.judge("one drive's frames changed", since, STALE_S + GUEST_S, [], "drive fault")
    trial.bench.join()
    trial.end()


def rebooted(programs):
    trial = Trial(programs)
    since = trial.bench.sea.order("fault reboot elbow")
    trial.listen(1.2, ask=True)
    # Its process data stop long before its boot-up message comes.
    trial.judge("a drive reboots", since, STALE_S + GUEST_S, [], "stale position", nodes=(1, 2, 4, 5))
    trial.recover("a drive reboots")
    trial.end()


def taken_down(programs):
    trial = Trial(programs)
    shell("ip link set vcan0 down")
    trial.bench.watch.poll()
    since = last_sync(trial)
    trial.listen(1.2, ask=True)
    trial.judge("interface taken down", since, HEARTBEAT_TIMEOUT_S + GUEST_S, [("can", "interface down")], "stale position")
    shell("ip link set vcan0 up")
    time.sleep(0.2)
    trial.recover("interface taken down and up")
    trial.end()


def removed(programs):
    trial = Trial(programs)
    shell("ip link del vcan0")
    trial.bench.watch.poll()
    since = last_sync(trial)
    trial.listen(1.2, ask=True)
    trial.judge("interface removed", since, HEARTBEAT_TIMEOUT_S + GUEST_S, [("can", "interface gone")], "stale position")
    trial.bench.make("vcan0")
    trial.bench.join()
    time.sleep(0.3)
    trial.recover("interface removed and made anew")
    expect(trial.daemon.status()["counters"]["can"].get("interface back", 0) == 1, "its return was not counted")
    trial.end()


def jammed(programs):
    """A bus so slow that nothing gets through in time: the controller's queue stays full."""
    trial = Trial(programs)
    since = time.time()
    shell("tc qdisc add dev vcan0 root tbf rate 16kbit burst 16 limit 160")
    trial.listen(1.2, ask=True)
    trial.judge("transmit queue full (ENOBUFS)", since, HEARTBEAT_TIMEOUT_S + 3 * GUEST_S,
                [("can", "transmit queue full"), ("can", "not sent in time")], "stale position")
    shell("tc qdisc del dev vcan0 root")
    time.sleep(0.2)
    trial.recover("transmit queue full")
    trial.end()


def error_frames(programs):
    """Error-passive is counted and flown on; bus-off stops the arm."""
    trial = Trial(programs)
    shell("cansend vcan0 20000004#0010000000000080")
    trial.listen(0.5)
    status = trial.daemon.status()
    expect(status["counters"]["can"].get("error passive") == 1, f"error passive is not counted: {status['counters']['can']}")
    trial.goes_on("error passive")
    expect(trial.moving(), "error passive stopped the arm")
    since = time.time()
    bus_watch.Ear("vcan0", []).send(0x20000040, bytes(8))
    trial.listen(1.0)
    trial.judge("bus off (error frame)", since, STALE_S + GUEST_S, [("can", "bus off")], "CAN bus off")
    trial.recover("bus off")
    trial.end()


def foreign(programs):
    """A set point of another master, which lets the slew run on elsewhere. That drive obeys it; the other four are this master's to stop."""
    trial = Trial(programs)
    elsewhere = trial.bench.watch.samples[1][-1].position + 200
    since = time.time()
    bus_watch.Ear("vcan1", []).send(0x201, struct.pack("<Hih", 0x0F, elsewhere, 0))
    trial.listen(1.0)
    trial.judge("a set point of another master", since, STALE_S + GUEST_S, [], "another master on the bus", nodes=(2, 3, 4, 5))
    expect(trial.bench.watch.without_torque(since) is not None, "another master's set points leave power on")
    trial.end()


def flooded(programs):
    """Frames of others fill what the bus leaves free; then garbage under every identifier."""
    trial = Trial(programs)
    flood = subprocess.Popen(["cangen", "vcan1", "-g", "0.3", "-I", "7F0", "-L", "8", "-D", "r"])
    trial.listen(1.5)
    flood.terminate()
    flood.wait()
    status = trial.daemon.status()
    trial.goes_on("a bus flooded with others' frames")
    expect("receive queue overflowed" not in status["counters"]["can"], f"frames were lost: {status['counters']['can']}")
    print("bus flooded with others' frames: the mission goes on", flush=True)
    since = time.time()
    garbage = subprocess.Popen(["cangen", "vcan1", "-g", "0.5", "-I", "r", "-L", "r", "-D", "r"])
    trial.listen(3.0)
    garbage.terminate()
    garbage.wait()
    status = trial.daemon.status()
    # It goes on, or it was stopped by a fault that is named; a stopped arm stands, under control or without power, within its travel.
    trial.bench.settle(RAMP_S + GUEST_S)
    status = trial.daemon.status()
    if status["standing"] != "working":
        expect(status["standing"] in ("held", "ended") and status["failure"]["reason"] in {e["fault"] for e in trial.daemon.faults()},
               f"garbage made the mission {status['standing']}: {status.get('failure')}, the log has {trial.daemon.faults()}")
        expect(not trial.bench.watch.moves(), "garbage stopped the mission, and the arm moves")
    for node, samples in trial.bench.watch.samples.items():
        expect(samples and samples[-1].t > since, f"node {node} has said nothing since the garbage began")
    counted = sum(status["counters"]["frames refused"].values())
    expect(counted > 0, f"no frame was refused: {status['counters']}")
    print(f"bus flooded with garbage for {time.time() - since:.1f} s: {status['standing']} ({status.get('failure', {}).get('reason', 'goes on')}), "
          f"{counted} frames refused", flush=True)
    trial.end()


def emergency_stop(programs):
    trial = Trial(programs)
    since = trial.bench.sea.order("fault estop")
    trial.listen(1.0)
    trial.judge("emergency stop (bus input)", since, STALE_S + GUEST_S, [], "emergency stop")
    since = time.time()
    trial.daemon.order("reset")
    trial.listen(0.5)
    off = trial.bench.watch.without_torque(since)
    expect(off is not None, "reset leaves power on")
    expect_in_time("power off after reset", off - since, 0.1 + GUEST_S)
    print(f"power off {1e3 * (off - since):.0f} ms after it was asked for", flush=True)
    trial.end()


def terminated(programs):
    """SIGTERM in motion: the arm stops, loses power, and the daemon ends in order."""
    trial = Trial(programs)
    since = time.time()
    trial.daemon.process.send_signal(signal.SIGTERM)
    trial.listen(1.5, ask=True)
    watch = trial.bench.watch
    still, off = watch.stood_still(since), watch.without_torque(since)
    expect(off is not None, "SIGTERM leaves power on")
    expect_in_time("SIGTERM: power off", off - since, 1.2)
    print(f"terminated (SIGTERM): still after {1e3 * (still - since):.0f} ms, without torque after {1e3 * (off - since):.0f} ms", flush=True)
    expect(trial.daemon.wait(5) in (0, 1), trial.daemon.text())
    trial.bench.sea.stop()


def started(programs):
    """From the program's start to orders taken, from there to drives under control; and back to no torque."""
    bench = rig.Rig(programs, gateway=True, camera=False)
    daemon = bench.daemon()
    ready_s = daemon.wait_ready()
    since = time.time()
    daemon.order("home")
    rig.wait_for("ready", lambda: (bench.watch.poll(), daemon.status()["standing"] == "ready")[1], 15, 0.02, daemon)
    bench.watch.poll()
    homed_s = time.time() - since
    enabled = [bench.watch.first(node, lambda s: s.state == bus_watch.OPERATION_ENABLED, since) for node in bus_watch.DRIVES]
    expect(None not in enabled, "ready, but not every drive is")
    print(f"orders are taken {1e3 * ready_s:.0f} ms after the program's start; all drives booted and under control {1e3 * (max(enabled) - since):.0f} ms after "
          f"`home`, which is ready after {1e3 * homed_s:.0f} ms", flush=True)
    expect_in_time("orders are taken", ready_s, 5)
    expect_in_time("ready", homed_s, 5)
    expect(daemon.stop() == 0, daemon.text())
    bench.sea.stop()


FAULTS = (started, terminated, killed, dropped, changed, rebooted, taken_down, removed, jammed, error_frames, foreign, flooded, emergency_stop)


def break_everything(programs):
    wanted = sys.argv[2:]
    for fault in FAULTS:
        if not wanted or fault.__name__ in wanted:
            print(f"-- {fault.__name__}", flush=True)
            with rig.stage():
                fault(programs)
    print("\n| fault | named | counted | reaction (ms) | standstill (ms) |\n|---|---|---|---|---|")
    for name, fault, counted, reaction_ms, stood in ROWS:
        print(f"| {name} | {fault} | {counted} | {reaction_ms:.0f} | {stood} |")


if __name__ == "__main__":
    rig.main(break_everything)
