#!/usr/bin/env python3
"""Holds what a shard measured against bounds; prints each, and ends with status 1 where one is not kept.

  bench ... --json    | nightly_bounds.py bench 'NAME: ours <= 16.7' ...
  campaign ... --json | nightly_bounds.py campaign [--at-least N] 'mean peaks_false <= 0.002' ...
  nightly_bounds.py misses TABLE DOC

bench: NAME is a row's, its field `ours` or `ratio`. campaign: at least N successes over all cells, no false success, each failure with its reason; of a figure `mean`, `median`,
`p95`, `min` or `max` over all runs that have it. misses: each row by which peak_table misses what was asked is listed in DOC, and is no more than a tenth worse than there.
"""
import json
import math
import re
import statistics
import sys

KEPT = {"<=": lambda value, bound: value <= bound, ">=": lambda value, bound: value >= bound}
OF = {"mean": statistics.fmean, "median": statistics.median, "min": min, "max": max, "p95": lambda values: sorted(values)[math.ceil(0.95 * len(values)) - 1]}


def holds(what, value, sign, bound):
    kept = value is not None and KEPT[sign](value, bound)
    shown = "nothing" if value is None else f"{value:.6g}"
    print(f"{'kept  ' if kept else 'BROKEN'} {what} {sign} {bound:g}: {shown}")
    return kept


def split(text):
    """'WHAT <= 1.5' in its three."""
    found = re.fullmatch(r"(.*\S)\s*(<=|>=)\s*(\S+)", text)
    if not found:
        sys.exit(f"{text!r} is no bound: it reads 'WHAT <= NUMBER'")
    return found[1], found[2], float(found[3])


def bench(rows, bounds):
    by_name = {row["name"]: row for row in rows}
    kept = True
    for text in bounds:
        what, sign, bound = split(text)
        name, field = what.rsplit(": ", 1)
        kept &= holds(what, by_name.get(name, {}).get(field), sign, bound)
    return kept


def campaign(document, bounds):
    runs = [run for cell in document["cells"] for run in cell["results"]]
    kept = True
    if bounds[:1] == ["--at-least"]:
        kept &= holds("successes", sum(run["success"] for run in runs), ">=", float(bounds[1]))
        bounds = bounds[2:]
    kept &= holds("false successes", sum(run["false_success"] for run in runs), "<=", 0)
    kept &= holds("runs not flown", document["not_flown"], "<=", 0)
    # "?" is the phase of a failure that gave no reason.
    unnamed = [run["seed"] for run in runs if not run["success"] and (run["failure"] or {}).get("phase", "?") == "?"]
    kept &= holds("failures without a reason", len(unnamed), "<=", 0)
    for text in bounds:
        what, sign, bound = split(text)
        of, figure = what.split(" ", 1)
        values = [run["figures"][figure] for run in runs if run["figures"].get(figure) is not None]
        kept &= holds(what, OF[of](values) if values else None, sign, bound)
    return kept


def missed(text):
    """The rows that miss, as {(row, what): number}: '- Steps, clear, beam 1.6, 30 deg, no off picture: recall 29.2 %, rms 0.251 of 0.250'."""
    return {
        (row, name): float(number)
        for row, what in re.findall(r"^- (.*): ((?:rms|recall|false|99\.9)[^\n:]*)$", text, re.M)
        for name, number in re.findall(r"(rms|recall|false|99\.9)\D*?\s([\d.]*\d)", what)
    }


def is_worse(what, now, listed):
    return now < 0.9 * listed if what == "recall" else now > 1.1 * listed


def misses(table, doc):
    listed = missed(doc)
    new = [
        (row, what, number) for (row, what), number in sorted(missed(table).items()) if (row, what) not in listed or is_worse(what, number, listed[row, what])
    ]
    for row, what, number in new:
        before = f"is {listed[row, what]:g}" if (row, what) in listed else "is no row that misses"
        print(f"BROKEN {what} {number:g} of {row}: in the document it {before}")
    ended = "### Rows where detector + fit misses what is asked" in table
    print(f"{len(missed(table))} misses, {len(new)} of them new or worse" if ended else "BROKEN the table has no end")
    return ended and not new


if __name__ == "__main__":
    if len(sys.argv) < 2 or sys.argv[1] not in ("bench", "campaign", "misses"):
        sys.exit(__doc__)
    if sys.argv[1] == "misses":
        texts = [open(path, encoding="utf-8").read() for path in sys.argv[2:4]]
        sys.exit(not misses(*texts))
    judge = bench if sys.argv[1] == "bench" else campaign
    sys.exit(not judge(json.load(sys.stdin), sys.argv[2:]))
