#!/usr/bin/env python3
"""A failed test in a guest is a failure unless the machine is known not to have kept time: keeping_time.py, on guests of this test's making."""
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

# Measures nothing: says LATE_MS of the guest, 0 of the machine.
WATCH = """#!/bin/bash
case $1 in *guest*) echo "$LATE_MS" ;; *) echo 0 ;; esac >"$1"
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

    def run_it(self, command, late_ms="0.3", seconds=60):
        """(exit status, what was printed, how often the command was run)"""
        attempts = self.folder / "attempts"
        done = subprocess.run([SCRIPT, "--watch", self.folder / "watch", "--out", self.folder, "--lost", self.folder / "lost",
                               "--seconds", str(seconds), self.folder / "runner", "--",
                               "bash", "-c", f"echo >>{attempts}; {command}"], env={**os.environ, "LATE_MS": late_ms}, check=False, capture_output=True, text=True)
        return done.returncode, done.stdout, len(attempts.read_text())

    def test_what_passes_passes_however_late_the_machine_was(self):
        self.assertEqual(self.run_it("exit 0", late_ms="80"), (0, "", 1))

    def test_a_failure_on_a_machine_that_kept_time_has_to_come_twice(self):
        status, said, attempts = self.run_it("exit 5")
        self.assertEqual((status, attempts), (5, 2))
        self.assertIn("attempt 1 failed with 5; once more", said)

    def test_a_failure_that_does_not_come_again_is_none(self):
        self.assertEqual(self.run_it(f"[ $(wc -l <{self.folder}/attempts) -eq 2 ]")[::2], (0, 2))

    def test_on_a_machine_that_stood_still_there_are_three_attempts_and_then_no_result(self):
        status, said, attempts = self.run_it("exit 1", late_ms="7.5")
        self.assertEqual((status, attempts), (77, 3))
        self.assertEqual(said.splitlines()[-1], "no machine that keeps time: a sleep in the guest was 7.5 ms too long")

    def test_the_test_itself_may_say_so_and_the_second_attempt_may_pass(self):
        out_of_time = self.folder / "out_of_time"
        status, said, attempts = self.run_it(f"[ $(wc -l <{self.folder}/attempts) -eq 2 ] || {{ echo the sea was late >{out_of_time}; exit 1; }}")
        self.assertEqual((status, attempts), (0, 2))
        self.assertIn("attempt 1 ended with 1, the sea was late", said)
        self.assertFalse(out_of_time.exists(), "another attempt's reasons are not this one's")

    def test_a_failure_after_an_attempt_that_was_not_fair_is_a_failure(self):
        status, _, attempts = self.run_it(f"[ $(wc -l <{self.folder}/attempts) -ge 2 ] || echo late >{self.folder}/out_of_time; exit 6")
        self.assertEqual((status, attempts), (6, 3))

    def test_no_attempt_begins_that_could_hardly_end(self):
        self.assertEqual(self.run_it("sleep 1.2; exit 1", late_ms="9", seconds=2)[2], 1)

    def test_a_run_of_ctest_loses_no_more_than_some_minutes(self):
        self.assertEqual(self.run_it("exit 1", late_ms="9")[2], 3)
        (self.folder / "attempts").unlink()
        for lost_s, attempts in (("200.0", 1), ("301.0", 0)):
            run = (self.folder / "lost").read_text().split()[0]
            (self.folder / "lost").write_text(f"{run} {lost_s}\n")
            (self.folder / "attempts").write_text("")
            status, said, tried = self.run_it("exit 1", late_ms="9")
            self.assertEqual((status, tried), (77, attempts))
            self.assertTrue(said.splitlines()[-1].startswith("no machine that keeps time: "))
        (self.folder / "lost").write_text("1-1 301.0\n")  # another run's
        self.assertEqual(self.run_it("exit 0")[0], 0)

    def test_what_the_machine_lacks_is_said_once(self):
        self.assertEqual(self.run_it("exit 3", late_ms="9"), (3, "", 1))

    def test_the_time_limit_is_no_excuse_on_a_machine_that_had_nothing_else_to_do(self):
        self.addCleanup(setattr, os, "getloadavg", os.getloadavg)
        processors = len(os.sched_getaffinity(0))
        os.getloadavg = lambda: (processors + 0.5, 0, 0)
        for status in (124, 125):
            self.assertEqual(keeping_time.excuses(status, self.folder), [])
        (self.folder / "machine_late_ms").write_text("130.0\n")
        self.assertEqual(keeping_time.excuses(1, self.folder), [])
        for status in (124, 125):
            self.assertEqual(len(keeping_time.excuses(status, self.folder)), 1)
        os.getloadavg = lambda: (processors + 4.0, 0, 0)
        self.assertEqual(keeping_time.excuses(1, self.folder), [])
        for status in (124, 125):
            self.assertEqual(len(keeping_time.excuses(status, self.folder)), 2)


if __name__ == "__main__":
    unittest.main()
