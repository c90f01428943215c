#!/usr/bin/env python3
"""A camera that freezes, drops, repeats and goes away while the laser sweeps: the mission sees the panel all the same, and counts what it missed.

Usage: camera_faults_test.py FOLDER_OF_PROGRAMS; inside a guest (lanternfish_guest_test). The pictures come through the frame ring.
"""
import time

import rig
from rig import expect


def counters(status):
    """All counters that have to do with pictures, by name."""
    found = dict(status["counters"]["camera"])
    found.update((k, v) for k, v in status["counters"]["images"].items() if k in ("unexpected", "refused", "missing"))
    found.update((k, v) for k, v in status["counters"]["faults"].items() if "image" in k)
    return found


def grown(before, after):
    return {name: after[name] - before.get(name, 0) for name in after if after[name] != before.get(name, 0)}


def trouble_everything(programs):
    bench = rig.Rig(programs)
    daemon = bench.daemon()
    daemon.wait_ready()
    daemon.order("start")
    daemon.wait_step("scan", 20)
    time.sleep(1.0)
    for trouble in ("freeze", "drop", "repeat", "away"):
        before = counters(daemon.status())
        bench.sea.order(f"camera {trouble} 1.5")
        time.sleep(2.3)
        status = daemon.status()
        noticed = grown(before, counters(status))
        print(f"camera {trouble}s for 1.5 s: {noticed}, step {status['step']}, camera {status['camera']['status']}", flush=True)
        expect(status["standing"] == "working", f"camera {trouble}: the mission is {status['standing']}: {status.get('failure')}")
        expect(noticed, f"camera {trouble}: nothing was counted")
    status = daemon.wait_step(("reach valve", "advance"), 90)
    print(f"the valve was found after all: {status['counters']['faults']}")
    exit_status = daemon.stop()
    expect(exit_status == 0, f"lanternfishd ended with {exit_status}:\n{daemon.text()}")
    expect(status["core"]["heap_calls"] == 0, "heap calls")
    bench.sea.stop()


rig.main(trouble_everything)
