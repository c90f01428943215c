#!/usr/bin/env python3
"""Counts what a run of ctest skipped, and prints each with its reason; and what the run left out, by label.

Usage: count_skips.py JUNIT_FILE [--at-most N] [--all LISTING]

JUNIT_FILE is of `ctest --output-junit`, LISTING of `ctest --show-only=json-v1` without a selection. Exit status: 0; 1 when more than N were skipped, or when the
file tells of no test at all. Tests that were left out never fail: somebody chose so.
"""
import argparse
import collections
import json
import pathlib
import re
import sys
import xml.etree.ElementTree as ElementTree

# What a reason looks like in a test's output, in the order in which they are looked for.
REASONS = (re.compile(r"^(no machine that keeps time: .*)$", re.MULTILINE), re.compile(r"^(?:run_in_uml|run_in_qemu|with_vcan): (no .*)$", re.MULTILINE),
           re.compile(r"^skipped[:,] (.*)$", re.MULTILINE), re.compile(r"Skipped\n(.*)$", re.MULTILINE))


def reason(output):
    """The line of a skipped test's output that says why."""
    for pattern in REASONS:
        if found := pattern.search(output):
            return found.group(1).strip()
    lines = [line for line in output.splitlines() if line.strip()]
    return lines[-1].strip() if lines else "no reason given"


def cases_of(text):
    return list(ElementTree.fromstring(text).iter("testcase"))


def skipped(text):
    """(number of tests, [(name, reason)]) of a JUnit report. A test that did not run because it is disabled or its program is missing counts, too."""
    cases = cases_of(text)
    return len(cases), [(case.get("name"), reason(case.findtext("system-out", ""))) for case in cases
                        if case.find("skipped") is not None or case.get("status") in ("notrun", "disabled")]


def labels(test):
    """The labels of a test in ctest's listing, as one text."""
    found = [value for each in test.get("properties", []) if each["name"] == "LABELS" for value in each["value"]]
    return "+".join(found) or "no label"


def left_out(text, listing):
    """{labels: number} of the listing's tests that a JUnit report does not have."""
    run = {case.get("name") for case in cases_of(text)}
    return collections.Counter(labels(test) for test in json.loads(listing)["tests"] if test["name"] not in run)


def main():
    parser = argparse.ArgumentParser(usage=__doc__.split("\n\n")[1])
    parser.add_argument("file")
    parser.add_argument("--at-most", type=int)
    parser.add_argument("--all", type=pathlib.Path)
    asked = parser.parse_args()
    with open(asked.file, encoding="utf-8", errors="replace") as file:
        report = file.read()
    count, found = skipped(report)
    print(f"{len(found)} of {count} tests skipped" + (":" if found else ""))
    for name, why in found:
        print(f"  {name}: {why}")
    if asked.all:
        out = left_out(report, asked.all.read_text(encoding="utf-8"))
        print(f"{out.total()} tests left out" + "".join(f"{', ' if i else ': '}{number} {name}" for i, (name, number) in enumerate(out.most_common())))
    if count == 0:
        print("count_skips: no test was run")
        return 1
    if asked.at_most is not None and len(found) > asked.at_most:
        print(f"count_skips: at most {asked.at_most} may be skipped here")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
