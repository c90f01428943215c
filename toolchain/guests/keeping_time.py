#!/usr/bin/env python3
"""Runs a test whose result depends on real time in a guest, and judges how it ended.

Usage: keeping_time.py --watch PROGRAM --out FOLDER --lost FILE --seconds S [--own-clock] RUNNER [OPTION VALUE]... -- COMMAND [ARGUMENT]...

PROGRAM is watch_time.cpp, built; RUNNER with its options makes the guest (with_vcan.sh). COMMAND tells function from time by its exit status:
  0   everything was right
  75  everything that was measured came out right, but too late; FOLDER/missed_ms says by how many milliseconds
  other: a function failed (a wrong angle, a missing frame, a program that died). The first such failure fails the test. There is no second attempt.
A late test (75), a time limit (124) and a guest that died (125) are excused only by what was measured outside the tested programs. Evidence is one of:
  - the watcher, the guest's first process, slept 4 ms (a SYNC period) or more too long, and at least as long as the test missed its limit by.
    Where the limit was missed by more than a second, or more programs wanted to run on this machine than it has processors (load average), all its long
    sleeps together count: a crowded machine takes the time in small pieces. A guest that counts instructions (--own-clock) has no watcher
  - for 124 and 125: the same watcher on this machine slept 100 ms or more too long
  - for 124 and 125: that load average. It excuses no missed limit (75): it does not say by how much anything was late, and the tested programs are in it. Of
    the time limit of a whole attempt it is evidence: the guest has one processor, which CROWDED_FROM takes off, so that a hung guest alone crowds nothing
An excused attempt is repeated, three attempts at most, which together have S seconds. All tests of one run of ctest, which FILE is for, may lose 180 s on excused
attempts. After that each test has one attempt, and after 300 s none.
Exit status: 0; the test's own when it failed; 77 (skipped) when no attempt was a fair one or no guest can be had here. Where CI=true, a guest that cannot
be had is a failure: that machine is there to run these tests.
"""
import argparse
import os
import pathlib
import subprocess
import sys
import time

LATE_MS = 4.0
LATE_OUTSIDE_MS = 100.0  # more than a busy guest costs, whose kernel is real-time: 50 (sched_rt_runtime_us)
SUMMED_FROM_MS = 1000.0
ATTEMPTS = 3
LOST_ON_MORE_S, LOST_ON_ALL_S = 180.0, 300.0
ENVIRONMENT_LACKS, TOO_LATE, SKIPPED, OVER_TIME, GUEST_FAILED = 3, 75, 77, 124, 125
CROWDED_FROM = 1.5  # programs that the test itself needs


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
    """Seconds that this run of ctest, our parent, has lost on excused attempts."""

    def __init__(self, file):
        self.file = file
        parent = os.getppid()
        started = pathlib.Path(f"/proc/{parent}/stat").read_text().rsplit(")", 1)[1].split()[19]
        self.run = f"{parent}-{started}"  # process numbers are used again
        try:
            run, seconds = file.read_text().split()
            self.seconds = float(seconds) if run == self.run else 0.0
        except (FileNotFoundError, ValueError):
            self.seconds = 0.0

    def add(self, seconds):
        self.seconds += seconds
        self.file.write_text(f"{self.run} {self.seconds:.1f}\n")


def crowd():
    """How many programs more than processors want to run (average of a minute), without the test's own."""
    return os.getloadavg()[0] - CROWDED_FROM - len(os.sched_getaffinity(0))


def watched(file):
    """(longest, sum) of a watcher's overshoots in ms; zero where it measured nothing."""
    try:
        worst, total = file.read_text().split()
        return float(worst), float(total)
    except (FileNotFoundError, ValueError):
        return 0.0, 0.0


def missed_ms(out):
    """By how much the test missed its limits; nothing that a machine can excuse where the test does not say."""
    try:
        return float((out / "missed_ms").read_text())
    except (FileNotFoundError, ValueError):
        return float("inf")


def excuses(status, out):
    """Why the attempt says nothing about what was tested; empty when it does. Never for a failure of function."""
    if status not in (TOO_LATE, OVER_TIME, GUEST_FAILED):
        return []
    found = []
    by_machine = status != TOO_LATE
    worst, total = watched(out / "guest_late_ms")
    wanted = LATE_MS if by_machine else max(LATE_MS, missed_ms(out))
    if worst >= wanted:
        found.append(f"a sleep in the guest was {worst:.1f} ms too long")
    elif (wanted > SUMMED_FROM_MS or crowd() > 0) and total >= wanted:
        found.append(f"sleeps in the guest were {total:.0f} ms too long")
    outside = watched(out / "machine_late_ms")[0]
    if by_machine and outside >= LATE_OUTSIDE_MS:
        found.append(f"a sleep on this machine was {outside:.1f} ms too long")
    if crowd() > 0 and by_machine:
        found.append(f"load {os.getloadavg()[0]:.1f} on {len(os.sched_getaffinity(0))} processors")
    return found


def without_guest():
    """What a machine without a guest makes of the test."""
    if os.environ.get("CI") == "true":
        print("no guest on this machine, and CI=true: a failure", flush=True)
        return 1
    print("skipped: no guest on this machine", flush=True)
    return SKIPPED


def attempt(asked, runner, command, limit_s):
    for name in ("guest_late_ms", "machine_late_ms", "missed_ms"):
        (asked.out / name).unlink(missing_ok=True)  # an earlier attempt's
    inside = [] if asked.own_clock else [asked.watch, asked.out / "guest_late_ms"]
    return subprocess.run([asked.watch, asked.out / "machine_late_ms", runner[0], "--time-limit", str(int(limit_s)), *runner[1:], *inside, *command],
                          check=False).returncode


def main():
    asked, runner, command = arguments()
    end = time.monotonic() + asked.seconds
    lost = Lost(asked.lost)
    if lost.seconds > LOST_ON_ALL_S:
        print(f"no machine that keeps time: {lost.seconds:.0f} s were lost to that in the tests before")
        return SKIPPED
    reasons = []
    for number in range(1, ATTEMPTS + 1):
        begin = time.monotonic()
        left = end - begin
        # An attempt with less than half of the time left could hardly end.
        if reasons and (left < asked.seconds / 2 or lost.seconds > LOST_ON_MORE_S):
            break
        status = attempt(asked, runner, command, left)
        if status == 0:
            return 0
        if status == ENVIRONMENT_LACKS:
            return without_guest()
        # A repeated attempt has only what is left of the time, and may end for that reason.
        reasons = excuses(status, asked.out) or (reasons if status == OVER_TIME else [])
        if not reasons:
            return status
        lost.add(time.monotonic() - begin)
        print(f"keeping_time: attempt {number} ended with {status}, {'; '.join(reasons)}", flush=True)
    print(f"no machine that keeps time: {'; '.join(reasons)}", flush=True)
    return SKIPPED


if __name__ == "__main__":
    sys.exit(main())
