"""What nightly_bounds.py says of results that keep their bounds, and of results that do not."""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

PROGRAM = pathlib.Path(__file__).resolve().parent.parent / "nightly_bounds.py"


def said(arguments, document=None):
    done = subprocess.run([sys.executable, "-B", PROGRAM, *arguments], input=json.dumps(document), capture_output=True, text=True, check=False)
    return done.returncode, done.stdout


def campaign(values, failures=()):
    runs = [{"seed": i, "success": i not in dict(failures), "false_success": False, "failure": dict(failures).get(i), "figures": {"peaks_false": value}}
            for i, value in enumerate(values)]
    return {"not_flown": 0, "cells": [{"results": runs}]}


class Bounds(unittest.TestCase):
    def test_a_bench_is_held_by_row_and_field(self):
        rows = [{"name": "frame, 2 threads", "ours": 16.0, "ratio": 1.2}]
        self.assertEqual(said(["bench", "frame, 2 threads: ours <= 16", "frame, 2 threads: ratio >= 1.2"], rows)[0], 0)
        self.assertEqual(said(["bench", "frame, 2 threads: ours <= 15.9"], rows)[0], 1)
        self.assertEqual(said(["bench", "frame, 3 threads: ours <= 99"], rows), (1, "BROKEN frame, 3 threads: ours <= 99: nothing\n"))

    def test_a_campaign_is_held_by_its_figures(self):
        # Of 1 to 20: mean and median 10.5, the nineteenth is the p95.
        document = campaign([float(i) for i in range(1, 21)])
        self.assertEqual(said(["campaign", "--at-least", "20", "mean peaks_false <= 10.5", "median peaks_false <= 10.5", "p95 peaks_false <= 19",
                               "max peaks_false <= 20"], document)[0], 0)
        for bound in ("mean peaks_false <= 10.4", "median peaks_false <= 10.4", "p95 peaks_false <= 18.9", "max peaks_false <= 19.9", "mean other <= 9"):
            self.assertEqual(said(["campaign", bound], document)[0], 1, bound)

    def test_a_campaign_is_held_by_its_ends(self):
        named, unnamed = {"phase": "turn", "reason": "no grip"}, {"phase": "?", "reason": "no reason was given"}
        self.assertEqual(said(["campaign", "--at-least", "2"], campaign([0.0] * 3, [(1, named)]))[0], 0)
        self.assertEqual(said(["campaign", "--at-least", "3"], campaign([0.0] * 3, [(1, named)]))[0], 1)
        self.assertEqual(said(["campaign"], campaign([0.0] * 3, [(1, unnamed)]))[0], 1)
        lying = campaign([0.0])
        lying["cells"][0]["results"][0]["false_success"] = True
        self.assertEqual(said(["campaign"], lying)[0], 1)
        self.assertEqual(said(["campaign"], {**campaign([0.0]), "not_flown": 1})[0], 1)

    # The force is what a mission may do to the panel: no campaign of seeds is without its bound.
    def test_every_campaign_of_seeds_bounds_the_force(self):
        shards = [line for line in (PROGRAM.parent / "nightly_shards").read_text(encoding="utf-8").splitlines() if "nightly_bounds.py campaign" in line]
        self.assertGreaterEqual(len(shards), 3)
        for shard in shards:
            self.assertIn("'max contact_force_n <= 150'", shard)

    def test_only_rows_that_the_page_lists_may_miss(self):
        heading = "### Rows where detector + fit misses what is asked: 1\n\n"
        page = "- Steps of 10:1 (bias: 12 bits), hazy, 0 deg: rms 0.276 of 0.250 px\n"
        for table, status in ((heading + "- Steps of 10:1 (bias: 12 bits), hazy, 0 deg: rms 0.271 of 0.250 px\n", 0), (heading, 0), (page, 1),
                              (heading + "- Steps of 10:1 (bias: 12 bits), hazy, 0 deg: rms 0.271 of 0.250 px, recall 90.0 %\n", 1),
                              (heading + "- Steps of 10:1 (bias: 12 bits), hazy, 0 deg: rms 0.310 of 0.250 px\n", 1),
                              (heading + "- Steps, clear, 0 deg: 99.9th percentile 1.10 of 1.00 px\n", 1)):
            with tempfile.TemporaryDirectory() as folder:
                for name, text in (("table.md", table), ("page.md", page)):
                    (pathlib.Path(folder) / name).write_text(text, encoding="utf-8")
                self.assertEqual(said(["misses", f"{folder}/table.md", f"{folder}/page.md"])[0], status, table)


if __name__ == "__main__":
    unittest.main()
