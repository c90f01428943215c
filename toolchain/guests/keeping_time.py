#!/usr/bin/env python3
"""Runs a test whose result depends on real time, in a guest; where the machine did not keep time, again, and then not at all.

Usage: keeping_time.py --watch PROGRAM --out FOLDER --lost FILE --seconds S [--own-clock] RUNNER [OPTION VALUE]... -- COMMAND [ARGUMENT]...

PROGRAM is watch_time.cpp, built; RUNNER with its options makes the guest (with_vcan.sh). A failure counts as one unless the machine is known not to have
kept time during it:
  - a sleep of the guest's first process was longer by a SYNC period, 4 ms of the guest's time (not with --own-clock: that guest counts instructions); or
  - the test itself says so, in FOLDER/out_of_time, a reason a line (tests/vcan/rig.py: the control thread's wake-ups, the simulated sea); or
  - the time limit came, or the guest died, while sleeps out here were longer by 100 ms, or more programs wanted to run than there are processors for.
A failure without an excuse has to come twice: what a guest does in real time is not the same twice, and what is wrong fails again.
There are three attempts, not counting one failure, which together have S seconds. All tests of one run of ctest, which FILE is for, lose 180 s on attempts that were not fair, then
there is one attempt each, and after 300 s none: such a machine is not asked for ever.
Exit status: the test's; 77, with "no machine that keeps time: REASON" as the last line, when no attempt was a fair one.
"""
import argparse
import os
import pathlib
import subprocess
import sys
import time

LATE_MS = 4.0
LATE_OUTSIDE_MS = 100.0  # more than a busy guest costs, whose kernel is real-time: 50 (sched_rt_runtime_us)
ATTEMPTS = 3
LOST_ON_MORE_S, LOST_ON_ALL_S = 180.0, 300.0
ENVIRONMENT_LACKS, OVER_TIME, GUEST_FAILED = 3, 124, 125


def arguments():
    parser = argparse.ArgumentParser(usage=__doc__.split("\n\n")[1])
    parser.add_argument("--watch", required=True)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--lost", type=pathlib.Path, required=True)
    parser.add_argument("--seconds", type=float, required=True)
    parser.add_argument("--own-clock", action="store_true")
    parser.add_argument("runner", nargs=argparse.REMAINDER)
    asked = parser.parse_args()
    split = asked.runner.index("--")
    return asked, asked.runner[:split], asked.runner[split + 1:]


class Lost:
    """Seconds that this run of ctest, our parent, has lost on attempts that were not fair."""

    def __init__(self, file):
        self.file = file
        parent = os.getppid()
        started = pathlib.Path(f"/proc/{parent}/stat").read_text().rsplit(")", 1)[1].split()[19]
        self.run = f"{parent}-{started}"  # numbers of processes come again
        try:
            run, seconds = file.read_text().split()
            self.seconds = float(seconds) if run == self.run else 0.0
        except (FileNotFoundError, ValueError):
            self.seconds = 0.0

    def add(self, seconds):
        self.seconds += seconds
        self.file.write_text(f"{self.run} {self.seconds:.1f}\n")


def crowd():
    """How many programs more than processors want to run (minute's average); what the test itself needs not counted."""
    return os.getloadavg()[0] - 1.5 - len(os.sched_getaffinity(0))


def worst_ms(file):
    try:
        return float(file.read_text())
    except (FileNotFoundError, ValueError):
        return 0.0


def excuses(status, out):
    """Why the attempt says nothing about what was tested; empty when it does."""
    found = []
    inside, outside = worst_ms(out / "guest_late_ms"), worst_ms(out / "machine_late_ms")
    if inside > LATE_MS:
        found.append(f"a sleep in the guest was {inside:.1f} ms too long")
    try:
        found += (out / "out_of_time").read_text().splitlines()
    except FileNotFoundError:
        pass
    if status in (OVER_TIME, GUEST_FAILED) and outside > LATE_OUTSIDE_MS:
        found.append(f"a sleep on this machine was {outside:.1f} ms too long")
    if status in (OVER_TIME, GUEST_FAILED) and crowd() > 0:
        found.append(f"load {os.getloadavg()[0]:.1f} on {len(os.sched_getaffinity(0))} processors")
    return found


def main():
    asked, runner, command = arguments()
    end = time.monotonic() + asked.seconds
    lost = Lost(asked.lost)
    if lost.seconds > LOST_ON_ALL_S:
        print(f"no machine that keeps time: {lost.seconds:.0f} s were lost to that in the tests before")
        return 77
    reasons, failures = [], 0
    for attempt in range(1, ATTEMPTS + 2):
        # What was there before an attempt was another's; an attempt that has less than half of the time left could hardly end.
        begin = time.monotonic()
        left = end - begin
        if reasons and (attempt - failures > ATTEMPTS or left < asked.seconds / 2 or lost.seconds > LOST_ON_MORE_S):
            break
        for name in ("guest_late_ms", "machine_late_ms", "out_of_time"):
            (asked.out / name).unlink(missing_ok=True)
        inside = [] if asked.own_clock else [asked.watch, asked.out / "guest_late_ms"]
        status = subprocess.run([asked.watch, asked.out / "machine_late_ms", runner[0], "--time-limit", str(int(left)), *runner[1:], *inside, *command],
                                check=False).returncode
        if status in (0, ENVIRONMENT_LACKS):
            return status
        # An attempt that was given what others had left may end for the lack of it.
        reasons = excuses(status, asked.out) or (reasons if status == OVER_TIME else [])
        if not reasons:
            failures += 1
            if failures == 2 or end - time.monotonic() < asked.seconds / 2:
                return status
            print(f"keeping_time: attempt {attempt} failed with {status}; once more, to see whether it does again", flush=True)
            continue
        lost.add(time.monotonic() - begin)
        print(f"keeping_time: attempt {attempt} ended with {status}, {'; '.join(reasons)}", flush=True)
    print(f"no machine that keeps time: {'; '.join(reasons)}", flush=True)
    return 77


if __name__ == "__main__":
    sys.exit(main())
