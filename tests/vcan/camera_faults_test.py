#!/usr/bin/env python3
"""A camera that repeats, freezes, drops and goes away while the laser sweeps: what is short is counted and scanned again, what lasts ends the mission.
The ring's file is emptied meanwhile, which does not end the daemon.

Usage: camera_faults_test.py FOLDER_OF_PROGRAMS; inside a guest (lanternfish_guest_test). The pictures come through the frame ring.
"""
import os
import time

import rig
from rig import expect

# Silence is noticed after 0.2 s, and the arm is back at the sweep's start a second later (2026-11-21): trouble of 0.6 s is met once.
SHORT_S = 0.6


def scanning(programs):
    """(rig, daemon), a second into the sweep."""
    bench = rig.Rig(programs)
    daemon = bench.daemon()
    daemon.wait_ready()
    daemon.order("start")
    daemon.wait_step("scan", 20)
    time.sleep(1.0)
    return bench, daemon


def silences(status):
    return status["counters"]["faults"].get("camera silent", 0)


def end(bench, daemon, exit_status):
    status = daemon.status()
    expect(status["core"]["heap_calls"] == 0, f"{status['core']['heap_calls']} heap calls")
    print(f"counted: {status['counters']['faults']}, images {status['counters']['images']}", flush=True)
    ended = daemon.stop()
    expect(ended == exit_status, f"lanternfishd ended with {ended}:\n{daemon.text()}")
    bench.sea.stop()


def short_troubles(programs):
    bench, daemon = scanning(programs)
    bench.sea.order(f"camera repeat {SHORT_S}")
    time.sleep(SHORT_S + 0.6)
    status = daemon.status()
    unexpected = status["counters"]["images"].get("unexpected", 0)
    expect(unexpected > 5, f"repeated pictures are not counted: {status['counters']}")
    if silences(status):
        # Repeated pictures are pictures: only a machine that stands still makes a silence of them.
        raise rig.TooLate(f"repeated pictures are a silence: {status['counters']}", rig.STALLS_MS["camera silent"])
    expect(status["step"] == "scan", f"repeated pictures stop the scan: {status['step']}, {status['counters']}")
    print(f"camera repeats for {SHORT_S} s: {unexpected} pictures unexpected, the scan goes on", flush=True)

    for times, trouble in enumerate(("freeze", "drop"), 1):
        since = time.monotonic()
        bench.sea.order(f"camera {trouble} {SHORT_S}")
        rig.wait_for(f"camera {trouble}: silence", lambda: silences(daemon.status()) >= times, 5, daemon=daemon)  # pylint: disable=cell-var-from-loop
        noticed_s = time.monotonic() - since
        status = daemon.wait_step("scan", 20)
        bench.watch.poll()
        rig.expect_not_stopped(status, bench.watch.longest_gap_s(), f"camera {trouble}")
        print(f"camera {trouble}s for {SHORT_S} s: silent after {noticed_s:.2f} s, scanned again", flush=True)
        time.sleep(SHORT_S + 0.9)
    status = daemon.wait_step(("reach valve", "advance"), 90)
    if silences(status) > 2:
        raise rig.TooLate(f"silent {silences(status)} times, not twice", rig.STALLS_MS["camera silent"])
    expect(silences(status) == 2, f"silent {silences(status)} times, not twice")
    print("the valve was found after all", flush=True)
    end(bench, daemon, 0)


def gone(programs):
    bench, daemon = scanning(programs)
    bench.sea.order("camera away 60")
    time.sleep(0.1)  # it maps the ring's file and must not write any more
    size = os.path.getsize(bench.camera)
    os.truncate(bench.camera, 0)
    status = rig.wait_for("the mission's end", lambda: (lambda s: s if "success" in s else None)(daemon.status()), 60, 0.1, daemon)
    expect(not status["success"] and status["failure"]["reason"] == "camera silent", f"a camera that is gone: {status.get('failure')}")
    expect(silences(status) == 3, f"tried {silences(status)} times, not three")
    os.truncate(bench.camera, size)
    print("camera goes away and its ring is emptied: tried three times, then the arm is stowed", flush=True)
    end(bench, daemon, 1)


def trouble_everything(programs):
    for trial in (short_troubles, gone):
        with rig.stage():
            trial(programs)


if __name__ == "__main__":
    rig.main(trouble_everything)
