#!/usr/bin/env python3
"""How the tests in guests tell function from time, on recordings of this test's making: rig.py, flight_test.py, loop_test.py, hostile_test.py, bus_watch.py."""
import copy
import pathlib
import struct
import sys
import unittest

sys.dont_write_bytecode = True
HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "qemu")]
import bus_watch  # noqa: E402
import flight_test  # noqa: E402
import hostile_test  # noqa: E402
import loop_test  # noqa: E402
import rig  # noqa: E402

# What a good flight leaves behind.
STATUS = {"success": True, "standing": "ended", "core": {"heap_calls": 0, "page_faults": 0, "realtime": True}, "counters": {"can": {}},
          "latency": {"wake_up_us": {"p50": 30.0, "p99": 108.0, "p999": 832.0, "max": 7800.0}}}
SEA = {"success": True, "tasks": [{"task": "turn_valve", "target_deg": 90.0, "reached_deg": 89.9, "done": True},
                                  {"task": "press_button", "button": "left", "presses": 1, "done": True}]}
STALE = {"success": False, "standing": "ended", "failure": {"phase": "advance", "reason": "stale position"}}


def flown(status=(), sea=(), exit_status=0, gap_s=0.005):
    """The exit status that a flight's recording, changed so, ends with."""
    recorded, world = copy.deepcopy(STATUS), copy.deepcopy(SEA)
    recorded.update(status)
    world.update(sea)
    return rig.verdict(lambda: flight_test.judge(recorded, exit_status, world, gap_s))[0]


class Flight(unittest.TestCase):
    def test_a_good_one_passes(self):
        self.assertEqual(flown(), 0)

    def test_a_wrong_angle_is_no_matter_of_time(self):
        wrong = {"success": False, "tasks": [{"task": "turn_valve", "target_deg": 90.0, "reached_deg": -90.0, "done": False}]}
        late = {"latency": {"wake_up_us": {"p50": 30.0, "p99": 108.0, "p999": 8320.0, "max": 78000.0}}}
        self.assertEqual(flown(sea=wrong), rig.FAILED)
        self.assertEqual(flown(status=late, sea=wrong, gap_s=0.5), rig.FAILED)
        sly = {"success": True, "tasks": [{"task": "turn_valve", "target_deg": 90.0, "reached_deg": 80.0, "done": True}]}
        self.assertEqual(flown(status=late, sea=sly, gap_s=0.5), rig.FAILED)

    def test_a_missing_frame_is_no_matter_of_time(self):
        for what in ("receive queue overflowed", "not sent in time", "not sent"):
            self.assertEqual(flown(status={**STALE, "counters": {"can": {what: 1}}}, sea={"success": False}, gap_s=0.5), rig.FAILED, what)

    def test_nor_is_a_heap_call_or_a_page_fault(self):
        for what in ("heap_calls", "page_faults"):
            self.assertEqual(flown(status={**STALE, "core": {**STATUS["core"], what: 1}}, sea={"success": False}, gap_s=0.5), rig.FAILED, what)

    def test_an_arm_that_stopped_for_a_silent_bus_is_late_when_the_listener_heard_the_silence(self):
        self.assertEqual(flown(status=STALE, sea={"success": False}, exit_status=1, gap_s=0.016), rig.TOO_LATE)

    def test_the_daemons_word_alone_excuses_nothing(self):
        self.assertEqual(flown(status=STALE, sea={"success": False}, exit_status=1, gap_s=0.005), rig.FAILED)

    def test_any_other_end_is_a_failure(self):
        for reason in ("drive fault", "jammed", "node lost"):
            status = {**STALE, "failure": {"phase": "advance", "reason": reason}}
            self.assertEqual(flown(status=status, sea={"success": False}, exit_status=1, gap_s=0.5), rig.FAILED, reason)

    def test_each_bound_of_the_wake_ups_can_fail_alone(self):
        for p999, worst, expected in ((3900.0, 11900.0, 0), (4100.0, 11900.0, rig.TOO_LATE), (3900.0, 12100.0, rig.TOO_LATE)):
            self.assertEqual(flown(status={"latency": {"wake_up_us": {"p50": 30.0, "p99": 108.0, "p999": p999, "max": worst}}}), expected)


