#!/usr/bin/env python3
"""keeping_time.py, the judge of tests in guests, on guests and recordings of this test's making: a failure of function is never excused, a late test only by what
was measured outside of it."""
import importlib.util
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "toolchain/guests/keeping_time.py"
SPEC = importlib.util.spec_from_file_location("keeping_time", SCRIPT)
keeping_time = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(keeping_time)

# Measures nothing: says LATE_MS (longest and sum) of the guest, MACHINE_MS of the machine.
WATCH = """#!/bin/bash
case $1 in *guest*) echo "$LATE_MS" ;; *) echo "$MACHINE_MS" ;; esac >"$1"
shift
exec "$@"
"""
RUNNER = """#!/bin/bash
shift 2  # --time-limit S
exec "$@"
"""


class KeepingTime(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.addCleanup(self.temporary.cleanup)
        self.folder = pathlib.Path(self.temporary.name)
        for name, text in (("watch", WATCH), ("runner", RUNNER)):
            (self.folder / name).write_text(text)
            (self.folder / name).chmod(0o755)

    def setUp_quiet(self):
        """As if nothing else ran on this machine."""
        self.addCleanup(setattr, keeping_time, "crowd", keeping_time.crowd)
        keeping_time.crowd = lambda: -1.0

    def run_it(self, command, late_ms="0.3 0.9", seconds=60, missed_ms="5", own_clock=False, **environment):
        """(exit status, what was printed, how often the command was run)"""
        attempts = self.folder / "attempts"
        # The load of this machine is not this test's matter.
        quiet = self.folder / "quiet.py"
        quiet.write_text(f"import os, runpy, sys\nos.getloadavg = lambda: (0.0, 0.0, 0.0)\nsys.argv = sys.argv[1:]\nrunpy.run_path(r'{SCRIPT}', run_name='__main__')\n")
        done = subprocess.run([sys.executable, quiet, SCRIPT, "--watch", self.folder / "watch", "--out", self.folder, "--lost", self.folder / "lost",
                               "--seconds", str(seconds), *(["--own-clock"] if own_clock else []), self.folder / "runner", "--",
                               "bash", "-c", f"echo >>{attempts}; echo {missed_ms} >{self.folder}/missed_ms; {command}"],
                              env={**os.environ, "CI": "", "LATE_MS": late_ms, "MACHINE_MS": "0 0", **environment}, check=False, capture_output=True, text=True)
        return done.returncode, done.stdout, len(attempts.read_text())

    def test_what_passes_passes_however_late_the_machine_was(self):
        self.assertEqual(self.run_it("exit 0", late_ms="80 300"), (0, "", 1))

    def test_a_failure_of_function_fails_at_once_on_any_machine(self):
        for status in (1, 5, 2, 134):
            (self.folder / "attempts").write_text("")
            self.assertEqual(self.run_it(f"exit {status}", late_ms="900 9000", MACHINE_MS="900 9000"), (status, "", 1))

    def test_a_failure_that_comes_in_one_of_five_runs_is_not_taken_again(self):
        # With a second chance, such a race passes 24 runs of 25.
        self.assertEqual(self.run_it(f"[ $(wc -l <{self.folder}/attempts) -eq 2 ]")[::2], (1, 1))

    def test_a_late_test_on_a_machine_that_kept_time_fails_at_once(self):
        self.assertEqual(self.run_it("exit 75")[::2], (75, 1))

    def test_a_late_test_is_excused_only_as_far_as_the_watcher_was_late(self):
        for late_ms, missed_ms, status in (("7.5 9", "7", 77), ("7.5 9", "8", 75), ("3.9 50", "0.5", 75), ("4.1 50", "0.5", 77),
                                           ("300 1900", "2000", 75), ("300 2100", "2000", 77), ("300 2100", "900", 75)):
            (self.folder / "attempts").write_text("")
            self.assertEqual(self.run_it("exit 75", late_ms=late_ms, missed_ms=missed_ms)[0], status, (late_ms, missed_ms))

    def test_the_tested_program_cannot_excuse_itself(self):
        said = " ".join(f"echo 900 9000 >{self.folder}/{name};" for name in ("out_of_time", "late_ms"))
        self.assertEqual(self.run_it(f"{said} exit 75")[::2], (75, 1))
        self.assertEqual(self.run_it(f"{said} exit 1")[0], 1)

    def test_a_late_test_that_does_not_say_by_how_much_is_not_excused(self):
        self.assertEqual(self.run_it(f"rm {self.folder}/missed_ms; exit 75", late_ms="80 300")[0], 75)

    def test_on_a_machine_that_stood_still_there_are_three_attempts_and_then_no_result(self):
        status, said, attempts = self.run_it("exit 75", late_ms="7.5 20")
        self.assertEqual((status, attempts), (77, 3))
        self.assertEqual(said.splitlines()[-1], "no machine that keeps time: a sleep in the guest was 7.5 ms too long")

    def test_a_failure_after_an_excused_attempt_is_a_failure(self):
        self.assertEqual(self.run_it(f"[ $(wc -l <{self.folder}/attempts) -ge 2 ] || exit 75; exit 6", late_ms="9 9")[::2], (6, 2))

    def test_no_attempt_begins_that_could_hardly_end(self):
        self.assertEqual(self.run_it("sleep 1.2; exit 75", late_ms="9 9", seconds=2)[2], 1)

    def test_a_run_of_ctest_loses_no_more_than_some_minutes(self):
        self.assertEqual(self.run_it("exit 75", late_ms="9 9")[2], 3)
        (self.folder / "attempts").unlink()
        for lost_s, attempts in (("200.0", 1), ("301.0", 0)):
            run = (self.folder / "lost").read_text().split()[0]
            (self.folder / "lost").write_text(f"{run} {lost_s}\n")
            (self.folder / "attempts").write_text("")
            status, said, tried = self.run_it("exit 75", late_ms="9 9")
            self.assertEqual((status, tried), (77, attempts))
            self.assertTrue(said.splitlines()[-1].startswith("no machine that keeps time: "))
        (self.folder / "lost").write_text("1-1 301.0\n")  # another run's
        self.assertEqual(self.run_it("exit 0")[0], 0)

    def test_a_machine_without_a_guest_skips_and_in_continuous_integration_fails(self):
        status, said, attempts = self.run_it("exit 3", late_ms="9 9")
        self.assertEqual((status, attempts), (77, 1))
        self.assertIn("no guest on this machine", said)
        status, said, attempts = self.run_it("exit 3", late_ms="9 9", CI="true")
        self.assertEqual((status, attempts), (1, 2))
        self.assertIn("a failure", said)

    def test_the_time_limit_is_excused_by_a_machine_that_stood_still_or_had_more_to_do_than_processors(self):
        self.setUp_quiet()
        for status in (124, 125):
            self.assertEqual(keeping_time.excuses(status, self.folder), [])
        (self.folder / "machine_late_ms").write_text("130.0 400.0\n")
        for status in (124, 125):
            self.assertEqual(len(keeping_time.excuses(status, self.folder)), 1)
        self.assertEqual(keeping_time.excuses(75, self.folder), [])
        keeping_time.crowd = lambda: 0.5
        for status, excuses in ((1, 0), (75, 0), (124, 2), (125, 2)):
            self.assertEqual(len(keeping_time.excuses(status, self.folder)), excuses, status)

    def test_a_missed_limit_is_excused_by_the_watcher_alone_and_in_a_crowd_by_all_that_it_saw(self):
        self.setUp_quiet()
        (self.folder / "missed_ms").write_text("300\n")
        for crowd, watched, excuses in ((-1, "60 290", 0), (-1, "60 310", 0), (0.5, "60 290", 0), (0.5, "60 310", 1), (9, "0 0", 0), (-1, "300 300", 1)):
            keeping_time.crowd = lambda crowd=crowd: crowd
            (self.folder / "guest_late_ms").write_text(f"{watched}\n")
            self.assertEqual(len(keeping_time.excuses(75, self.folder)), excuses, (crowd, watched))
            self.assertEqual(keeping_time.excuses(1, self.folder), [])

    def test_a_guest_that_counts_instructions_has_no_late_watcher(self):
        self.assertEqual(self.run_it("exit 75", late_ms="80 300", own_clock=True)[::2], (75, 1))


if __name__ == "__main__":
    unittest.main()
