#!/usr/bin/env python3
"""count_skips.py on reports of this test's making, in ctest's form."""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[1] / "count_skips.py"
REPORT = """<?xml version="1.0" encoding="UTF-8"?>
<testsuite name="(empty)" tests="4" failures="0" disabled="0" skipped="2">
  <testcase name="arm.moves" classname="arm.moves" time="0.1" status="run"><system-out>fine</system-out></testcase>
  {cases}
</testsuite>
"""
CASE = '<testcase name="{name}" classname="{name}" time="0.1" status="notrun"><skipped message=""/><system-out>{output}</system-out></testcase>'


def counted(outputs, *options):
    """(exit status, lines) of the counter for skipped tests with these outputs."""
    with tempfile.NamedTemporaryFile("w", suffix=".xml") as file:
        file.write(REPORT.format(cases="".join(CASE.format(name=f"test{i}", output=output) for i, output in enumerate(outputs))))
        file.flush()
        done = subprocess.run([sys.executable, SCRIPT, file.name, *options], check=False, capture_output=True, text=True)
    return done.returncode, done.stdout.splitlines()


class CountSkips(unittest.TestCase):
    def test_each_skip_is_named_with_its_reason(self):
        status, said = counted(["keeping_time: attempt 1 ended\nno machine that keeps time: a sleep in the guest was 7.5 ms too long\n",
                                "run_in_uml: no linux.uml: apt-get install user-mode-linux\nskipped: no guest on this machine\n",
                                "[ RUN      ] A.B\na.cpp:31: Skipped\nno vcan here\n[  SKIPPED ] A.B (0 ms)\n", ""])
        self.assertEqual(status, 0)
        self.assertEqual(said, ["4 of 5 tests skipped:", "  test0: no machine that keeps time: a sleep in the guest was 7.5 ms too long",
                                "  test1: no linux.uml: apt-get install user-mode-linux", "  test2: no vcan here", "  test3: no reason given"])

    def test_more_than_the_limit_fail(self):
        for skips, status in ((0, 0), (2, 0), (3, 1)):
            self.assertEqual(counted(["skipped: here"] * skips, "--at-most", "2")[0], status)

    def test_what_was_left_out_is_counted_by_label(self):
        def listed(name, *labels):
            return {"name": name, "properties": [{"name": "LABELS", "value": list(labels)}] if labels else []}

        tests = [listed("arm.moves", "unit"), listed("test0", "unit"), listed("a", "vcan"), listed("b", "vcan"), listed("c", "qemu", "timed"), listed("d")]
        with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
            json.dump({"tests": tests}, file)
            file.flush()
            status, said = counted(["skipped: here"], "--all", file.name)
        self.assertEqual((status, said[-1]), (0, "4 tests left out: 2 vcan, 1 qemu+timed, 1 no label"))

    def test_a_report_without_tests_fails(self):
        with tempfile.NamedTemporaryFile("w", suffix=".xml") as file:
            file.write('<testsuite name="(empty)" tests="0"></testsuite>')
            file.flush()
            self.assertEqual(subprocess.run([sys.executable, SCRIPT, file.name], check=False, capture_output=True).returncode, 1)


if __name__ == "__main__":
    unittest.main()
