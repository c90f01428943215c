#!/usr/bin/env python3
"""The vehicle's program does the whole docked job against the simulator as hardware, over a real CAN stack and in real time.

Usage: flight_test.py FOLDER_OF_PROGRAMS; inside a guest (lanternfish_guest_test). With LANTERNFISH_SHARED_FILE the pictures are made outside of the guest
(with_host_renderer.sh). What was measured is left in LANTERNFISH_GUEST_OUT, with the daemon's logs.

The criteria are those of the desktop's run: the valve within 3 degrees of its target and every button clicked, in the world. And those of the control
thread: no heap call and no page fault, and not a frame lost on the bus. A machine that stands still for three SYNCs stops the arm, rightly: "stale
position". Then the attempt says nothing about the vehicle (keeping_time.py).
"""
import json
import os
import pathlib
import shutil
import time

import rig
from rig import expect

def fly(programs):
    options = ["--renderer", os.environ["LANTERNFISH_SHARED_FILE"]] if os.environ.get("LANTERNFISH_SHARED_FILE") else []
    bench = rig.Rig(programs, sea_options=options)
    daemon = bench.daemon()
    ready_s = daemon.wait_ready()
    daemon.order("start")
    began = time.monotonic()
    status = daemon.status()
    step = ""
    while "success" not in status:
        expect(time.monotonic() < began + 150, f"the mission goes on in step {status['step']}")
        time.sleep(0.5)
        status = daemon.status()
        if status["step"] != step:
            step = status["step"]
            print(f"{time.monotonic() - began:7.2f} s  {step}", flush=True)
    took_s = time.monotonic() - began
    exit_status = daemon.stop()
    sea = bench.sea.stop()
    print(f"ready {ready_s:.2f} s after its start, done after {took_s:.1f} s")
    print(daemon.text() + bench.sea.text())
    if out := os.environ.get("LANTERNFISH_GUEST_OUT"):
        (pathlib.Path(out) / "flight.json").write_text(json.dumps({"ready_s": ready_s, "took_s": took_s, "daemon": status, "sea": sea}, indent=1))
        for log in daemon.log.iterdir():
            shutil.copy(log, out)
    return status, exit_status, sea


def judge(status, exit_status, sea):
    expect(status["success"], f"the mission failed: {status.get('failure')}; wake-ups {status['latency']['wake_up_us']}")
    expect(exit_status == 0, f"lanternfishd ended with {exit_status}")
    expect(sea["success"], f"the job is not done in the world: {sea['tasks']}")
    core = status["core"]
    expect(core["heap_calls"] == 0, f"{core['heap_calls']} heap calls in the control thread")
    expect(core["page_faults"] == 0, f"{core['page_faults']} page faults in the control thread")
    expect(core["realtime"], f"not real-time: {status['lost']}")
    lost = [what for what in ("receive queue overflowed", "not sent in time", "not sent") if what in status["counters"]["can"]]
    expect(not lost, f"frames were lost: {status['counters']['can']}")


def fly_and_judge(programs):
    judge(*fly(programs))


rig.main(fly_and_judge)
