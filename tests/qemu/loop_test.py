#!/usr/bin/env python3
"""The control loop at 250 Hz with five drives and the output node over the driver of a CAN card, on a clock that counts instructions: no frame is lost.

Usage: loop_test.py FOLDER_OF_PROGRAMS NODES_ON_CAN; inside the guest of run_in_qemu.sh. The daemon is on can0, the simulator's nodes on can1 of the same
bus, without a world.
Prints how late the loop woke up and how long its ticks took; leaves both in LANTERNFISH_GUEST_OUT.
"""
import json
import os
import pathlib
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "vcan"))
import rig  # noqa: E402
from rig import expect  # noqa: E402

SECONDS = 2.0  # of motion
READING_S = 3600  # more than the guest's clock ever jumps while programs are read, however slow this machine is
rig.ANSWER_S = READING_S  # the daemon reads its program while it answers

# On a clock that counts instructions nothing outside makes the loop late, so a late wake-up is a failure like another. Measured: p99.9 and worst
# 11 us each, of 760 ticks (2026-11-22). Each bound can fail without the other: 1 tick in 760 is more than p99.9 leaves out.
WAKE_UP_P999_US, WAKE_UP_MAX_US = 50, 200

def loop(programs):
    folder = pathlib.Path("/tmp/rig")
    folder.mkdir()
    os.environ["LANTERNFISH_SHARE"] = str(rig.ROOT / "shared")
    said = open(folder / "nodes.out", "w+")
    nodes = rig.start([sys.argv[2], "can1"], said)
    rig.wait_for("the nodes", lambda: "serving" in (folder / "nodes.out").read_text(), READING_S)
    daemon = rig.Daemon(pathlib.Path(programs), folder / "run", "can0", None)
    daemon.wait_ready(READING_S)
    daemon.order("start")
    daemon.wait_step("deploy", READING_S)
    before = daemon.status()
    time.sleep(SECONDS)
    after = daemon.status()
    expect(daemon.stop(READING_S) == 0, daemon.text())
    nodes.terminate()
    expect(nodes.wait(READING_S) == 0, "a frame of the nodes could not be sent")
    print(daemon.text() + (folder / "nodes.out").read_text())

    latency = after["latency"]
    for what in ("wake_up_us", "tick_us", "tick_cpu_us"):
        print(f"{what}: " + ", ".join(f"{k} {v:.0f}" for k, v in latency[what].items()))
    if out := os.environ.get("LANTERNFISH_GUEST_OUT"):
        (pathlib.Path(out) / "loop.json").write_text(json.dumps(after, indent=1))
    ticks = after["ticks"] - before["ticks"]
    received = after["frames"]["received"] - before["frames"]["received"]
    expect(after["standing"] == "working", f"the mission is {after['standing']}: {after.get('failure')}")
    expect("ticks missed" not in after["counters"], f"{after['counters'].get('ticks missed')} ticks missed")
    expect(not after["counters"]["can"], f"on the bus: {after['counters']['can']}")
    # Every SYNC is answered by six nodes; heartbeats come besides. A status is up to 0.1 s old at either end.
    expect(received >= 6 * (ticks - 1), f"{received} frames for {ticks} ticks of six nodes")
    judge_wake_ups(latency["wake_up_us"])


def judge_wake_ups(wake_up):
    expect(wake_up["p999"] <= WAKE_UP_P999_US, f"woken up {wake_up['p999']:.0f} us late (p99.9)")
    expect(wake_up["max"] <= WAKE_UP_MAX_US, f"woken up {wake_up['max']:.0f} us late (worst)")


if __name__ == "__main__":
    rig.main(loop)
