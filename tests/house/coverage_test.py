#!/usr/bin/env python3
"""The judge of coverage.py on counts of this test's making."""
import pathlib
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import coverage  # noqa: E402


def source(counts, branches=()):
    made = coverage.Source()
    made.lines.update({i + 1: count for i, count in enumerate(counts)})
    for i, count in enumerate(counts):
        made.lines[i + 1] = count
    made.branches = dict(enumerate(branches))
    return made


class Coverage(unittest.TestCase):
    def test_one_line_that_is_not_executed_misses_the_whole(self):
        texts = {"firmware/canopen/a.cpp": ["one", "two"], "firmware/safety/b.cpp": ["x"]}
        for counts, missed in (([3, 1], 0), ([3, 0], 1)):
            folders, missing, _ = coverage.judge({"firmware/canopen/a.cpp": source(counts), "firmware/safety/b.cpp": source([1])}, texts, {})
            self.assertEqual(len(missing), missed)
            self.assertEqual([line for line in coverage.bounds_missed(folders) if line.startswith("canopen")], ["canopen/: 1 of 2 lines are not executed"] * missed)

    def test_an_exception_stands_in_and_is_refused_when_it_is_not_needed(self):
        texts = {"firmware/canopen/a.cpp": ["one", "  two"], "firmware/safety/b.cpp": ["x"]}
        sources = {"firmware/canopen/a.cpp": source([3, 0]), "firmware/safety/b.cpp": source([1])}
        exceptions = {("firmware/canopen/a.cpp", "two"): 1, ("firmware/safety/b.cpp", "x"): 1}
        folders, missing, useless = coverage.judge(sources, texts, exceptions)
        self.assertEqual((missing, useless), ([], [("firmware/safety/b.cpp", "x")]))
        self.assertEqual([line for line in coverage.bounds_missed(folders) if not line.startswith("all")], [])

    def test_what_is_excepted_is_not_executed(self):
        texts = {"firmware/canopen/a.cpp": ["x"] * 100, "firmware/safety/b.cpp": ["x"]}
        sources = {"firmware/canopen/a.cpp": source([1] * 90 + [0] * 10), "firmware/safety/b.cpp": source([1])}
        folders, _, _ = coverage.judge(sources, texts, {("firmware/canopen/a.cpp", "x"): 10})
        self.assertEqual(coverage.bounds_missed(folders), ["all: 90.1 % of 101 lines, 95 are wanted"])

    def test_an_exception_is_of_one_line(self):
        texts = {"firmware/canopen/a.cpp": ["return;", "return;"]}
        _, missing, useless = coverage.judge({"firmware/canopen/a.cpp": source([0, 0])}, texts, {("firmware/canopen/a.cpp", "return;"): 1})
        self.assertEqual((len(missing), useless), (1, []))

    def test_a_file_that_no_program_links_is_told(self):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            (root / "firmware/arm").mkdir(parents=True)
            for name in ("a.cpp", "b.cpp", "b.hpp"):
                (root / "firmware/arm" / name).touch()
            self.assertEqual(coverage.not_linked(root, {"firmware/arm/a.cpp": None}), ["firmware/arm/b.cpp"])

    def test_of_the_whole_every_line_counts(self):
        texts = {"firmware/canopen/c.cpp": ["x"], "firmware/safety/s.cpp": ["x"], "firmware/arm/a.cpp": [str(i) for i in range(100)]}
        sources = {"firmware/canopen/c.cpp": source([1]), "firmware/safety/s.cpp": source([1]), "firmware/arm/a.cpp": source([1] * 99 + [0])}
        folders, _, _ = coverage.judge(sources, texts, {})
        self.assertEqual(coverage.bounds_missed(folders), [])
        self.assertEqual(coverage.bounds_missed(folders, folders), ["arm/: 1 of 100 lines are not executed"])
        folders, _, _ = coverage.judge(sources, texts, {("firmware/arm/a.cpp", "99"): 1})
        self.assertEqual(coverage.bounds_missed(folders, folders), [])

    def test_over_all_nineteen_in_twenty_are_enough_and_fewer_are_not(self):
        texts = {"firmware/arm/a.cpp": [str(i) for i in range(100)], "firmware/canopen/c.cpp": ["x"], "firmware/safety/s.cpp": ["x"]}
        for hit, missed in ((98, 0), (95, 0), (94, 1)):
            sources = {"firmware/arm/a.cpp": source([1] * hit + [0] * (100 - hit)), "firmware/canopen/c.cpp": source([1]), "firmware/safety/s.cpp": source([1])}
            folders, _, _ = coverage.judge(sources, texts, {})
            self.assertEqual(len(coverage.bounds_missed(folders)), missed, hit)

    def test_nothing_measured_is_no_coverage(self):
        self.assertEqual(len(coverage.bounds_missed({})), 2)


if __name__ == "__main__":
    unittest.main()