class Loop(unittest.TestCase):
    def test_each_bound_of_the_wake_ups_can_fail_alone(self):
        for p999, worst, expected in ((11.1, 11.1, 0), (49.0, 190.0, 0), (51.0, 60.0, rig.FAILED), (49.0, 201.0, rig.FAILED)):
            self.assertEqual(rig.verdict(lambda: loop_test.judge_wake_ups({"p999": p999, "max": worst}))[0], expected, (p999, worst))  # pylint: disable=cell-var-from-loop


class Hostile(unittest.TestCase):
    ROW = {"ticks": 2500, "missed": 1, "heap_calls": 0, "page_faults": 0, "p999_us": 11, "max_us": 12, "growth_kb": 0, "log": ""}

    def ended(self, **changes):
        """The exit status with the row of the hostile clients changed so."""
        measured = {name: dict(self.ROW) for name in ("quiet", "hostile_clients", "full_disk", "slow_disk")}
        measured["full_disk"]["log"] = "No space left on device"
        for name, change in changes.items():
            measured[name].update(change)
        return rig.verdict(lambda: hostile_test.judge(measured))[0]

    def test_what_is_missed_without_them_is_not_held_against_them(self):
        self.assertEqual(self.ended(), 0)
        self.assertEqual(self.ended(hostile_clients={"missed": 0}), 0)

    def test_each_line_can_fail(self):
        for change in ({"missed": 2}, {"heap_calls": 1}, {"growth_kb": 400}, {"ticks": 2000}):
            for name in ("hostile_clients", "slow_disk"):
                self.assertEqual(self.ended(**{name: change}), rig.FAILED, (name, change))
        self.assertEqual(self.ended(full_disk={"log": ""}), rig.FAILED)


class Verdict(unittest.TestCase):
    def test_function_comes_before_time(self):
        def late_and_wrong():
            rig.expect_in_time("reaction", 0.5, 0.1)
            rig.expect(False, "not every drive was stopped")

        status, messages, missed = rig.verdict(late_and_wrong)
        self.assertEqual(status, rig.FAILED)
        self.assertEqual(len(messages), 2)
        self.assertAlmostEqual(missed, 400)

    def test_the_worst_miss_counts(self):
        def late():
            rig.expect_in_time("reaction", 0.15, 0.1)
            rig.expect_in_time("standstill", 1.2, 1.0)
            rig.expect_in_time("power off", 0.9, 1.0)

        status, messages, missed = rig.verdict(late)
        self.assertEqual((status, len(messages)), (rig.TOO_LATE, 2))
        self.assertAlmostEqual(missed, 200)

    def test_what_does_not_come_is_a_failure_but_after_a_stop_that_a_machine_makes_by_standing_still(self):
        class Stopped:
            def __init__(self, reason):
                self.reason = reason

            def status(self):
                return {"failure": {"reason": self.reason}} if self.reason else {}

        for reason, wanted in ((None, (rig.FAILED, 0)), ("drive fault", (rig.FAILED, 0)), ("stale position", (rig.TOO_LATE, 8)),
                               ("camera silent", (rig.TOO_LATE, 120))):
            status, _, missed = rig.verdict(lambda: rig.wait_for("never", lambda: False, 0.05, 0.01, Stopped(reason)))  # pylint: disable=cell-var-from-loop
            self.assertEqual((status, missed), wanted)
        self.assertEqual(rig.verdict(lambda: rig.wait_for("never", lambda: False, 0.05, 0.01))[0], rig.FAILED)

    def test_a_program_that_died_or_broke_off_is_a_failure(self):
        for error in (ConnectionResetError("gone"), KeyError("standing"), TimeoutError("no answer")):
            def breaks(raised=error):
                raise raised
            self.assertEqual(rig.verdict(breaks)[0], rig.FAILED)


class Gaps(unittest.TestCase):
    def test_the_listeners_longest_silence_is_of_one_kind_of_frame(self):
        watch = bus_watch.BusWatch.__new__(bus_watch.BusWatch)
        watch.syncs, watch.samples = [], {node: [] for node in bus_watch.DRIVES}
        watch.heartbeats, watch.controlwords, watch.said = {}, {}, {}
        self.assertEqual(watch.longest_gap_s(), 0)
        for i in range(100):
            watch.take(0.004 * i, 0x080, b"")
            if not 50 < i < 54:
                watch.take(0.004 * i + 0.001, 0x183, struct.pack("<Hih", 0x27, i, 0))
        self.assertAlmostEqual(watch.longest_gap_s(), 0.016)


if __name__ == "__main__":
    unittest.main()
